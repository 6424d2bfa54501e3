"""Stand-ins for ``launch.events.timer_event``."""

from drake_twin.ros2.events import TimerEvent

__all__ = ["TimerEvent"]
