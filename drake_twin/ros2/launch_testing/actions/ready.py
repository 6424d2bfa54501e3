"""Stand-ins for ``launch_testing.actions.ready``."""

from drake_twin.ros2.launch_service import ReadyToTest

__all__ = ["ReadyToTest"]
