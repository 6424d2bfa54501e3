"""Stand-ins for ``launch.substitutions.command``."""

from drake_twin.ros2.substitutions import Command

__all__ = ["Command"]
