"""Stand-ins for ``launch_xml.launch_description_sources.xml_launch_description_source``."""

from drake_twin.ros2.include import XMLLaunchDescriptionSource

__all__ = ["XMLLaunchDescriptionSource"]
