"""Progress of building a twin: what is done at the moment, for a listener such as a status line."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

_T = TypeVar("_T")

_listener: ContextVar[Callable[[str], None] | None] = ContextVar("progress", default=None)


@contextmanager
def heard(listener: Callable[[str], None]) -> Iterator[None]:
    """Call a function with each step that is reported inside the block."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def told(what: str, items: Sequence[_T], name: Callable[[_T], str]) -> Iterable[_T]:
    """Yield the items, and report each one: ``reads robot_3 (3 of 500)``."""
    for index, item in enumerate(items, start=1):
        tell(f"{what} {name(item)} ({index} of {len(items)})")
        yield item


def tell(what: str) -> None:
    """Report the next step, if there is a listener."""
    if (listener := _listener.get()) is not None:
        listener(what)
