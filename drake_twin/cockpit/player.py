"""What may move a twin that does not advance, such as a bag that is played."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from drake_twin.cockpit import protocol
from drake_twin.cockpit.panel import Panel
from drake_twin.cockpit.scene import Scene
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

    @property
    def logs(self) -> tuple[tuple[str, str, float], ...]:
        """Messages from before: kind, text and time (s)."""

    @property
    def panels(self) -> Mapping[str, Panel]:
        """The panels that it has in place of those of a twin, by name."""

    def do(self, request: protocol.Request) -> None:
        """Process a request of the page that needs physics otherwise.

        Raises:
            InputError: If it cannot.
        """

    def sensors(self, scene: Scene, send: Callable[[str, bytes], None]) -> Any:
        """Return what it has in place of a `SensorView`.

        Args:
            scene: The page's scene.
            send: Sends a picture to all browsers: its key, and a JSON line with its bytes.
        """

    def amend(self, state: dict[str, Any]) -> None:
        """Put its own time and values into a state of the page."""
