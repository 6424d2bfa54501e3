"""What launch files give where ROS takes a text: text, a path, a substitution, or nested lists of them."""

from collections.abc import Iterable, Iterator
from pathlib import PurePath
from typing import Any


def text_parts(subst: Any) -> Iterator[Any]:
    """Yield the parts of a text in order: each a string, or a substitution, which has ``perform``.

    Raises:
        TypeError: If a part is something else.
    """
    if isinstance(subst, str):
        yield subst
    elif isinstance(subst, PurePath):
        yield str(subst)
    elif hasattr(subst, "perform"):
        yield subst
    elif isinstance(subst, Iterable):
        for part in subst:
            yield from text_parts(part)
    else:
        raise TypeError(
            f"text, a substitution or a list of them is needed, and {subst!r} is of type {type(subst).__name__}"
        )


def as_text(value: Any) -> Any:
    """Return a number or truth value, which ROS takes in some places, as text; another value as it is."""
    return str(value) if isinstance(value, bool | int | float) else value


def as_texts(value: Any) -> Any:
    """Return numbers and truth values, also those in lists, as text."""
    return [as_texts(item) for item in value] if isinstance(value, list | tuple) else as_text(value)
