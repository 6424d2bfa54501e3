"""The source of a Python launch file."""

from drake_twin.ros2.launch.launch_description_sources.any_launch_description_source import AnyLaunchDescriptionSource


class PythonLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A Python launch file."""

    form = "python"
