"""The source of an XML launch file."""

from drake_twin.ros2.launch.launch_description_sources.any_launch_description_source import AnyLaunchDescriptionSource


class XMLLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """An XML launch file."""

    form = "xml"
