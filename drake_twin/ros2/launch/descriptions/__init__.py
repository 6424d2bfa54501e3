"""Stand-ins for ``launch.descriptions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "executable": "Executable",
    },
)
