"""Stand-ins for ``ament_index_python.resources``, which has the names of ``ament_index_python``."""

from drake_twin.ros2 import ament_index_python

__all__ = list(ament_index_python.__all__)
__getattr__ = ament_index_python.__getattr__
