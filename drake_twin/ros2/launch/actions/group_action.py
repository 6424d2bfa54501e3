"""Stand-ins for ``launch.actions.group_action``."""

from drake_twin.ros2.actions import GroupAction

__all__ = ["GroupAction"]
