"""Stand-ins for ``launch_ros.substitutions.find_package``."""

from drake_twin.ros2.substitutions import FindPackage, FindPackagePrefix, FindPackageShare

__all__ = ["FindPackage", "FindPackagePrefix", "FindPackageShare"]
