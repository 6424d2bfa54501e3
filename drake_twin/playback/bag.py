"""A rosbag2 bag, of this package or of others: MCAP or SQLite3."""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from drake_twin.dataclass import dataclass
from drake_twin.description.bag_files import check_bag_files
from drake_twin.errors import InputError
from drake_twin.messages import type_store
from drake_twin.messages.interface_types import deserialize

TRANSFORMS, JOINT_STATES, TEXT = "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState", "std_msgs/msg/String"
_DESCRIPTION = "robot_description"
_FIRST_LOOK = 0.25  # s before a time in which its last message is looked for first
_EPSILON = 1e-9  # s


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag.

    Attributes:
        time: When it was recorded (s since the bag's start).
        topic: Its topic.
        type: Its type.
        read: Returns the message itself; raises an InputError if its bytes are damaged.
    """

    time: float
    topic: str
    type: str
    read: Callable[[], Any]


class Bag:
    """A bag that is open for reading; a context manager that closes it.

    Args:
        folder: The bag's folder.

    Attributes:
        start: The time of its first message (ns).
        duration: The time from the first message to the last one (s).
        topics: Topic → its type and how many messages it has.
        descriptions: Topic → the robot description that it has first.
        changed_descriptions: The topics whose description differs later.

    Raises:
        InputError: If it is not a bag, or is damaged.
    """

    def __init__(self, folder: Path):
        from rosbags.highlevel import AnyReader

        self._folder = _checked(folder)
        with self._readable():
            self._reader = AnyReader([self._folder], default_typestore=type_store())
        self._opened = ExitStack()
        with self._readable():
            self._opened.enter_context(self._reader)
            if not self._reader.message_count:
                raise InputError("the bag holds no messages", file=folder)
            self.start = self._reader.start_time
            self.duration = (self._reader.end_time - 1 - self.start) * 1e-9
            self.topics = {name: (info.msgtype or "", info.msgcount) for name, info in self._reader.topics.items()}
        self.descriptions: dict[str, str] = {}
        self.changed_descriptions: set[str] = set()
        for message in self.messages(lambda topic, kind: kind == TEXT and topic.endswith(f"/{_DESCRIPTION}")):
            text = message.read().data
            if self.descriptions.setdefault(message.topic, text) != text:
                self.changed_descriptions.add(message.topic)

    def messages(
        self, is_wanted: Callable[[str, str], bool], since: float | None = None, until: float | None = None
    ) -> Iterator[BagMessage]:
        """Yield messages in the order of their times.

        Args:
            is_wanted: Is called with a topic's name and type.
            since: The time of the first messages (s since the bag's start); None for the start.
            until: The time of the last messages (s since the bag's start); None for the end.

        Raises:
            InputError: If the bag is damaged.
        """
        wanted = [item for item in self._reader.connections if is_wanted(item.topic, item.msgtype)]
        if not wanted:
            return
        start = None if since is None else self.start + round(since * 1e9)
        stop = None if until is None else self.start + round(until * 1e9) + 1
        messages = self._reader.messages(wanted, start, stop)
        while True:
            with self._readable():
                item = next(messages, None)
            if item is None:
                return
            connection, time, data = item
            read = partial(self._read, data, connection.msgtype)
            yield BagMessage((time - self.start) * 1e-9, connection.topic, connection.msgtype, read)

    def last(self, topic: str, time: float) -> BagMessage | None:
        """Return the last message of a topic that is not after a time (s since the bag's start); None before the first.

        Raises:
            InputError: If the bag is damaged.
        """
        within, end = _FIRST_LOOK, time + _EPSILON
        while True:
            began = end - within
            found = deque(self.messages(lambda name, _: name == topic, began, end), maxlen=1)
            if found or began <= 0:
                return found[0] if found else None
            within *= 8

    def close(self) -> None:
        """Close the bag."""
        self._opened.close()

    def _read(self, data: bytes, kind: str) -> Any:
        with self._readable():
            if kind in self._reader.typestore.fielddefs:
                return self._reader.deserialize(data, kind)
            return deserialize(kind, data)  # the bag has no definitions, and rosbags' store lacks it

    @contextmanager
    def _readable(self) -> Iterator[None]:
        """Turn what reading a damaged file raises, whatever it is, into an error about the bag."""
        try:
            yield
        except InputError:
            raise
        except Exception as error:  # of rosbags, of SQLite, of decompression, or of wrong lengths
            reason = " ".join(str(error).split()) or type(error).__name__
            raise InputError(f"the bag cannot be read: {reason}", file=self._folder) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


def _checked(folder: Path) -> Path:
    """Return the folder of a bag.

    Raises:
        InputError: If it is not the folder of a bag.
    """
    if not folder.exists():
        raise InputError("the bag does not exist", file=folder)
    if folder.suffix == ".bag" and folder.is_file():
        raise InputError("this is a bag of ROS 1: convert it with rosbags-convert", file=folder)
    if folder.is_file() and (folder.parent / "metadata.yaml").exists():
        folder = folder.parent  # a file of the bag
    if not (folder / "metadata.yaml").is_file():
        text = "this is not a rosbag2 bag: it has no metadata.yaml, which its recorder writes at the end"
        raise InputError(f"{text} (`ros2 bag reindex` makes one)", file=folder)
    try:
        check_bag_files(folder)
    except OSError as error:
        raise InputError(f"the bag cannot be read ({error.strerror})", file=folder) from None
    return folder
