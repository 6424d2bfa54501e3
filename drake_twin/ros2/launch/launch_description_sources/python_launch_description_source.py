"""Stand-ins for ``launch.launch_description_sources.python_launch_description_source``."""

from drake_twin.ros2.include import PythonLaunchDescriptionSource

__all__ = ["PythonLaunchDescriptionSource"]
