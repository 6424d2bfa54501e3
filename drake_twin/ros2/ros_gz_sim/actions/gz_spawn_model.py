"""Stand-ins for ``ros_gz_sim.actions.gz_spawn_model``."""

from drake_twin.ros2.gz_actions import GzSpawnModel

__all__ = ["GzSpawnModel"]
