"""The page of a program: its server and its scene, which outlive a twin that is made anew."""

from dataclasses import replace

from drake_twin.cockpit.access import Access, kept_token
from drake_twin.cockpit.cockpit import Cockpit
from drake_twin.cockpit.scene import Scene
from drake_twin.cockpit.server import PageServer, bind
from drake_twin.description.mesh_cache import cache_folder
from drake_twin.twin.twin import Twin


class ServedPage:
    """A page that shows and steers a twin.

    Args:
        port: its port; by default the first free one from 7000 on.
        host: the address to listen at.

    Attributes:
        scene: what it draws.
        server: the page's server.

    Raises:
        InputError: the port or the address cannot be used.
    """

    def __init__(self, port: int | None = None, host: str = "127.0.0.1"):
        listening = bind(port, host)
        self.scene = Scene()
        self.server = PageServer(listening, host, self.scene, _access(host, listening.getsockname()[1]))
        self._cockpit: Cockpit | None = None

    @property
    def url(self) -> str:
        """Its address, with the token of this run."""
        return self.server.url

    def show(self, twin: Twin, *, only_displayed: bool = False) -> Cockpit:
        """Shows a twin instead of the one before.

        Args:
            twin: the twin.
            only_displayed: whether its time stands still and its joints go where the page puts them.

        Returns:
            What does as the page says; its ``obey`` is to be called between steps.
        """
        if self._cockpit is None:
            self.scene.set_up(twin)
        else:
            self._cockpit.close()
        if only_displayed:
            twin.pause()
        self._cockpit = Cockpit(self.server, self.scene, twin, only_displayed=only_displayed)
        return self._cockpit

    def close(self) -> None:
        """Ends the page."""
        if self._cockpit is not None:
            self._cockpit.close()
        self.server.close()


def _access(host: str, port: int) -> Access:
    """The token that the page had before, unless other machines can reach it."""
    access = Access(host, port)
    return replace(access, token=kept_token(cache_folder("page"), port)) if access.is_local else access
