"""Stand-ins for ``launch.events.matchers``."""

from drake_twin.ros2.events import matches_action

__all__ = ["matches_action"]
