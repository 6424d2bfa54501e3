"""The page of a program, announced when it has a twin to show."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.cli.target import Target
from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.cockpit.scene import Scene
    from drake_twin.twin.twin import Twin


class ProgramPage:
    """The page in the browser; it survives a twin that is rebuilt.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If the port or the address cannot be used.
    """

    def __init__(self, options: argparse.Namespace):
        from drake_twin.cockpit.served_page import ServedPage

        self._page = ServedPage(options.port, options.host)
        self._open_browser = not options.no_browser
        self._view_sensors: bool = options.view_sensors
        self._compared: Path | None = options.compare
        self._shown: Twin | None = None
        self._process_requests: Callable[[], None] = lambda: None

    @property
    def scene(self) -> "Scene":
        """The scene that it draws."""
        return self._page.scene

    def show(self, twin: "Twin", target: Target) -> Callable[[], None]:
        """Show a twin; return the function that processes the page's requests, to be called each frame."""
        if twin is self._shown:
            return self._process_requests
        cockpit = self._page.show(twin, only_displayed=target.only_displayed)
        self._process_requests = cockpit.process_requests
        if self._view_sensors:
            cockpit.sensors.show_all()
        if self._compared is not None:
            comparison: Any = cockpit.panel("compare")
            comparison.open(self._compared)
        if self._shown is None:
            self._page.announce(open_browser=self._open_browser)
            if not self._page.server.access.is_local:
                say("open to other machines: anyone with this address sees and commands the robots", sys.stderr)
        self._shown = twin
        return self._process_requests
