"""Stand-ins for ``launch.event``."""

from drake_twin.ros2.events import Event

__all__ = ["Event"]
