"""Stand-ins for ``ros_gz_bridge.actions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "ros_gz_bridge": "RosGzBridge",
    },
)
