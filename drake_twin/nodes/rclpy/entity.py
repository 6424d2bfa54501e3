"""What a node has that an executor waits for."""

from typing import Any, Protocol


class Entity(Protocol):
    """A timer, a subscription, a service, a client, an action or a guard condition."""

    callback_group: Any

    def is_ready(self) -> bool:
        """Return whether there is something to do."""

    def due(self) -> float:
        """Return the time (ns) at which there will be something to do; infinite without one."""

    def execute(self) -> Any:
        """Do one thing; return a coroutine if its callback is one."""
