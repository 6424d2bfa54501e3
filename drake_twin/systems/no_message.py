"""Abstract values of ports and caches that may have no message yet.

Drake's Python bindings refuse None in a ``Value[object]`` since 1.58: `NO_MESSAGE` stands for it there, and only there.
Everywhere else in this package the absence of a message is None.
"""

from enum import Enum
from typing import Any, Final

from pydrake.common.value import AbstractValue


class _NoMessage(Enum):  # a copy or a pickle of an enum's member is the member itself
    NO_MESSAGE = 0

    def __bool__(self) -> bool:
        return False

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(
            f"no message has arrived, so it has no field {name!r}: a controller's received(port, context) is None then"
        )


NO_MESSAGE: Final = _NoMessage.NO_MESSAGE
"""What an abstract port holds before the first message; false in a condition, as None is."""


def empty_value() -> AbstractValue:
    """Return a new abstract value without a message."""
    return AbstractValue.Make(NO_MESSAGE)


def make_value(message: Any) -> AbstractValue:
    """Return a new abstract value with a message, or any Python object; without one if it is None."""
    return AbstractValue.Make(NO_MESSAGE if message is None else message)


def set_value(output: AbstractValue, message: Any) -> None:
    """Set an abstract value to a message, or any Python object; to none if it is None."""
    output.set_value(NO_MESSAGE if message is None else message)


def or_none(value: Any) -> Any:
    """Return the message that a port or a cache entry holds; None without one."""
    return None if value is NO_MESSAGE else value
