"""Stand-ins for ``launch.launch_description_sources``."""

from drake_twin.ros2.lazy_exports import classes_in, lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        **classes_in(__file__),
        "python_launch_file_utilities": "get_launch_description_from_python_launch_file"
        " load_python_launch_file_as_module",
        "launch_xml.launch_description_sources.xml_launch_description_source": "XMLLaunchDescriptionSource",
        "launch_yaml.launch_description_sources.yaml_launch_description_source": "YAMLLaunchDescriptionSource",
    },
)
