"""The fields of ROS messages: their default values, what may be assigned to them, and the twin's own messages of them.

What rosidl_generator_py refuses is an ``AssertionError`` with its words. Sequences and arrays of numbers are taken as
Jazzy takes them, which has these checks switched off: whatever ``array.array`` or ``numpy.array`` makes the same
numbers of. A message that is made with ``check_fields=True`` is as strict there as Humble.
"""

import array
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from typing import Any

import numpy as np

from drake_twin.nodes.message_elements import Element


class Field:
    """A field with one value.

    Args:
        name: Its name.
        element: What its value is.

    Attributes:
        default: Returns the value that it has in a new message.
        slot: The name of the attribute that holds its value.
    """

    # Whether what it holds can change without an assignment.
    is_open = False

    def __init__(self, name: str, element: Element):
        self.name, self.element = name, element
        self.default: Callable[[], Any] = self.zero
        self.slot = f"_{name}"

    @property
    def type_text(self) -> str:
        """Its type in ``get_fields_and_field_types``."""
        return self.element.text

    def zero(self) -> Any:
        """Return the value that it has where its definition gives none."""
        return self.element.zero()

    def checked(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value has been assigned.

        Raises:
            AssertionError: If it does not take the value.
        """
        element = self.element
        if not element.has_type(value):
            raise AssertionError(f"The '{self.name}' field must be {element.type_words}")
        if not element.is_in_range(value):
            raise AssertionError(f"The '{self.name}' field must be {element.range_words}")
        return value

    def unchecked(self, value: Any) -> Any:
        """Return what the field holds once a value has been assigned without checks."""
        return value

    def constructed(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value was passed to its message's constructor."""
        return self.checked(value, strictly=strictly)

    def to_wire(self, value: Any) -> Any:
        """Return what it holds as the twin's messages have it."""
        return self.element.to_wire(value)

    def from_wire(self, value: Any) -> Any:
        """Return what it holds for a value of one of the twin's messages."""
        return self.element.from_wire(value)

    def shown(self, value: Any) -> str:
        """Return what it holds as ``repr`` of the message shows it."""
        return repr(value)

    def differs(self, one: Any, other: Any) -> bool:
        """Return whether two values make two messages unequal."""
        return bool(one != other)


class ListField(Field):
    """A sequence or an array of elements that are no numbers.

    Args:
        name: Its name.
        element: What it holds.
        limit: The greatest length of a sequence; zero for none.
        size: The length of an array; zero for a sequence.
    """

    is_open = True

    def __init__(self, name: str, element: Element, *, limit: int = 0, size: int = 0):
        super().__init__(name, element)
        self.limit, self.size = limit, size

    @property
    def type_text(self) -> str:
        """Its type in ``get_fields_and_field_types``."""
        if self.size:
            return f"{self.element.text}[{self.size}]"
        return f"sequence<{self.element.text}, {self.limit}>" if self.limit else f"sequence<{self.element.text}>"

    def zero(self) -> Any:
        """Return the value that it has where its definition gives none."""
        return [self.element.zero() for _ in range(self.size)]

    def checked(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value has been assigned.

        Raises:
            AssertionError: If it does not take the value.
        """
        element = self.element
        if (
            not isinstance(value, Sequence | Set | UserList)
            or isinstance(value, str | UserString)
            or not self._fits(len(value))
            or not all(element.has_type(each) and element.is_in_range(each) for each in value)
        ):
            raise AssertionError(f"The '{self.name}' field must be {self._words()}")
        return value

    def to_wire(self, value: Any) -> Any:
        """Return what it holds as the twin's messages have it."""
        items = [self.element.to_wire(each) for each in value]
        return np.array(items, dtype=self.element.dtype) if self.element.dtype else items

    def from_wire(self, value: Any) -> Any:
        """Return what it holds for a value of one of the twin's messages."""
        return [self.element.from_wire(each) for each in value]

    def _fits(self, length: int) -> bool:
        if self.size:
            return length == self.size
        return not self.limit or length <= self.limit

    def _words(self) -> str:
        element = self.element
        length = f"with length {self.size}" if self.size else f"with length <= {self.limit}" if self.limit else ""
        each = f"and each value of type '{element.python_type}'"
        words = ("a set or sequence", length, element.length_words, each, element.each_words)
        return " ".join(word for word in words if word)


class NumberSequence(ListField):
    """A sequence of numbers: an ``array.array``."""

    def zero(self) -> Any:
        """Return the value that it has where its definition gives none."""
        return array.array(self.element.code)

    def checked(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value has been assigned.

        Raises:
            AssertionError: If it does not take the value.
        """
        if isinstance(value, array.array):
            if strictly and value.typecode != self.element.code:
                what = f"have the type code of '{self.element.code}'"
                raise AssertionError(f"The '{self.name}' array.array() must {what}")
            if not self._fits(len(value)):
                raise AssertionError(f"The '{self.name}' array.array() must have a size <= {self.limit}")
            if value.typecode == self.element.code:
                return value
        if strictly:
            super().checked(value)
        return self.constructed(value)

    def unchecked(self, value: Any) -> Any:
        """Return what the field holds once a value has been assigned without checks."""
        return array.array(self.element.code, value)

    def constructed(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value was passed to its message's constructor."""
        try:
            held = array.array(self.element.code, value)
        except (TypeError, ValueError, OverflowError) as error:
            raise AssertionError(f"The '{self.name}' field must be {self._words()}") from error
        if not self._fits(len(held)):
            raise AssertionError(f"The '{self.name}' array.array() must have a size <= {self.limit}")
        return held

    def to_wire(self, value: Any) -> Any:
        """Return what it holds as the twin's messages have it."""
        return np.array(value, dtype=self.element.dtype)

    def from_wire(self, value: Any) -> Any:
        """Return what it holds for a value of one of the twin's messages."""
        held = array.array(self.element.code)
        held.frombytes(np.ascontiguousarray(value, dtype=self.element.dtype).tobytes())
        return held

    def shown(self, value: Any) -> str:
        """Return what it holds as ``repr`` of the message shows it."""
        return repr(value)[len("array('d', ") : -1] if len(value) else "[]"


class NumberArray(ListField):
    """An array of numbers of a fixed length: a NumPy array."""

    def zero(self) -> Any:
        """Return the value that it has where its definition gives none."""
        return np.zeros(self.size, dtype=self.element.dtype)

    def checked(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value has been assigned.

        Raises:
            AssertionError: If it does not take the value.
        """
        dtype = np.dtype(self.element.dtype)
        if isinstance(value, np.ndarray):
            if strictly and value.dtype != dtype:
                raise AssertionError(f"The '{self.name}' numpy.ndarray() must have the dtype of 'numpy.{dtype}'")
            if value.size != self.size:
                raise AssertionError(f"The '{self.name}' numpy.ndarray() must have a size of {self.size}")
            if value.dtype == dtype:
                return value
        elif strictly:
            super().checked(value)
        return self.constructed(value)

    def unchecked(self, value: Any) -> Any:
        """Return what the field holds once a value has been assigned without checks."""
        return np.array(value, dtype=self.element.dtype)

    def constructed(self, value: Any, *, strictly: bool = False) -> Any:
        """Return what the field holds once a value was passed to its message's constructor."""
        try:
            held = np.array(value, dtype=self.element.dtype)
            is_same = held.dtype.kind == "f" or held.tolist() == list(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise AssertionError(f"The '{self.name}' field must be {self._words()}") from error
        if held.shape != (self.size,) or not is_same:
            raise AssertionError(f"The '{self.name}' field must be {self._words()}")
        return held

    def to_wire(self, value: Any) -> Any:
        """Return what it holds as the twin's messages have it."""
        return np.array(value, dtype=self.element.dtype).reshape(self.size)

    def from_wire(self, value: Any) -> Any:
        """Return what it holds for a value of one of the twin's messages."""
        return np.array(value, dtype=self.element.dtype)

    def differs(self, one: Any, other: Any) -> bool:
        """Return whether all elements differ: what rosidl_generator_py asks for."""
        return bool(np.all(one != other))
