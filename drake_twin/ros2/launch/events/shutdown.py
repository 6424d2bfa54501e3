"""Stand-ins for ``launch.events.shutdown``."""

from drake_twin.ros2.events import Shutdown

__all__ = ["Shutdown"]
