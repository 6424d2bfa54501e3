"""Shows twins on the page of a ``meshcat-server``, beside those of other processes, each below a folder of its own.

The page outlives the twins. The stock server is started with ``meshcat-server --zmq-url tcp://127.0.0.1:6000``.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.shared_viewer.meshcat_client import FrameCounts, MeshcatClient
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.shared_viewer.viewer_address import check_viewer_address, check_viewer_name
from drake_twin.twin.twin import Twin

_FOLDER = "/twins"


@dataclass(frozen=True)
class ViewerCost:
    """What the frames cost the thread that simulates.

    Attributes:
        frames: how many there were.
        wall_time: what they took in all (s), the reading of the geometry included.
        slowest: what the slowest took (s), the first one apart, which reads the geometry.
    """

    frames: int = 0
    wall_time: float = 0.0
    slowest: float = 0.0


class SharedViewer:
    """A twin's place on a shared page.

    Drawing never waits for the server. Without one the simulation goes on, and the log says so once; a server that
    comes back is sent everything again.

    Args:
        url: the server's ZeroMQ address.
        name: the twin's folder on the page.
        on_page: is given the page's address when the server first answers, in a thread of the viewer's own.
        patience: how long a connected server may stay silent before the log says so (s).

    Raises:
        InputError: the address or the name cannot be used.
    """

    def __init__(self, url: str, name: str, on_page: Callable[[str], None] = lambda _: None, *, patience: float = 5.0):
        check_viewer_address(url)
        check_viewer_name(name)
        self.cost = ViewerCost()
        self._client = MeshcatClient(url, f"{_FOLDER}/{name}", on_page, patience=patience)
        self._scene: SharedScene | None = None

    @property
    def counts(self) -> FrameCounts:
        """What became of the frames so far."""
        return self._client.counts

    def draw(self, twin: Twin) -> None:
        """Shows a twin's present state; it may be another twin than the last time, or have other robots."""
        start = time.perf_counter()
        is_known = self._scene is not None and self._scene.shows(twin)
        if self._scene is None or not is_known:
            self._scene = SharedScene(twin)
        self._client.offer(Frame(self._scene, self._scene.poses(twin)))
        spent, cost = time.perf_counter() - start, self.cost
        slowest = max(cost.slowest, spent) if is_known else cost.slowest
        self.cost = ViewerCost(cost.frames + 1, cost.wall_time + spent, slowest)

    def flush(self, timeout: float, *, wait_for_server: bool = False) -> bool:
        """Waits until the page has the latest state.

        Args:
            timeout: the longest wait (s).
            wait_for_server: whether to wait for a server that is absent, too.

        Returns:
            Whether it has; False at once where there is no server, unless one is waited for.
        """
        return self._client.flush(timeout, wait_for_server=wait_for_server)

    @property
    def is_behind(self) -> bool:
        """Whether there is a server, or may be one, that has not got the latest state."""
        return self._client.is_behind

    def close(self, timeout: float = 1.5) -> None:
        """Sends the latest state and ends; what is on the page stays there.

        Args:
            timeout: the longest wait for a server that is there (s).
        """
        self._client.close(timeout)
