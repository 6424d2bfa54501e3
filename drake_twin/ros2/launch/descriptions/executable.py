"""Stand-ins for ``launch.descriptions.executable``."""

from drake_twin.ros2.process_actions import Executable

__all__ = ["Executable"]
