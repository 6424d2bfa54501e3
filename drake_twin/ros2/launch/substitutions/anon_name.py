"""Stand-ins for ``launch.substitutions.anon_name``."""

from drake_twin.ros2.substitutions import AnonName

__all__ = ["AnonName"]
