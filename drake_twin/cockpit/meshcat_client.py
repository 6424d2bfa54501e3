"""A connection to a ``meshcat-server`` that never makes its caller wait, whatever the server does.

The client of the PyPI package waits for ever for a server that is absent or dead. This one has a thread of its own,
which alone touches the socket. It keeps only the latest frame, sends what changed since the last one, and sends
everything again to a server that comes back.
"""

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from drake_twin.cockpit.meshcat_protocol import ASK_FOR_PAGE, OK, Command, TransformWriter, delete, set_object
from drake_twin.cockpit.shared_scene import SharedScene
from drake_twin.cockpit.three_js import three_js_object

_log = logging.getLogger(__name__)

_MOST_UNANSWERED = 32  # commands on the way at once: waiting for each answer would cost a round trip a body
_MOVED = 1e-6  # m, or of a rotation matrix: what moved less since it was last sent is not sent
_POLL = 20  # ms
_RETRY = 200  # ms between attempts to connect
_LONGEST_RETRY = 1000  # ms
_HEARTBEAT = 1000  # ms: a machine that vanished says no goodbye
_HEARTBEAT_TIMEOUT = 4000  # ms


@dataclass(frozen=True)
class Frame:
    """A moment of a twin.

    Attributes:
        scene: its geometry.
        poses: those of the scene's bodies in the world, (bodies, 4, 4).
    """

    scene: SharedScene
    poses: np.ndarray


@dataclass(frozen=True)
class FrameCounts:
    """What became of the frames.

    Attributes:
        offered: how many the simulation had.
        sent: how many the server was given, as far as they changed.
        transforms: how many poses were sent in all.
    """

    offered: int
    sent: int
    transforms: int

    @property
    def dropped(self) -> int:
        """How many were overtaken by a later one, or had no server to go to."""
        return self.offered - self.sent


