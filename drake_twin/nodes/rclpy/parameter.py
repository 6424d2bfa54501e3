"""Stand-in for ``rclpy.parameter``."""

import array
from enum import IntEnum
from typing import Any

from drake_twin.nodes.message_classes import message_class

PARAMETER_SEPARATOR_STRING = "."


class Parameter:
    """A parameter: its name, type and value."""

    class Type(IntEnum):
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
            if isinstance(value, array.array):
                return cls.INTEGER_ARRAY if value.typecode == "q" else cls.DOUBLE_ARRAY
            if isinstance(value, list | tuple):
                for kind, of_item in _SEVERAL.items():
                    if all(isinstance(item, of_item) for item in value):
                        return kind
            raise TypeError("The given value is not one of the allowed types")

        def check(self, parameter_value: Any) -> bool:
            """Return whether a value has this type."""
            value = parameter_value
            if self == Parameter.Type.NOT_SET:
                return value is None
            if self in _SINGLE:
                is_bool = isinstance(value, bool)
                return isinstance(value, _SINGLE[self]) and (self == Parameter.Type.BOOL or not is_bool)
            items = isinstance(value, list | tuple | array.array)
            return items and all(isinstance(item, _SEVERAL[self]) for item in value)

    def __init__(self, name: str, type_: "Parameter.Type | None" = None, value: Any = None):
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError("type must be an instance of Parameter.Type")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._name, self._type_ = name, type_
        self._value = list(value) if isinstance(value, tuple) else value

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
        return parameter_value(type=int(self._type_), **{field: self._value})

    def to_parameter_msg(self) -> Any:
        kind_of_message = message_class("rcl_interfaces/msg/Parameter")

        return kind_of_message(name=self._name, value=self.get_parameter_value())

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> "Parameter":
        return cls(param_msg.name, Parameter.Type(param_msg.value.type), parameter_value_to_python(param_msg.value))

    def __repr__(self) -> str:
        return f"<rclpy.parameter.Parameter: {self._name!r} = {self._value!r}>"


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
    """Return the value of a ``ParameterValue`` message."""
    kind = Parameter.Type(parameter_value.type)
    if kind == Parameter.Type.NOT_SET:
        return None
    value = getattr(parameter_value, f"{kind.name.lower()}_value")
    return list(value) if kind >= Parameter.Type.BYTE_ARRAY else value


def get_parameter_value(string_value: str) -> Any:
    """Return text as a ``ParameterValue`` message, as YAML reads it."""
    from drake_twin.description.bounded_yaml import load_yaml

    return Parameter("", value=load_yaml(string_value)).get_parameter_value()
