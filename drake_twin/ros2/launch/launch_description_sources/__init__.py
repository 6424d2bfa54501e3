"""Stand-ins for ``launch.launch_description_sources``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "any_launch_description_source": "AnyLaunchDescriptionSource",
        "frontend_launch_description_source": "FrontendLaunchDescriptionSource",
        "python_launch_description_source": "PythonLaunchDescriptionSource",
        "python_launch_file_utilities": "get_launch_description_from_python_launch_file"
        " load_python_launch_file_as_module",
        "launch_xml.launch_description_sources.xml_launch_description_source": "XMLLaunchDescriptionSource",
        "launch_yaml.launch_description_sources.yaml_launch_description_source": "YAMLLaunchDescriptionSource",
    },
)
