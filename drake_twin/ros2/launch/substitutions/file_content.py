"""Stand-ins for ``launch.substitutions.file_content``."""

from drake_twin.ros2.substitutions import FileContent

__all__ = ["FileContent"]
