"""The connection graph in Foxglove: which nodes publish, hear and serve what."""

import contextlib
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from drake_twin.wires.wire import WireEndpoint

if TYPE_CHECKING:
    from foxglove.websocket import ConnectionGraph

PUBLISHED, SUBSCRIBED, SERVED = "published_topic", "subscribed_topic", "advertised_service"
_LATER = 0.05  # s of wall time in which changes are told together


class FoxgloveGraph:
    """Tells the connection graph while a client watches it.

    Args:
        tell: Is called with the graph, in a thread of its own: the server must not be called where it tells of clients.
    """

    def __init__(self, tell: "Callable[[ConnectionGraph], None]") -> None:
        self._nodes: dict[tuple[str, str], str] = {}
        self._tell = tell
        self._is_watched = False
        self._timer: threading.Timer | None = None
        self._lock = threading.Lock()

    def add(self, kind: str, endpoint: WireEndpoint) -> None:
        """Add what a node publishes, hears or serves."""
        with self._lock:
            self._nodes[kind, endpoint.name] = endpoint.node
            self._tell_later()

    def remove(self, kind: str, endpoint: WireEndpoint) -> None:
        """Remove it."""
        with self._lock:
            self._nodes.pop((kind, endpoint.name), None)
            self._tell_later()

    def watch(self, is_watched: bool) -> None:
        """Follow whether any client watches."""
        with self._lock:
            self._is_watched = is_watched
            self._tell_later()

    def close(self) -> None:
        """Tell nothing more."""
        self.watch(False)

    def _tell_later(self) -> None:
        if self._timer is None and self._is_watched:
            self._timer = threading.Timer(_LATER, self._tell_now)
            self._timer.daemon = True
            self._timer.start()

    def _tell_now(self) -> None:
        from foxglove.websocket import ConnectionGraph

        graph = ConnectionGraph()
        with self._lock:
            self._timer = None
            if not self._is_watched:
                return
            for (kind, name), node in self._nodes.items():
                getattr(graph, f"set_{kind}")(name, [node])
        with contextlib.suppress(Exception):  # of a server that has just ended
            self._tell(graph)
