"""Stand-ins for ``launch.actions.shutdown_action``."""

from drake_twin.ros2.actions import Shutdown

__all__ = ["Shutdown"]
