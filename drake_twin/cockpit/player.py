"""What may move a twin that does not advance, such as a bag that is played."""

from typing import Any, Protocol

from drake_twin.cockpit import protocol
from drake_twin.findings import Finding


class Player(Protocol):
    """Something that poses the robots of a twin, and has a time of its own.

    Attributes:
        time: The present moment (s).
        paused: Whether time stands still.
        findings: What the page says of the robots' files.
    """

    findings: tuple[Finding, ...]
    time: float
    paused: bool

    def do(self, request: protocol.Request) -> None:
        """Process a request of the page that needs physics otherwise.

        Raises:
            InputError: If it cannot.
        """

    def amend(self, state: dict[str, Any]) -> None:
        """Put its own time and values into a state of the page."""
