"""Stand-in for ``rclpy.parameter``."""

import array
from contextlib import suppress
from enum import Enum
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.description.source_file import file_text
from drake_twin.messages.parameter_value import flat
from drake_twin.nodes.message_classes import message_class

PARAMETER_SEPARATOR_STRING = "."


class Parameter:
    """A parameter: its name, type and value."""

    class Type(Enum):
        """The types, numbered as in ``rcl_interfaces/msg/ParameterType``."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        @classmethod
        def from_parameter_value(cls, parameter_value: Any) -> "Parameter.Type":
            """Return the type of a value.

            Raises:
                TypeError: If no parameter can have it.
            """
            value = parameter_value
            if value is None:
                return cls.NOT_SET
            for kind, of_value in _SINGLE.items():
                if isinstance(value, of_value):
                    return kind
            if isinstance(value, list | tuple | array.array):
                for kind, of_item in _SEVERAL.items():
                    if all(isinstance(item, of_item) for item in value):
                        return kind
                raise TypeError(f"The given value is not a list of one of the allowed types '{value}'.")
            raise TypeError(f"The given value is not one of the allowed types '{value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Return whether a value has this type."""
            value = parameter_value
            if self == Parameter.Type.NOT_SET:
                return value is None
            if self in _SINGLE:
                return isinstance(value, _SINGLE[self])
            takes_arrays = self in (Parameter.Type.INTEGER_ARRAY, Parameter.Type.DOUBLE_ARRAY)
            items = isinstance(value, list | tuple) or (takes_arrays and isinstance(value, array.array))
            return items and all(isinstance(item, _SEVERAL[self]) for item in value)

    def __init__(self, name: str, type_: "Parameter.Type | None" = None, value: Any = None):
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._name, self._type_ = name, type_
        self._value = value

    @property
    def name(self) -> str:
        return self._name

    @property
    def type_(self) -> "Parameter.Type":
        return self._type_

    @property
    def value(self) -> Any:
        return self._value

    def get_parameter_value(self) -> Any:
        parameter_value = message_class("rcl_interfaces/msg/ParameterValue")

        if self._type_ == Parameter.Type.NOT_SET:
            return parameter_value(type=0)
        field = f"{self._type_.name.lower()}_value"
        return parameter_value(type=self._type_.value, **{field: self._value})

    def to_parameter_msg(self) -> Any:
        kind_of_message = message_class("rcl_interfaces/msg/Parameter")

        return kind_of_message(name=self._name, value=self.get_parameter_value())

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> "Parameter":
        kind = Parameter.Type(value=param_msg.value.type)
        value = None if kind is Parameter.Type.NOT_SET else getattr(param_msg.value, f"{kind.name.lower()}_value")
        return cls(param_msg.name, kind, value)


# The classes of values, and of the items of lists, in the order in which they are looked for.
_SINGLE: dict[Parameter.Type, type] = {
    Parameter.Type.BOOL: bool,
    Parameter.Type.INTEGER: int,
    Parameter.Type.DOUBLE: float,
    Parameter.Type.STRING: str,
}
_SEVERAL: dict[Parameter.Type, type] = {
    Parameter.Type.BYTE_ARRAY: bytes,
    Parameter.Type.BOOL_ARRAY: bool,
    Parameter.Type.INTEGER_ARRAY: int,
    Parameter.Type.DOUBLE_ARRAY: float,
    Parameter.Type.STRING_ARRAY: str,
}


def parameter_value_to_python(parameter_value: Any) -> Any:
    """Return the value of a ``ParameterValue`` message.

    Raises:
        RuntimeError: If its type is unknown.
    """
    try:
        kind = Parameter.Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if kind is Parameter.Type.NOT_SET:
        return None
    value = getattr(parameter_value, f"{kind.name.lower()}_value")
    return list(value) if kind in _SEVERAL else value


def get_parameter_value(string_value: str) -> Any:
    """Return text as a ``ParameterValue`` message, as YAML reads it; a string where no parameter has its type."""
    try:
        value = load_yaml(string_value)
    except yaml.parser.ParserError:
        value = string_value
    kind = Parameter.Type.STRING
    if isinstance(value, bool | int | float | str | list):
        with suppress(TypeError):
            kind = Parameter.Type.from_parameter_value(value)
    if value == []:
        kind = Parameter.Type.BOOL_ARRAY
    if kind in (Parameter.Type.STRING, Parameter.Type.BYTE_ARRAY):
        kind, value = Parameter.Type.STRING, value if isinstance(value, str) else string_value
    return Parameter("", kind, value).get_parameter_value()


def parameter_dict_from_yaml_file(
    parameter_file: str, use_wildcard: bool = False, target_nodes: list[str] | None = None, namespace: str = ""
) -> dict[str, Any]:
    """Return the parameters of nodes in a file, as ``Parameter`` messages by their names.

    Args:
        parameter_file: The file.
        use_wildcard: Whether those of ``/**`` are among them.
        target_nodes: The nodes; all of the file by default.
        namespace: Comes before each name.

    Raises:
        RuntimeError: If a node is not in the file, or it is not a parameters file.
    """
    data = load_yaml(file_text(parameter_file))
    wildcard = ["/**"] if use_wildcard and "/**" in data else []
    keys = wildcard + (list(target_nodes) if target_nodes else [key for key in data if key != "/**"])
    for name in target_nodes or ():
        if name not in data:
            text = f"Param file does not contain parameters for {name},only for nodes: {list(data)}"
            raise RuntimeError(text)
    if not keys:
        raise RuntimeError("Param file does not contain selected parameters")
    found: dict[str, Any] = {}
    for key in keys:
        value = data[key]
        if not isinstance(value, dict) or "ros__parameters" not in value:
            raise RuntimeError(f"YAML file is not a valid ROS parameter file for node {key}")
        found.update(flat(value["ros__parameters"], namespace))
    kind = message_class("rcl_interfaces/msg/Parameter")
    return {name: kind(name=name, value=get_parameter_value(str(value))) for name, value in found.items()}
