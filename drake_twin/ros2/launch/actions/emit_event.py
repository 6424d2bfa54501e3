"""Stand-ins for ``launch.actions.emit_event``."""

from drake_twin.ros2.actions import EmitEvent

__all__ = ["EmitEvent"]
