"""Stand-ins for ``launch_yaml.launch_description_sources.yaml_launch_description_source``."""

from drake_twin.ros2.include import YAMLLaunchDescriptionSource

__all__ = ["YAMLLaunchDescriptionSource"]
