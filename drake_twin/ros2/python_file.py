"""Python launch files: they are executed, as they use loops, ``open()``, ``os.environ`` and classes freely."""

import builtins
import sys
import types
from functools import lru_cache
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import file_bytes
from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch_errors import launch_error

_MODULE_NAME = "python_launch_file"  # as ros2 launch names it


def load_python_file(path: str, context: LaunchContext) -> LaunchDescription:
    """Execute a Python launch file and return what its ``generate_launch_description()`` returns.

    ROS's modules must be in place, see `drake_twin.ros2.ros_modules`.

    Raises:
        InputError: If the file cannot be read, its code fails (the text holds the traceback of that file), or it does
            not return a launch description.
    """
    module = load_python_module(path, context)
    generate = getattr(module, "generate_launch_description", None)
    if generate is None:
        raise InputError(
            "a Python launch file has a function generate_launch_description(), which is missing here", file=path
        )
    try:
        with context.loading(path):
            description = generate()
    except (Exception, SystemExit) as error:
        raise launch_error(error, context, path) from None
    if not callable(getattr(description, "visit", None)):
        raise InputError(
            f"generate_launch_description() returns {description!r}, which is not a LaunchDescription", file=path
        )
    return description  # type: ignore[no-any-return]


def load_python_module(path: str, context: LaunchContext) -> types.ModuleType:
    """Execute a Python file as a module.

    Raises:
        InputError: If it cannot be read, or its code fails.
    """
    try:
        source = file_bytes(path)
    except OSError as error:
        raise InputError(f"the launch file cannot be read ({error.strerror})", file=path) from None
    module = types.ModuleType(_MODULE_NAME)
    module.__file__ = path
    module.__dict__["open"] = _locating_open(context)
    sys.modules[_MODULE_NAME] = module  # where dataclasses and pickle look for it
    try:
        with context.loading(path):
            exec(_compiled(source, path), module.__dict__)
    except (Exception, SystemExit) as error:
        raise launch_error(error, context, path) from None
    return module


@lru_cache(maxsize=256)
def _compiled(source: bytes, path: str) -> types.CodeType:
    """Compile a file, which a launch file may include once a robot."""
    return compile(source, path, "exec", dont_inherit=True)


def _locating_open(context: LaunchContext) -> Any:
    """Return ``open`` for the file's own code, which finds its author's ``/home/…/PACKAGE/x`` by the package in it."""

    def open(file: Any, mode: str = "r", *args: Any, **kwargs: Any) -> Any:
        if mode.startswith("r") and isinstance(file, str | Path):
            file = context.locate(file)
        return builtins.open(file, mode, *args, **kwargs)

    return open
