"""Stand-ins for ``launch.actions.timer_action``."""

from drake_twin.ros2.actions import CancelTimer, TimerAction

__all__ = ["CancelTimer", "TimerAction"]
