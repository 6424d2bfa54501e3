"""Stand-ins for ``launch.event_handler``."""

from drake_twin.ros2.event_handlers import BaseEventHandler

__all__ = ["BaseEventHandler", "EventHandler"]

EventHandler = BaseEventHandler
