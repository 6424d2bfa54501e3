"""The services of other programs that nodes ask."""

from collections.abc import Callable, Iterator
from typing import Any, Protocol

from drake_twin.nodes.graph_items import Caller


class Source(Protocol):
    """Where the services of other programs are found."""

    def has_service(self, name: str, kind: str) -> bool:
        """Return whether a service of a type is there."""

    def ask(self, name: str, kind: str, request: Any, answered: Callable[[Any], None]) -> None:
        """Send a request; `answered` takes the response, in the simulation's thread."""


class OutsideServices:
    """Which services nodes ask, and those of them that other programs offer.

    Args:
        is_own: Returns whether the twin or a node offers a service of a type.
        changed: Is called whenever a node begins to ask.

    Attributes:
        source: Where they are found; None without a wire.
    """

    def __init__(self, is_own: Callable[[str, str], bool], changed: Callable[[], None]):
        self.source: Source | None = None
        self._is_own, self._changed = is_own, changed
        self._callers: list[Caller] = []

    def add(self, caller: Caller) -> None:
        """Add a service that a node asks."""
        self._callers.append(caller)
        self._changed()

    def remove(self, caller: Caller) -> None:
        """Remove a service that a node asks."""
        if caller in self._callers:
            self._callers.remove(caller)

    @property
    def callers(self) -> tuple[Caller, ...]:
        """What nodes ask."""
        return tuple(self._callers)

    def wanted(self) -> Iterator[Caller]:
        """Yield the services that are looked for in other programs."""
        return (caller for caller in self._callers if not self._is_own(caller.name, caller.type))

    def has_service(self, name: str, kind: str) -> bool:
        """Return whether another program offers a service of a type."""
        return self.source is not None and self.source.has_service(name, kind)

    def ask(self, name: str, kind: str, request: Any, answered: Callable[[Any], None]) -> bool:
        """Send a request; return whether the service is there."""
        if self.source is None or not self.source.has_service(name, kind):
            return False
        self.source.ask(name, kind, request, answered)
        return True
