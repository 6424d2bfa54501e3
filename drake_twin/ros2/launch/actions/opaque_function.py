"""Stand-ins for ``launch.actions.opaque_function``."""

from drake_twin.ros2.actions import OpaqueFunction

__all__ = ["OpaqueFunction"]
