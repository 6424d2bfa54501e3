"""The page of a program: its server and its scene, which survive a rebuilt twin."""

import atexit
import os
import sys

from drake_twin.cockpit.access import Access, door
from drake_twin.cockpit.cockpit import Cockpit
from drake_twin.cockpit.listening import bind
from drake_twin.cockpit.page_tokens import PageTokens
from drake_twin.cockpit.player import Player
from drake_twin.cockpit.scene import Scene
from drake_twin.cockpit.server import PageServer
from drake_twin.description.mesh_cache import cache_folder
from drake_twin.program import say
from drake_twin.twin.twin import Twin


class ServedPage:
    """A page that shows and steers a twin.

    Args:
        port: The page's port; by default the first free one from 7000 on.
        host: The address to listen on.
        in_frames: Whether pages of other servers on this machine, such as a notebook's, may show it in an iframe.

    Attributes:
        scene: The scene that it draws.
        server: The page's server.

    Raises:
        InputError: If the port or the address cannot be used.
    """

    def __init__(self, port: int | None = None, host: str = "127.0.0.1", *, in_frames: bool = False):
        listening = bind(port, host)
        self.scene = Scene()
        access = Access(host, listening.getsockname()[1])
        tokens = PageTokens(cache_folder("page") / f"pages-{access.port}" if access.is_local else None)
        self.server = PageServer(listening, host, self.scene, access, tokens, in_frames=in_frames)
        self._cockpit: Cockpit | None = None

    @property
    def url(self) -> str:
        """The address that opens a page, with the program's key."""
        return self.server.url

    def announce(self, *, open_browser: bool) -> None:
        """Print the page's address, and open it in a browser if that is wanted and there is a desktop."""
        say(f"page: {self.url}")
        has_desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or sys.platform == "darwin"
        if not (open_browser and has_desktop):
            return
        import webbrowser

        try:
            file = door(cache_folder("page"), self.server.access)
        except OSError as error:
            say(f"no browser is opened: its address cannot be kept from other users ({error.strerror})", sys.stderr)
            return
        atexit.register(file.unlink, missing_ok=True)
        webbrowser.open(file.as_uri())

    def show(self, twin: Twin, *, only_displayed: bool = False, player: Player | None = None) -> Cockpit:
        """Show a twin in place of the one before.

        Args:
            twin: The twin.
            only_displayed: Whether the twin stays paused and the page sets its joint positions.
            player: What moves a twin that does not advance, in its place.

        Returns:
            The twin's cockpit; its ``process_requests`` must be called between steps.
        """
        if self._cockpit is None:
            self.scene.set_up(twin)
        else:
            self._cockpit.close()
        if only_displayed:
            twin.pause()
        self._cockpit = Cockpit(self.server, self.scene, twin, only_displayed=only_displayed, player=player)
        return self._cockpit

    def close(self) -> None:
        """Disconnect the twin and end the server."""
        if self._cockpit is not None:
            self._cockpit.close()
        self.server.close()
