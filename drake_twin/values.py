"""The readers of numbers, flags and vectors, from the text of XML and from the values of YAML."""

from math import inf, isfinite
from numbers import Real
from typing import Any

LARGEST = 1e12  # m, kg, kg·m² or N·m·s; larger numbers are mistakes, and overflow in the simulation

_COUNT_WORDS = {2: "two", 3: "three", 6: "six", 7: "seven"}


def is_number(value: Any, least: float = -inf) -> bool:
    """Tell whether a value is a finite real number, not below a bound; true and false are not numbers."""
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value) and float(value) >= least
    except OverflowError:  # an integer that is too large for a float
        return False


def parse_number(text: str) -> float:
    """Read text as a finite number, written as in C: Python would also take ``1_000`` and the digits of any script.

    Raises:
        ValueError: If the text is not a number, or not a finite one; the message says which.
    """
    value = number_or_none(text)
    if value is None:
        raise ValueError("not a number")
    if not isfinite(value):
        raise ValueError("not finite")
    return value


def number_or_none(text: str | None) -> float | None:
    """Read text as a number, which may be infinite or NaN; return None for anything else."""
    try:
        return float(text) if text is not None and text.isascii() and "_" not in text else None
    except ValueError:
        return None


def yaml_number(value: Any) -> float | None:
    """Read a YAML value as a number, also as text, because YAML 1.1 takes ``1e-3`` for text; return None for others."""
    if isinstance(value, str):
        return number_or_none(value)
    try:
        return float(value) if isinstance(value, Real) and not isinstance(value, bool) else None
    except OverflowError:  # an integer that is too large for a float
        return None


def is_true(text: str | None) -> bool:
    """Tell whether text is ``true`` or ``1``, as the flags of URDF and SDF are written."""
    return (text or "").strip().lower() in ("1", "true")


def needed(count: int) -> str:
    """Say how many numbers are needed, for an error message."""
    return "one number is needed" if count == 1 else f"{_COUNT_WORDS.get(count, count)} numbers are needed"
