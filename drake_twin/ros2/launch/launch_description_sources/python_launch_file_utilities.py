"""Stand-ins for ``launch.launch_description_sources.python_launch_file_utilities``."""

from drake_twin.ros2.python_module import (
    get_launch_description_from_python_launch_file,
    load_python_launch_file_as_module,
)

__all__ = ["get_launch_description_from_python_launch_file", "load_python_launch_file_as_module"]
