"""Callbacks that do not keep their system alive."""

from collections.abc import Callable
from typing import Any
from weakref import WeakMethod


def weakly(method: Callable[..., Any], *first: Any) -> Callable[..., Any]:
    """A bound method as a callback that holds its object weakly, given some first arguments.

    A system owns its ports, and a port owns its callback: with a plain bound method the three keep each other alive
    and a discarded diagram is never freed (drake#22515).
    """
    reference = WeakMethod(method)

    def call(*arguments: Any) -> Any:
        live_method = reference()
        assert live_method is not None, "a port was evaluated after its system died"
        return live_method(*first, *arguments)

    return call
