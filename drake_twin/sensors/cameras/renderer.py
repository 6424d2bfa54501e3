"""The side of a twin of the process that draws."""

import logging
import mmap
import os
import signal
import subprocess
import weakref
from collections import defaultdict
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import ClassVar

import numpy as np

from drake_twin.findings import Finding, Kind
from drake_twin.python_process import python_command, stops_held_back
from drake_twin.sensors.cameras.picture import COLOR, DEPTH, NO_OPENGL, NO_SCENE, View
from drake_twin.sensors.cameras.scene import SeenScene

_log = logging.getLogger(__name__)
_ADVICE = "cameras need Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"
_PAGE = mmap.ALLOCATIONGRANULARITY
_TYPES = {COLOR: np.uint8, DEPTH: np.float32}


class Picture:
    """A picture that is asked for.

    Attributes:
        view: What was asked for.
        camera: Who has asked.
        is_done: Whether it is here, or never will be.
        data: The picture, (height, width) or (height, width, 3); None before, and if it could not be drawn.
    """

    def __init__(self, view: View, camera: str, begin: int, length: int, renderer: "Renderer"):
        self.view, self.camera, self.begin, self.length = view, camera, begin, length
        self.is_done = False
        self.data: np.ndarray | None = None
        self._renderer = renderer

    def wait(self) -> np.ndarray | None:
        """Return the picture once it is here; None if it could not be drawn."""
        while not self.is_done:
            self._renderer.receive()
        return self.data


class Renderer:
    """Draws pictures in a process of its own, which starts with the first picture and ends with this object.

    Poses and pictures are in a file without a name in memory, which is gone with the last process that has it open.

    Attributes:
        problem: Why there are no pictures any more; empty while there are.
        stopped: Camera → why it alone has no pictures any more.
        asked: The number of pictures asked for.
        process: The process; None before the first picture.
    """

    command: ClassVar[tuple[str, ...]] = python_command("drake_twin.sensors.cameras.render_process")

    def __init__(self) -> None:
        self.problem = ""
        self.stopped: dict[str, str] = {}
        self.asked = 0
        self.process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        self._file = -1
        self._memory: mmap.mmap | None = None
        self._size = 0
        self._free: dict[int, list[int]] = defaultdict(list)
        self._scene: SeenScene | None = None
        self._pending: dict[int, Picture] = {}
        self._has_drawn = False

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Why there are no pictures any more, of all cameras or of some."""
        problems = (*((self.problem,) if self.problem else ()), *self.stopped.values())
        return tuple(Finding(Kind.FAILED, problem) for problem in problems)

    def ask(self, camera: str, scene: SeenScene, view: View, poses: np.ndarray) -> Picture:
        """Ask for a picture.

        Args:
            camera: Who asks.
            scene: What there is to see; it is handed over if it has changed.
            view: The picture.
            poses: The poses of the scene's bodies and, last, of the camera's optical frame, (bodies + 1, 3, 4).
        """
        self.asked += 1
        if self.process is None and not self.problem:
            self._start()
        if self._connection is None or camera in self.stopped:
            return self._never(view, camera)
        try:
            while self._connection is not None and self._connection.poll():
                self.receive()
            if self._connection is None or camera in self.stopped:
                return self._never(view, camera)
            if scene != self._scene:
                self._connection.send(("scene", scene))
                self._scene = scene
            picture = self._place(view, camera, poses)
            self._pending[self.asked] = picture
            self._connection.send(("draw", self.asked, view, len(poses), picture.begin, self._size))
        except (BrokenPipeError, ConnectionResetError):
            self._fail()
            return self._never(view, camera)
        return picture

    def receive(self) -> None:
        """Take the next answer, and wait for it."""
        assert self._connection is not None, "nothing is asked for"
        try:
            number, problem = self._connection.recv()
        except (EOFError, ConnectionResetError):
            self._fail()
            return
        if number in (NO_OPENGL, NO_SCENE):
            self._fail(problem, needs_mesa=number == NO_OPENGL)
            return
        picture = self._pending.pop(number)
        picture.is_done = True
        self._free[picture.length].append(picture.begin)
        if problem:
            self._stop(picture.camera, problem)
            return
        assert self._memory is not None
        self._has_drawn = True
        view = picture.view
        values = np.frombuffer(
            self._memory[picture.begin : picture.begin + view.size], _TYPES.get(view.kind, np.uint16)
        )
        picture.data = values.reshape(view.height, view.width, *((3,) if view.kind == COLOR else ()))

    def close(self) -> None:
        """End the process; pictures that are still asked for never come."""
        self._drop_pending()
        if self.process is not None:
            self._end()
            self.process = self._connection = self._memory = self._scene = None
            self._size = 0
            self._free.clear()

    def _start(self) -> None:
        ours, theirs = Pipe()
        self._file = os.memfd_create("drake_twin_pictures")
        numbers = (theirs.fileno(), self._file)
        with stops_held_back():
            self.process = subprocess.Popen(
                [*self.command, *map(str, numbers)],
                pass_fds=numbers,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        theirs.close()
        self._connection = ours
        self._end = weakref.finalize(self, _end, self.process, ours, self._file)

    def _place(self, view: View, camera: str, poses: np.ndarray) -> Picture:
        """Return a picture with a place in the memory, at which the poses are."""
        length = -(-max(view.size, poses.nbytes) // _PAGE) * _PAGE
        if not self._free[length]:
            self._free[length].append(self._size)
            self._size += length
            os.ftruncate(self._file, self._size)
            self._memory = mmap.mmap(self._file, self._size)
        begin = self._free[length].pop()
        assert self._memory is not None
        self._memory[begin : begin + poses.nbytes] = np.ascontiguousarray(poses, dtype=float).tobytes()
        return Picture(view, camera, begin, length, self)

    def _never(self, view: View, camera: str) -> Picture:
        picture = Picture(view, camera, 0, 0, self)
        picture.is_done = True
        return picture

    def _drop_pending(self) -> None:
        for picture in self._pending.values():
            picture.is_done = True
        self._pending.clear()

    def _stop(self, camera: str, reason: str) -> None:
        """Note that a camera's pictures cannot be drawn, once."""
        if camera not in self.stopped:
            what = f"camera {camera} has stopped: {reason.rstrip('.')}. The simulation continues without its pictures"
            self.stopped[camera] = what
            _log.warning("%s", what)

    def _fail(self, reason: str = "", *, needs_mesa: bool = False) -> None:
        """Note that the process has ended, once."""
        process = self.process
        assert process is not None
        code = 0 if reason else process.wait()
        self.close()
        if not reason:
            how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
            reason = f"the process that draws their pictures {how}"
            needs_mesa = not self._has_drawn
        advice = f"; {_ADVICE}" if needs_mesa else ""
        reason = reason.rstrip(".") + advice
        self.problem = f"cameras have stopped: {reason}. The simulation continues without their pictures"
        _log.warning("%s", self.problem)


def _end(process: "subprocess.Popen[bytes]", connection: Connection, file: int) -> None:
    connection.close()
    os.close(file)
    process.kill()  # it has nothing to finish
    process.wait()
