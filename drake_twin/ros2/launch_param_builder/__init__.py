"""Stand-ins for ``launch_param_builder``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "launch_param_builder": "ParameterBuilder",
        "utils": "ParameterBuilderFileNotFoundError get_path load_file load_xacro load_yaml",
    },
)
