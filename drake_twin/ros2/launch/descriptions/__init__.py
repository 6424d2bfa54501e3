"""Stand-ins for ``launch.descriptions``."""

from drake_twin.ros2.lazy_exports import classes_in, lazy_exports

__all__, __getattr__ = lazy_exports(__name__, classes_in(__file__))
