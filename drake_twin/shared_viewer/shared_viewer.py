"""Shows twins on the page of a ``meshcat-server`` with those of other processes, each below a folder of its own.

The page outlives the twins. ``meshcat-server --zmq-url tcp://127.0.0.1:6000`` starts the stock server.
"""

import time
from collections.abc import Callable

from drake_twin.dataclass import dataclass
from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.shared_viewer.meshcat_client import FrameCounts, MeshcatClient
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.shared_viewer.viewer_address import check_viewer_address, check_viewer_name
from drake_twin.twin.twin import Twin

_FOLDER = "/twins"


@dataclass(frozen=True)
class ViewerCost:
    """The cost of the frames in the simulation's thread.

    Attributes:
        frames: The number of frames.
        wall_time: The time of all frames (s), including the reading of the geometry.
        slowest: The time of the slowest frame (s), except those that read the geometry.
    """

    frames: int = 0
    wall_time: float = 0.0
    slowest: float = 0.0


class SharedViewer:
    """A twin's place on a shared page.

    Drawing never waits for the server. Without a server the simulation continues, with one warning in the log; a server
    that restarts is sent everything again.

    Args:
        url: The server's ZeroMQ address.
        name: The twin's folder on the page.
        on_page: Called with the page's address, in a thread of the viewer's own, when the server first answers.
        patience: How long a connected server may stay silent before a warning is logged (s).

    Raises:
        InputError: If the address or the name cannot be used.
    """

    def __init__(self, url: str, name: str, on_page: Callable[[str], None] = lambda _: None, *, patience: float = 5.0):
        check_viewer_address(url)
        check_viewer_name(name)
        self.cost = ViewerCost()
        self._client = MeshcatClient(url, f"{_FOLDER}/{name}", on_page, patience=patience)
        self._scene: SharedScene | None = None

    @property
    def counts(self) -> FrameCounts:
        """The counts of the frames so far."""
        return self._client.counts

    def draw(self, twin: Twin) -> None:
        """Show a twin's present state; it may be another twin than in the last call, or have other robots."""
        start = time.perf_counter()
        is_known = self._scene is not None and self._scene.shows(twin)
        if self._scene is None or not is_known:
            self._scene = SharedScene(twin)
        self._client.offer(Frame(self._scene, self._scene.poses(twin)))
        spent, cost = time.perf_counter() - start, self.cost
        slowest = max(cost.slowest, spent) if is_known else cost.slowest
        self.cost = ViewerCost(cost.frames + 1, cost.wall_time + spent, slowest)

    def flush(self, timeout: float, *, wait_for_server: bool = False) -> bool:
        """Wait until the page has the latest state.

        Args:
            timeout: The longest wait (s).
            wait_for_server: Whether to wait for an absent server, too.

        Returns:
            Whether the page has it. Without a server it is False at once, unless ``wait_for_server`` is set.
        """
        return self._client.flush(timeout, wait_for_server=wait_for_server)

    @property
    def is_behind(self) -> bool:
        """Whether a server, if it is not known to be absent, lacks the latest state."""
        return self._client.is_behind

    def close(self, timeout: float = 1.5) -> None:
        """Send the latest state and end; the page keeps what it shows.

        Args:
            timeout: The longest wait for a connected server (s).
        """
        self._client.close(timeout)
