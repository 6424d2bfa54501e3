"""A client of a ``meshcat-server`` that never blocks its caller, whatever the server does.

The client of the PyPI package blocks forever if the server is absent or dead. This one has a thread of its own, which
alone uses the socket. It keeps only the latest frame, sends what changed since the last one, and sends everything again
to a server that has restarted.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterable
from urllib.parse import urlsplit

from drake_twin.dataclass import dataclass
from drake_twin.shared_viewer.frame_sender import Frame, FrameSender
from drake_twin.shared_viewer.meshcat_connection import POLL, RETRY, MeshcatConnection, NoServerError
from drake_twin.shared_viewer.meshcat_protocol import ASK_FOR_PAGE, Command

_log = logging.getLogger(__name__)

_MOST_UNANSWERED = 32  # commands at once: one at a time would cost a round trip for each body


@dataclass(frozen=True)
class FrameCounts:
    """Counts of frames.

    Attributes:
        offered: The number of frames that the simulation has offered.
        sent: The number of frames that were sent, as far as they changed.
        transforms: The number of poses that were sent in all frames.
    """

    offered: int
    sent: int
    transforms: int

    @property
    def dropped(self) -> int:
        """The number of frames that a later one replaced, or that no server could receive."""
        return self.offered - self.sent


class MeshcatClient:
    """Sends frames to a server, from a thread of its own.

    Args:
        url: The server's ZeroMQ address, for example ``tcp://127.0.0.1:6000``.
        folder: The path on the page below which everything is drawn.
        on_page: Called with the page's address, in the client's thread, when a server answers for the first time.
        patience: How long a connected server may stay silent before a warning is logged (s).
    """

    def __init__(self, url: str, folder: str, on_page: Callable[[str], None], *, patience: float = 5.0):
        self._url = url
        self._folder = folder
        self._on_page = on_page
        self._patience = patience
        self._changed = threading.Condition()
        self._latest: Frame | None = None
        self._offered = self._sent = self._transforms = 0
        self._delivered = 0  # the number of the frame that the server has
        self._absent = False
        self._end: float | None = None  # the latest time to stop at (s, monotonic)
        self._announced = False
        self._thread = threading.Thread(target=self._work, name="meshcat client", daemon=True)
        self._thread.start()

    @property
    def counts(self) -> FrameCounts:
        """The counts of the frames so far."""
        with self._changed:
            return FrameCounts(self._offered, self._sent, self._transforms)

    def offer(self, frame: Frame) -> None:
        """Replace the pending frame; return at once."""
        with self._changed:
            self._latest = frame
            self._offered += 1
            self._changed.notify_all()

    def flush(self, timeout: float, *, wait_for_server: bool = False) -> bool:
        """Wait until the server has the latest frame.

        Args:
            timeout: The longest wait (s).
            wait_for_server: Whether to wait for an absent server, too.

        Returns:
            Whether the server has it.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._has_latest or (self._absent and not wait_for_server), timeout)
            return self._has_latest

    @property
    def is_behind(self) -> bool:
        """Whether a server, if it is not known to be absent, lacks the latest frame."""
        with self._changed:
            return not self._absent and not self._has_latest

    @property
    def _has_latest(self) -> bool:
        return not self._absent and self._delivered == self._offered

    def close(self, timeout: float) -> None:
        """Send the latest frame if a server receives it, and end; the page keeps what it shows.

        Args:
            timeout: The longest wait (s).
        """
        with self._changed:
            self._end = time.monotonic() + timeout
            self._changed.notify_all()
        self._thread.join(timeout + 0.5)

    # --- in the client's thread

    def _work(self) -> None:
        import zmq

        context = zmq.Context()
        try:
            while not self._is_over():
                try:
                    with MeshcatConnection(context, self._url) as connection:
                        self._serve(connection)
                except (NoServerError, zmq.ZMQError) as error:
                    self._note_absent(str(error))
                    with self._changed:
                        self._changed.wait_for(lambda: self._end is not None, timeout=RETRY / 1000)
        finally:
            context.destroy(linger=0)

    def _is_over(self) -> bool:
        """Return whether the thread must end now: `close` was called, and the latest frame is sent or cannot be."""
        with self._changed:
            if self._end is None:
                return False
            return self._absent or self._has_latest or time.monotonic() > self._end

    def _serve(self, connection: MeshcatConnection) -> None:
        """Connect and send frames until the client is closed.

        Raises:
            NoServerError: If the server is gone.
        """
        start = time.monotonic()
        while not connection.is_open():
            if connection.has_failed or time.monotonic() - start > self._patience:
                self._note_absent("no meshcat-server answers there")
            if self._is_over():
                return
        page = self._exchange(connection, [ASK_FOR_PAGE])
        if page is None:
            return
        if not page.startswith(b"http"):
            raise NoServerError("another program answers there, not a meshcat-server")
        self._note_present(page.decode(errors="replace"))
        sender = FrameSender(self._folder)
        while not self._is_over():
            with self._changed:
                self._changed.wait_for(
                    lambda: self._delivered != self._offered or self._end is not None, timeout=POLL / 1000
                )
                frame, number = self._latest, self._offered
            connection.check()
            if frame is None or (number == self._delivered and sender.has_sent):
                continue
            if self._exchange(connection, sender.commands(frame)) is None:
                return
            with self._changed:
                self._delivered = number
                self._sent += 1
                self._transforms += sender.transforms
                self._changed.notify_all()

    def _exchange(self, connection: MeshcatConnection, commands: Iterable[Command]) -> bytes | None:
        """Send commands, a few ahead of their answers.

        Returns:
            The last answer; None if the client is closed meanwhile.

        Raises:
            NoServerError: If the server is gone.
        """
        pending = iter(commands)
        unanswered, at_end, answer = 0, False, b""
        heard: float | None = time.monotonic()
        while unanswered or not at_end:
            while unanswered < _MOST_UNANSWERED and not at_end:
                command = next(pending, None)
                at_end = command is None
                if command is not None:
                    connection.send(command)
                    unanswered += 1
            if not unanswered:
                break
            for answer in connection.answers():
                unanswered -= 1
                heard = time.monotonic()
                if answer.startswith(b"error"):
                    _log.warning("the meshcat-server at %s reports: %s", self._url, answer.decode(errors="replace"))
            if unanswered and heard is not None and time.monotonic() - heard > self._patience:
                heard = None  # warn once
                _log.warning(
                    "the meshcat-server at %s has not answered for %g s; the simulation continues",
                    self._url,
                    self._patience,
                )
            if self._end is not None and time.monotonic() > self._end:
                return None
        return answer

    def _note_absent(self, reason: str) -> None:
        with self._changed:
            was_absent, self._absent = self._absent, True
            self._changed.notify_all()
        if not was_absent:
            _log.warning(
                "the shared page at %s: %s. The simulation continues, and is shown once a server runs there"
                " (meshcat-server --zmq-url %s)",
                self._url,
                reason,
                self._url,
            )

    def _note_present(self, page: str) -> None:
        with self._changed:
            was_absent, self._absent = self._absent, False
            self._delivered = 0 if was_absent else self._delivered
        if self._announced:
            _log.warning("the shared page at %s is back and shows the twin again", self._url)
            return
        self._announced = True
        address = _as_seen_from_here(page, self._url)
        self._on_page(address)
        port = urlsplit(address).port
        _log.warning(
            "meshcat-server serves its page%s on every interface of its machine, without access control:"
            " close that port by a firewall where others share the network",
            "" if port is None else f" (port {port})",
        )


def _as_seen_from_here(page: str, url: str) -> str:
    """Return the page's address with the host of the server's address, which may call itself otherwise."""
    host = urlsplit(url).hostname
    if host in (None, "127.0.0.1", "localhost"):
        return page
    parts = urlsplit(page)
    return parts._replace(netloc=f"{host}:{parts.port}").geturl()