class MeshcatClient:
    """Sends frames to a server, from a thread of its own.

    Args:
        url: the server's ZeroMQ address, for example ``tcp://127.0.0.1:6000``.
        folder: the path on the page that holds everything.
        on_page: is given the page's address when a server answers for the first time, in the client's thread.
        patience: how long a connected server may stay silent before that is said (s).
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
        self._end: float | None = None  # when to stop at the latest (s, monotonic)
        self._announced = False
        self._thread = threading.Thread(target=self._work, name="meshcat client", daemon=True)
        self._thread.start()

    @property
    def counts(self) -> FrameCounts:
        """What became of the frames so far."""
        with self._changed:
            return FrameCounts(self._offered, self._sent, self._transforms)

    def offer(self, frame: Frame) -> None:
        """Hands over a frame, in place of one that is not on its way yet; returns at once."""
        with self._changed:
            self._latest = frame
            self._offered += 1
            self._changed.notify_all()

    def flush(self, timeout: float) -> bool:
        """Waits until the server has the latest frame.

        Args:
            timeout: the longest wait (s).

        Returns:
            Whether it has; False at once where there is no server.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._delivered == self._offered or self._absent, timeout)
            return self._delivered == self._offered

    def close(self, timeout: float) -> None:
        """Sends the latest frame if a server takes it, and ends; what is on the page stays.

        Args:
            timeout: the longest wait (s).
        """
        with self._changed:
            self._end = time.monotonic() + timeout
            self._changed.notify_all()
        self._thread.join(timeout + 1.0)

    # --- the thread

    def _work(self) -> None:
        import zmq

        context = zmq.Context()
        try:
            while not self._is_over():
                try:
                    with _Connection(context, self._url) as connection:
                        self._serve(connection)
                except _NoServerError as error:
                    self._say_absent(str(error))
                except zmq.ZMQError as error:
                    self._say_absent(f"{error}")
                    time.sleep(_RETRY / 1000)
        finally:
            context.destroy(linger=0)

    def _is_over(self) -> bool:
        """Whether the thread is to end now: told to, and nothing left to send or nobody to send it to."""
        with self._changed:
            if self._end is None:
                return False
            return self._absent or self._delivered == self._offered or time.monotonic() > self._end

    def _serve(self, connection: "_Connection") -> None:
        """Connects and sends frames until the client is closed.

        Raises:
            _NoServerError: the server is gone.
        """
        while not connection.is_open():
            if connection.has_failed:
                self._say_absent("no meshcat-server answers there")
            if self._is_over():
                return
        page = self._exchange(connection, [ASK_FOR_PAGE])
        if page is None:
            return
        self._say_present(page)
        sender = _FrameSender(self._folder)
        while not self._is_over():
            with self._changed:
                self._changed.wait_for(
                    lambda: self._delivered != self._offered or self._end is not None, timeout=_POLL / 1000
                )
                frame, number = self._latest, self._offered
            connection.look_after()
            if frame is None or (number == self._delivered and sender.has_sent):
                continue
            if self._exchange(connection, sender.commands(frame)) is None:
                return
            with self._changed:
                self._delivered = number
                self._sent += 1
                self._transforms += sender.transforms
                self._changed.notify_all()

    def _exchange(self, connection: "_Connection", commands: Iterable[Command]) -> bytes | None:
        """Sends commands, a few ahead of their answers.

        Returns:
            The last answer; None when the client is closed meanwhile.

        Raises:
            _NoServerError: the server is gone.
        """
        waiting = iter(commands)
        unanswered, at_end, answer = 0, False, b""
        heard, silent = time.monotonic(), False
        while unanswered or not at_end:
            while unanswered < _MOST_UNANSWERED and not at_end:
                command = next(waiting, None)
                at_end = command is None
                if command is not None:
                    connection.send(command)
                    unanswered += 1
                    heard = max(heard, time.monotonic()) if unanswered == 1 else heard
            for answer in connection.answers():
                unanswered -= 1
                heard = time.monotonic()
                silent = False
                if answer.startswith(b"error"):
                    _log.warning("the meshcat-server at %s says: %s", self._url, answer.decode(errors="replace"))
            if unanswered and not silent and time.monotonic() - heard > self._patience:
                silent = True
                _log.warning(
                    "the meshcat-server at %s has not answered for %g s; the simulation goes on", self._url, self._patience
                )
            if self._end is not None and time.monotonic() > self._end:
                return None
        return answer

    def _say_absent(self, reason: str) -> None:
        with self._changed:
            was_absent, self._absent = self._absent, True
            self._changed.notify_all()
        if not was_absent:
            _log.warning(
                "the shared page at %s: %s. The simulation goes on, and is shown once a server is there"
                " (meshcat-server --zmq-url %s)",
                self._url,
                reason,
                self._url,
            )

    def _say_present(self, page: bytes) -> None:
        with self._changed:
            was_absent, self._absent = self._absent, False
            self._delivered = 0 if was_absent else self._delivered
        if not page.startswith(b"http"):
            _log.warning("%s answers, but not as a meshcat-server does", self._url)
            return
        if self._announced:
            _log.warning("the shared page at %s is back, and shows the twin again", self._url)
            return
        self._announced = True
        address = _as_seen_from_here(page.decode(), self._url)
        self._on_page(address)
        port = urlsplit(address).port
        _log.warning(
            "meshcat-server serves its page%s on every interface of its machine, to whoever reaches it:"
            " let a firewall close that port where others share the network",
            "" if port is None else f" (port {port})",
        )


