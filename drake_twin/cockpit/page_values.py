"""What the values of a user's own panels may be, and what plots, tables and images are on the page."""

import base64
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from math import isfinite
from numbers import Real
from typing import Any, cast

import numpy as np

from drake_twin.errors import InputError
from drake_twin.messages import shortened

LONGEST_TEXT = 1000  # characters
_LARGEST = 1e300  # of a number
_MOST_CURVES = 40
_MOST_ROWS, _MOST_COLUMNS = 200, 20
_WIDEST = 640  # pixels of an image on the page


def number_between(lower: float | None, upper: float | None, unit: str) -> Callable[[Any], float]:
    """Return a check for numbers between two bounds, which are included; None for no bound."""
    low, high = (None if bound is None else finite(bound) for bound in (lower, upper))
    if low is not None and high is not None and low >= high:
        raise InputError(f"the range from {low:g} to {high:g} is empty")

    def check(value: Any) -> float:
        number = finite(value)
        if (low is not None and number < low) or (high is not None and number > high):
            bounds = [f"{word} {bound:g}" for word, bound in (("from", low), ("to", high)) if bound is not None]
            raise InputError(f"{' '.join((f'{number:g}', unit)).strip()} lies outside of its range {' '.join(bounds)}")
        return number

    return check


def finite(value: Any) -> float:
    """Return a number.

    Raises:
        InputError: If it is something else, or not finite.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real) or not abs(cast(float, value)) < _LARGEST:
        raise InputError(f"{shortened(value)} is not a finite number")
    return float(value)


def flag(value: Any) -> bool:
    """Return True or False.

    Raises:
        InputError: If it is something else.
    """
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{shortened(value)} is neither true nor false")
    return bool(value)


def short_text(value: Any) -> str:
    """Return a text of one line.

    Raises:
        InputError: If it is something else, or too long.
    """
    if not isinstance(value, str) or len(value) > LONGEST_TEXT or not value.isprintable():
        raise InputError(f"{shortened(value)} is not a text of one line, of at most {LONGEST_TEXT} characters")
    return value


def one_of(choices: Sequence[str]) -> Callable[[Any], str]:
    """Return a check for one of several texts."""

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in choices:
            raise InputError(f"unknown choice {shortened(value)}", value=str(value), valid=choices)
        return value

    return check


def vector3(value: Any, what: str) -> tuple[float, float, float]:
    """Return three finite numbers.

    Raises:
        InputError: If it is something else.
    """
    items = list(islice(value, 4)) if isinstance(value, Iterable) else []
    if len(items) != 3:
        raise InputError(f"{what} is three numbers, not {shortened(value)}")
    x, y, z = (finite(item) for item in items)
    return (x, y, z)


def curves(value: Any, label: str) -> dict[str, float | None]:
    """Return the numbers of a plot by the names of their curves: of a number, several of them, or a mapping.

    Raises:
        InputError: If it is something else, or there are too many.
    """
    if isinstance(value, Mapping):
        found = {str(name): each for name, each in value.items()}
    elif isinstance(value, Iterable) and not isinstance(value, str):
        found = {str(place): each for place, each in enumerate(islice(value, _MOST_CURVES + 1), 1)}
    else:
        found = {label: value}
    if len(found) > _MOST_CURVES:
        raise InputError(f"a plot has {_MOST_CURVES} curves at most")
    for each in found.values():
        if isinstance(each, bool | np.bool_) or not isinstance(each, Real):
            raise InputError(f"{shortened(each)} is not a number to plot")
    return {name: float(each) if isfinite(each) else None for name, each in found.items()}


def rows(value: Any, columns: Sequence[str]) -> list[list[str]]:
    """Return the rows of a table as texts: of a mapping from names to a value or several, or of rows.

    Raises:
        InputError: If it is something else, too large, or does not fit its columns.
    """
    items = value.items() if isinstance(value, Mapping) else value
    if not isinstance(items, Iterable) or isinstance(items, str):
        raise InputError(f"{shortened(value)} is not a mapping or a list of rows")
    found = []
    for row in islice(items, _MOST_ROWS + 1):
        if isinstance(value, Mapping):
            name, rest = row
            row = (name, *(rest if isinstance(rest, list | tuple | np.ndarray) else (rest,)))
        if isinstance(row, str) or not isinstance(row, Iterable):
            raise InputError(f"{shortened(row)} is not a row of a table")
        found.append([_cell(cell) for cell in islice(row, _MOST_COLUMNS + 1)])
    if len(found) > _MOST_ROWS or any(len(row) > _MOST_COLUMNS for row in found):
        raise InputError(f"a table has {_MOST_ROWS} rows and {_MOST_COLUMNS} columns at most")
    if columns and any(len(row) != len(columns) for row in found):
        raise InputError(f"a row does not have the {len(columns)} columns of the table")
    return found


def _cell(value: Any) -> str:
    is_number = isinstance(value, Real) and not isinstance(value, bool | np.bool_ | int)
    return (f"{float(value):.6g}" if is_number else str(value))[:LONGEST_TEXT]


def png_of(value: Any) -> str:
    """Return an image as a PNG in Base64, with fewer pixels if it is wide.

    Raises:
        InputError: If it is not an array of bytes, shape (height, width), (height, width, 3) or (height, width, 4).
    """
    from PIL import Image

    picture = np.asarray(value)
    fits = picture.ndim == 2 or (picture.ndim == 3 and picture.shape[2] in (3, 4))
    if picture.dtype != np.uint8 or not fits or not picture.size:
        what = f"an array of {picture.dtype}, shape {picture.shape}"
        raise InputError(f"an image is an array of uint8, shape (height, width) or (height, width, 3), not {what}")
    every = -(-max(picture.shape[:2]) // _WIDEST)
    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture[::every, ::every])).save(file, "png", compress_level=1)
    return base64.b64encode(file.getvalue()).decode()
