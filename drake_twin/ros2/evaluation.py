"""Which evaluation is going on: what code of a launch file that gets no context belongs to."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_active: list[LaunchContext] = []


@contextmanager
def active(context: LaunchContext) -> Iterator[None]:
    """Makes a context the one at hand."""
    _active.append(context)
    try:
        yield
    finally:
        _active.remove(context)


def current_context() -> LaunchContext:
    """The context at hand; a fresh one where nothing is evaluated, as in a plain Python program."""
    from drake_twin.ros2.context import LaunchContext

    return _active[-1] if _active else LaunchContext()
