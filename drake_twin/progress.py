"""What a twin is being built of at the moment, for whoever waits."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

_T = TypeVar("_T")

_listener: ContextVar[Callable[[str], None] | None] = ContextVar("progress", default=None)


@contextmanager
def heard(listener: Callable[[str], None]) -> Iterator[None]:
    """Tells a function of what is done inside the block."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def told(what: str, items: Sequence[_T], name: Callable[[_T], str]) -> Iterable[_T]:
    """The items, each told of as it comes: ``reads robot_3 (3 of 500)``."""
    for index, item in enumerate(items, start=1):
        tell(f"{what} {name(item)} ({index} of {len(items)})")
        yield item


def tell(what: str) -> None:
    """Tells what is done next, if anybody listens."""
    if (listener := _listener.get()) is not None:
        listener(what)
