"""Stand-ins for ``ros_gz_sim.actions.gzserver``."""

from drake_twin.ros2.gz_actions import GzServer

__all__ = ["GzServer"]
