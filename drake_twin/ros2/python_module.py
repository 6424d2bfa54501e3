"""What launch files use to read other Python launch files themselves."""

from __future__ import annotations

from typing import Any

from drake_twin.ros2.evaluation import current_context


def load_python_launch_file_as_module(python_launch_file_path: str) -> Any:
    """A Python launch file as a module."""
    from drake_twin.ros2.python_file import load_python_module

    context = current_context()
    return load_python_module(str(context.locate(python_launch_file_path)), context)


def get_launch_description_from_python_launch_file(python_launch_file_path: str) -> Any:
    """The launch description of a Python launch file."""
    from drake_twin.ros2.python_file import load_python_file

    context = current_context()
    return load_python_file(str(context.locate(python_launch_file_path)), context)
