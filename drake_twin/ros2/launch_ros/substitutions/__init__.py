"""Stand-ins for ``launch_ros.substitutions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "executable_in_package": "ExecutableInPackage",
        "find_package": "FindPackage FindPackagePrefix FindPackageShare",
        "parameter": "Parameter",
    },
)
