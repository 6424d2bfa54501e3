"""Stand-ins for ``launch_yaml.launch_description_sources``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "yaml_launch_description_source": "YAMLLaunchDescriptionSource",
    },
)
