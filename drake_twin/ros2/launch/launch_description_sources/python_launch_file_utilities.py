"""What launch files use to read other Python launch files themselves."""

from types import ModuleType

from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.python_file import load_python_file, load_python_module


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Return a Python launch file as a module.

    Raises:
        InputError: If it cannot be read, or its code fails.
    """
    context = current_context()
    return load_python_module(str(context.locate(python_launch_file_path)), context)


def get_launch_description_from_python_launch_file(python_launch_file_path: str) -> LaunchDescription:
    """Return the launch description of a Python launch file.

    Raises:
        InputError: If it cannot be read, its code fails, or it returns something else.
    """
    context = current_context()
    return load_python_file(str(context.locate(python_launch_file_path)), context)
