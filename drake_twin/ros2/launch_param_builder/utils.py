"""``launch_param_builder.utils``: reading a package's files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drake_twin.description.bounded_yaml import load_yaml as load_yaml_text
from drake_twin.description.source_file import file_text
from drake_twin.ros2.ament_index_python.packages import get_package_share_directory
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.packages import AbsentError, absent_package_in
from drake_twin.ros2.xacro_command import expand


class ParameterBuilderFileNotFoundError(KeyError):
    """Raised for a file that does not exist."""


def load_file(file_path: Path, mappings: Mapping[str, Any] | None = None) -> str:
    """Return a file's text.

    Raises:
        ParameterBuilderFileNotFoundError: If it does not exist.
    """
    return file_text(_existing(file_path))


def load_yaml(file_path: Path, mappings: Mapping[str, Any] | None = None) -> Any:
    """Return what a YAML file holds.

    Raises:
        ParameterBuilderFileNotFoundError: If it does not exist.
    """
    return load_yaml_text(load_file(file_path, mappings))


def load_xacro(file_path: Path, mappings: Mapping[str, Any] | None = None) -> str:
    """Return the expanded text of a xacro file.

    Raises:
        ParameterBuilderFileNotFoundError: If it does not exist.
        InputError: If xacro refuses it.
    """
    arguments = {name: str(value) for name, value in (mappings or {}).items()}
    return expand(str(_existing(file_path)), arguments, current_context())[0]


def get_path(package_name: str, file_path: str) -> str:
    """Return the path of a package's file."""
    return str(Path(get_package_share_directory(package_name)) / file_path)


def _existing(file: Path) -> Path:
    absent = absent_package_in(str(file))
    if absent is not None:
        raise AbsentError(f"package {absent!r} is absent, and the launch file reads from it")
    if not Path(file).exists():
        raise ParameterBuilderFileNotFoundError(f"File {file} doesn't exist")
    return Path(file)
