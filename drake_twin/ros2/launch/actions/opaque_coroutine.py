"""Stand-ins for ``launch.actions.opaque_coroutine``."""

from drake_twin.ros2.actions import OpaqueCoroutine

__all__ = ["OpaqueCoroutine"]
