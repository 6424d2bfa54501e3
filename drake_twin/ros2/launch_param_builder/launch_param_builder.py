"""``launch_param_builder.ParameterBuilder``: parameters from a package's files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from drake_twin.ros2.ament_index_python.packages import get_package_share_directory
from drake_twin.ros2.launch_param_builder.utils import load_file, load_xacro, load_yaml


class ParameterBuilder:
    """Gathers parameters from a package's files.

    Args:
        package_name: The package.
    """

    def __init__(self, package_name: str):
        self._package_path = Path(get_package_share_directory(package_name))
        self._parameters: dict[str, Any] = {}

    def yaml(
        self, file_path: str, parameter_namespace: str | None = None, mappings: Mapping[str, Any] | None = None
    ) -> Self:
        """Add what a YAML file of the package holds."""
        values = load_yaml(self._package_path / file_path, mappings)
        if parameter_namespace:
            self._parameters.setdefault(parameter_namespace, {}).update(values)
        else:
            self._parameters.update(values)
        return self

    def file_parameter(self, parameter_name: str, file_path: str, mappings: Mapping[str, Any] | None = None) -> Self:
        """Add a file's text as a parameter."""
        self._parameters[parameter_name] = load_file(self._package_path / file_path, mappings)
        return self

    def xacro_parameter(self, parameter_name: str, file_path: str, mappings: Mapping[str, Any] | None = None) -> Self:
        """Add the expanded text of a xacro file as a parameter."""
        self._parameters[parameter_name] = load_xacro(self._package_path / file_path, mappings)
        return self

    def parameter(self, parameter_name: str, parameter_value: Any) -> Self:
        """Add a parameter."""
        self._parameters[str(parameter_name)] = parameter_value
        return self

    def to_dict(self) -> dict[str, Any]:
        """Return the parameters."""
        return self._parameters
