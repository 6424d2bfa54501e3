"""Which evaluation is active: what code of a launch file that is given no context belongs to."""

from collections.abc import Iterator
from contextlib import contextmanager

from drake_twin.ros2.launch.launch_context import LaunchContext

_active: list[LaunchContext] = []


@contextmanager
def active(context: LaunchContext) -> Iterator[None]:
    """Make a context the active one."""
    _active.append(context)
    try:
        yield
    finally:
        _active.remove(context)


def current_context() -> LaunchContext:
    """Return the active context; a new one where nothing is evaluated, as in a plain Python program."""
    return _active[-1] if _active else LaunchContext()
