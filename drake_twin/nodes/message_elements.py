"""What a field of a ROS message is made of, with the checks and words of rosidl_generator_py (Jazzy).

An element is a number, a flag, a text, a byte or a message; `drake_twin.nodes.message_fields` makes fields of them:
single ones, sequences and arrays.
"""

import struct
from collections import UserString
from collections.abc import Callable
from math import isinf
from typing import Any

from drake_twin.dataclass import dataclass

_FLOAT32 = struct.Struct("f")


def _anything(value: Any) -> bool:
    return True


def _same(value: Any) -> Any:
    return value


@dataclass(frozen=True)
class Element:
    """One value of a field.

    Attributes:
        text: Its type in ``get_fields_and_field_types``.
        python_type: The name of its Python type.
        zero: Returns the value that a field has by default.
        has_type: Returns whether a value is of the type.
        is_in_range: Returns whether a value of the type is in its range.
        type_words: What a field of another type must be.
        range_words: What a field out of range must be.
        length_words: How long each value of a sequence must be.
        each_words: The range that each value of a sequence must have.
        code: The type code of an ``array.array`` of them; empty if sequences of them are lists.
        dtype: The NumPy type of an array of them in the twin's messages; empty if such arrays are lists.
        to_wire: Returns a value as the twin's messages have it.
        from_wire: Returns the value of one of the twin's messages.
    """

    text: str
    python_type: str
    zero: Callable[[], Any]
    has_type: Callable[[Any], bool]
    type_words: str
    is_in_range: Callable[[Any], bool] = _anything
    range_words: str = ""
    length_words: str = ""
    each_words: str = ""
    code: str = ""
    dtype: str = ""
    to_wire: Callable[[Any], Any] = _same
    from_wire: Callable[[Any], Any] = _same


def integer(bits: int, *, is_signed: bool) -> Element:
    """Return a whole number of so many bits."""
    name = f"int{bits}" if is_signed else f"uint{bits}"
    code = {8: "b", 16: "h", 32: "i", 64: "q"}[bits]
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)
    words = f"{'' if is_signed else 'unsigned '}integer in [{low}, {high}]"
    return Element(
        name,
        "int",
        int,
        lambda value: isinstance(value, int),
        "of type 'int'",
        lambda value: bool(low <= value <= high),
        f"an {words}",
        each_words=f"and each {words}",
        code=code if is_signed else code.upper(),
        dtype=name,
        to_wire=int,
        from_wire=int,
    )


def real(bits: int) -> Element:
    """Return a number of 32 or 64 bits."""
    name, code, high = ("float", "f", 3.402823466e38) if bits == 32 else ("double", "d", 1.7976931348623157e308)
    return Element(
        name,
        "float",
        float,
        lambda value: isinstance(value, float),
        "of type 'float'",
        lambda value: not (value < -high or value > high) or isinf(value),
        f"a {name} in [{-high}, {high}]",
        each_words=f"and each {name} in [{-high:f}, {high:f}]",
        code=code,
        dtype=f"float{bits}",
        to_wire=float,
        from_wire=float if bits == 64 else _rounded_to_32_bits,
    )


def string(limit: int = 0) -> Element:
    """Return a text, of so many characters at most; of any number if the limit is zero."""
    if not limit:
        return Element("string", "str", str, lambda value: isinstance(value, str), "of type 'str'", to_wire=_plain)
    words = f"string value not longer than {limit}"
    return Element(
        f"string<{limit}>",
        "str",
        str,
        lambda value: isinstance(value, str | UserString),
        words,
        lambda value: len(value) <= limit,
        words,
        f"and each {words}",
        to_wire=_plain,
    )


BOOLEAN = Element(
    "boolean",
    "bool",
    bool,
    lambda value: isinstance(value, bool),
    "of type 'bool'",
    dtype="bool",
    from_wire=bool,
)

# A byte is `bytes` of length one; the twin's messages have rosbags' number in [-128, 127].
OCTET = Element(
    "octet",
    "bytes",
    lambda: b"\0",
    lambda value: isinstance(value, bytes | bytearray | memoryview),
    "of type 'bytes' or 'ByteString' with length 1",
    lambda value: len(value) == 1,
    "of type 'bytes' or 'ByteString' with length 1",
    dtype="int8",
    to_wire=lambda value: (int(value[0]) + 128) % 256 - 128,
    from_wire=lambda value: bytes((int(value) & 0xFF,)),
)


def _plain(value: Any) -> str:
    """Return a text itself, of an enum's member, too, whose ``str`` is its name."""
    return str.__str__(value) if isinstance(value, str) else str(value)


def _rounded_to_32_bits(value: Any) -> float:
    """Return a number as its receiver reads it."""
    return float(_FLOAT32.unpack(_FLOAT32.pack(value))[0])
