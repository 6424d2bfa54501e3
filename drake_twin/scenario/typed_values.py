"""Values of dataclasses against their annotated types: which do not fit, and what they should be."""

import dataclasses
import reprlib
from collections.abc import Iterator, Mapping
from math import isfinite
from typing import Any

from drake_twin.typed_data import ValuePath, field_types, misfit


def misfits(value: Any, path: ValuePath) -> Iterator[tuple[ValuePath, str]]:
    """Find values that do not fit their annotated types, and numbers that are not finite.

    Args:
        value: A dataclass, or a value in one.
        path: The keys and indices that lead to it.

    Yields:
        The path of each, and what is wrong with it.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for item in dataclasses.fields(value):
            below = getattr(value, item.name)
            wanted = misfit(field_types(type(value))[item.name], below, (tuple, list))
            if wanted is not None:
                yield (*path, item.name), f"{reprlib.repr(below)} is not {wanted}"
                return
            yield from misfits(below, (*path, item.name))
    elif isinstance(value, Mapping):
        for key, below in value.items():
            yield from misfits(below, (*path, key))
    elif isinstance(value, tuple) and path and path[-1] != "data":  # a command's data is checked by its controller
        for index, below in enumerate(value):
            yield from misfits(below, (*path, index))
    elif isinstance(value, float) and not isfinite(value):
        yield path, f"{value!r} is not a finite number"
