"""Enumerations and structures that are C++ in rclpy: not iterated over, and with signatures that cannot be read."""

from collections.abc import Callable
from typing import Any, ClassVar, Self, TypeVar

_Any = TypeVar("_Any", bound=Callable[..., Any])


def unreadable(function: _Any) -> _Any:
    """Let a function have no signature, as those of pybind11."""
    function.__signature__ = "C++"  # type: ignore[attr-defined]
    return function


class NativeEnum:
    """A value of an enumeration, as pybind11 has it."""

    __members__: ClassVar[dict[str, Any]]
    _values: ClassVar[dict[int, Any]]
    _name: str
    _value: int

    def __init_subclass__(cls) -> None:
        cls.__members__, cls._values = {}, {}

    def __new__(cls, value: int) -> Self:
        if value not in cls._values:
            raise ValueError(f"{value} is not a value of {cls.__name__}")
        found: Self = cls._values[value]
        return found

    @unreadable
    def __init__(self, value: int):
        pass

    @classmethod
    def _add(cls, **values: int) -> None:
        for name, value in values.items():
            item = object.__new__(cls)
            item._name, item._value = name, value
            cls.__members__[name] = cls._values[value] = item
            setattr(cls, name, item)

    name = property(lambda self: self._name)
    value = property(lambda self: self._value)

    def __int__(self) -> int:
        return self._value

    __index__ = __int__

    def __repr__(self) -> str:
        return f"<{type(self).__name__}.{self._name}: {self._value}>"

    def __str__(self) -> str:
        return f"{type(self).__name__}.{self._name}"


def native_enum(name: str, doc: str, module: str, **values: int) -> Any:
    """Return the class of an enumeration with some values."""
    cls: Any = type(name, (NativeEnum,), {"__doc__": doc, "__module__": module})
    cls._add(**values)
    return cls
