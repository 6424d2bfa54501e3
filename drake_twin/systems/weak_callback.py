"""Callbacks that do not keep their system alive."""

from collections.abc import Callable
from typing import Any
from weakref import ref


def weakly(method: Any, *first: Any) -> Callable[..., Any]:
    """Return a callback that calls a bound method with some first arguments, and holds its object weakly.

    A system owns its ports, and a port owns its callback: with a plain bound method the three keep each other alive and
    a discarded diagram is never freed (drake#22515).
    """
    reference, function = ref(method.__self__), method.__func__

    def call(*arguments: Any) -> Any:
        owner = reference()
        assert owner is not None, "a port was evaluated after its system was freed"
        return function(owner, *first, *arguments)

    return call
