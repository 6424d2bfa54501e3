"""Stand-ins for ``launch_xml.launch_description_sources``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "xml_launch_description_source": "XMLLaunchDescriptionSource",
    },
)
