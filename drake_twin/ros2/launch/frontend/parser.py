"""Stand-ins for ``launch.frontend.parser``."""

from drake_twin.ros2.frontend import FrontEnd as Parser

__all__ = ["Parser"]