class _FrameSender:
    """Knows what the server has, and makes the commands that are missing.

    Args:
        folder: the path that holds everything.
    """

    def __init__(self, folder: str):
        self._folder = folder
        self._scene: SharedScene | None = None
        self._writer = TransformWriter(())
        self._poses = np.empty((0, 4, 4))
        self.transforms = 0

    @property
    def has_sent(self) -> bool:
        """Whether the server has been given a frame."""
        return self._scene is not None

    def commands(self, frame: Frame) -> Iterator[Command]:
        """The commands that take the page from the last frame to this one."""
        self.transforms = 0
        if frame.scene is not self._scene:
            yield from self._whole_scene(frame.scene)
            moved = np.arange(len(frame.poses))
            self._poses = frame.poses.copy()
        else:
            moved = np.flatnonzero(np.abs(frame.poses - self._poses).max(axis=(1, 2), initial=0.0) > _MOVED)
            self._poses[moved] = frame.poses[moved]
        self.transforms = len(moved)
        yield from self._writer.commands(frame.poses, moved.tolist())

    def _whole_scene(self, scene: SharedScene) -> Iterator[Command]:
        yield delete(self._folder)
        for geometry in scene.geometries:
            try:
                three_js = three_js_object(geometry)
            except ValueError as error:
                _log.warning("the shared page does not show %s: %s", geometry.path, error)
                continue
            yield set_object(f"{self._folder}/{geometry.path}", three_js)
        self._scene = scene
        self._writer = TransformWriter([f"{self._folder}/{body}" for body in scene.bodies])


class _NoServerError(Exception):
    """The connection broke."""


class _Connection:
    """A socket that sends ahead of the answers, with a watch on the connection below it.

    Args:
        context: the ``zmq.Context``.
        url: the server's address.
    """

    def __init__(self, context: Any, url: str):
        import zmq

        self._zmq = zmq
        self._socket = context.socket(zmq.DEALER)
        self._socket.linger = 0
        self._socket.reconnect_ivl = _RETRY
        self._socket.reconnect_ivl_max = _LONGEST_RETRY
        self._socket.heartbeat_ivl = _HEARTBEAT
        self._socket.heartbeat_timeout = _HEARTBEAT_TIMEOUT
        self._monitor = self._socket.get_monitor_socket()
        self._socket.connect(url)
        self._is_open = False
        self.has_failed = False

    def __enter__(self) -> "_Connection":
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(self._zmq.ZMQError):
            self._socket.disable_monitor()
        self._socket.close(linger=0)

    def is_open(self) -> bool:
        """Waits a moment; whether a server has shaken hands."""
        self.look_after(_POLL)
        return self._is_open

    def look_after(self, timeout: int = 0) -> None:
        """Takes note of what happened to the connection, for at most ``timeout`` ms.

        Raises:
            _NoServerError: an open connection broke.
        """
        from zmq.utils.monitor import recv_monitor_message

        events = self._zmq.Event
        while self._monitor.poll(timeout):
            event = recv_monitor_message(self._monitor)["event"]
            if event == events.HANDSHAKE_SUCCEEDED:
                self._is_open = True
                return
            if event == events.DISCONNECTED and self._is_open:
                raise _NoServerError("the meshcat-server is gone")
            self.has_failed |= event in (events.CONNECT_RETRIED, events.DISCONNECTED)
            timeout = 0

    def send(self, command: Command) -> None:
        """Sends without waiting; there are never enough messages on the way to fill the queue."""
        self._socket.send_multipart((b"", *command), flags=self._zmq.NOBLOCK)

    def answers(self) -> Iterator[bytes]:
        """Waits a moment for answers, and yields those that are there.

        Raises:
            _NoServerError: the connection broke.
        """
        if self._socket.poll(_POLL):
            with contextlib.suppress(self._zmq.Again):
                while True:
                    yield self._socket.recv_multipart(flags=self._zmq.NOBLOCK)[-1]
        else:
            self.look_after()


def _as_seen_from_here(page: str, url: str) -> str:
    """The page's address, with the server's machine in place of what that machine calls itself."""
    host = urlsplit(url).hostname
    if host in (None, "127.0.0.1", "localhost"):
        return page
    parts = urlsplit(page)
    return parts._replace(netloc=f"{host}:{parts.port}").geturl()
