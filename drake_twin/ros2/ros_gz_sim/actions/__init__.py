"""Stand-ins for ``ros_gz_sim.actions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "gz_spawn_model": "GzSpawnModel",
        "gzserver": "GzServer",
    },
)
