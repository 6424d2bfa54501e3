"""Stand-ins for ``ament_index_python.resources``, which has the names of ``ament_index_python``."""

from drake_twin.ros2.lazy_exports import EXPORTS, lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__, {"ament_index_python.packages": " ".join(EXPORTS["drake_twin.ros2.ament_index_python"])}
)
