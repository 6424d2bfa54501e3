"""A rosbag2 bag as a wire: every topic is heard, and nothing comes in."""

import contextlib
import json
import logging
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

from drake_twin.errors import InputError, RunError
from drake_twin.python_process import python_command, stops_held_back
from drake_twin.wires.bag_writer import HEAD, MESSAGE, TOPIC
from drake_twin.wires.wire import Closable, Reply, WireEndpoint

_log = logging.getLogger(__name__)

# They are large, and each says again what other topics say.
_LEFT_OUT = ("gazebo_msgs/msg/ModelStates", "gazebo_msgs/msg/LinkStates")
_PICTURES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")


class BagWire:
    """Write topics into a bag (MCAP, zstd), in a process of its own.

    Args:
        folder: The bag's folder, which must not exist.
        topics: The topics; without any, all but pictures, model states, link states and those of actions.

    Raises:
        InputError: If the folder exists, or its parent does not.
    """

    def __init__(self, folder: Path, topics: Sequence[str] = ()):
        if folder.exists():
            raise InputError("the folder exists: a bag is written into a new one", file=folder)
        if not folder.resolve().parent.is_dir():
            raise InputError(f"the folder {folder.resolve().parent} does not exist", file=folder)
        try:
            folder.mkdir()
            folder.rmdir()
        except OSError as error:
            raise InputError(f"the folder cannot be created ({error.strerror})", file=folder) from None
        self._folder = folder
        self._failure: RunError | None = None
        self._topics = frozenset(topics)
        self._numbers: dict[bytes, int] = {}  # of descriptions: what is spawned again has the topics it had
        command = [*python_command("drake_twin.wires.bag_writer"), str(folder)]
        with stops_held_back():
            self._process: subprocess.Popen[bytes] | None = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE
            )

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> "_BagSender":
        """Write a topic, if it is one of those that were asked for."""
        is_hidden = "/_" in topic.name or topic.type in (*_LEFT_OUT, *_PICTURES)
        is_wanted = topic.name in self._topics if self._topics else not is_hidden
        return _BagSender(self, self._number(topic) if is_wanted else 0, is_wanted)

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear nothing."""
        return _End()

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Serve nothing."""
        return _End()

    def close(self) -> None:
        """Finish the bag.

        Raises:
            RunError: If messages are missing in it, with what is there.
        """
        process, self._process = self._process, None
        if process is not None:
            self._finish(process)
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    def write(self, kind: bytes, number: int, time: int, content: bytes) -> None:
        """Write a record; the first that fails ends the bag."""
        process = self._process
        if process is None:
            return
        try:
            assert process.stdin is not None
            process.stdin.write(HEAD.pack(kind, number, time, len(content)) + content)
            process.stdin.flush()  # a buffer would be lost if this process were killed
        except OSError:
            self._process = None
            self._finish(process)
            _log.warning("%s (the run continues, and nothing more is written into the bag)", self._failure)

    def _number(self, topic: WireEndpoint) -> int:
        """Return a topic's number, told once: a bag has each topic of one quality once."""
        quality = {
            "latched": topic.latched,
            "depth": 0 if topic.keeps_all else topic.kept,
            "is_best_effort": topic.is_best_effort,
            "lifespan": topic.lifespan,
            "deadline": topic.deadline,
            "is_manual": topic.is_manual,
            "lease": topic.lease,
        }
        described = {"name": topic.name, "type": topic.type, "hash": topic.hash, "definition": topic.definition}
        content = json.dumps({**described, "quality": quality}).encode()
        if content not in self._numbers:
            self._numbers[content] = len(self._numbers)
            self.write(TOPIC, self._numbers[content], 0, content)
        return self._numbers[content]

    def _finish(self, process: "subprocess.Popen[bytes]") -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        said = process.stdout.read().decode(errors="replace").strip()
        process.stdout.close()
        if code := process.wait():
            said = said or f"its process was killed by signal {-code}" if code < 0 else said
            self._failure = RunError(f"the bag {self._folder} is not complete: {said or 'its process failed'}")


class _End:
    def close(self) -> None:
        pass


class _BagSender:
    """Writes a topic.

    Attributes:
        is_heard: Whether the topic is written.
        keeps: Whether it keeps what it is sent, and needs nothing a second time.
    """

    keeps = True

    def __init__(self, bag: BagWire, number: int, is_wanted: bool):
        self.is_heard = is_wanted
        self._bag, self._number = bag, number

    def send(self, data: bytes, time: int) -> None:
        self._bag.write(MESSAGE, self._number, time, data)

    def close(self) -> None:
        self.is_heard = False
