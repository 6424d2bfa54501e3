"""The source of a YAML launch file."""

from drake_twin.ros2.launch.launch_description_sources.any_launch_description_source import AnyLaunchDescriptionSource


class YAMLLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A YAML launch file."""

    form = "yaml"
