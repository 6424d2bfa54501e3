"""The thread that serializes each message once and gives the same bytes to all wires, and responses in their turn."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import field
from queue import Empty, SimpleQueue
from threading import Event, Thread

from drake_twin.dataclass import dataclass
from drake_twin.messages.draft import Draft
from drake_twin.twin.endpoints import Endpoint
from drake_twin.wires.wire import Sender

_MOMENT = 1e-3  # s of wall time in which messages come that are sent with others
_MOST_WAITING = 10_000  # messages; more make the simulation wait


@dataclass
class OfferedTopic:
    """A topic that is offered.

    Attributes:
        endpoint: The topic.
        senders: Its sender on each wire.
        end: Ends the subscription; None while nobody listens.
        is_of_twin: Whether it can be subscribed to.
    """

    endpoint: Endpoint
    senders: list[Sender] = field(default_factory=list)
    end: Callable[[], None] | None = None
    is_of_twin: bool = True

    @property
    def is_heard(self) -> bool:
        """Whether anybody listens."""
        return any(sender.is_heard for sender in self.senders)


_Message = tuple[OfferedTopic, Draft, float, bool]


class Outbox:
    """Messages on their way to the wires, until it is closed.

    Args:
        log: Is called with a topic and why a message of it is not sent.
    """

    def __init__(self, log: Callable[[str, str], None]):
        self._log = log
        self._queue: SimpleQueue[_Message | Callable[[], object] | None] = SimpleQueue()
        self._has_room = Event()
        self._thread = Thread(target=self._send, name="drake_twin sender", daemon=True)
        self._thread.start()

    def put(self, topic: OfferedTopic, draft: Draft, time: float, *, is_repeated: bool = False) -> None:
        """Send a message of a simulation time (s) later; one that is repeated is not for wires that keep all."""
        while self._queue.qsize() > _MOST_WAITING:  # the simulation waits
            self._has_room.clear()
            self._has_room.wait(0.1)
        self._queue.put((topic, draft, time, is_repeated))

    def then(self, act: Callable[[], object]) -> None:
        """Do something once the messages before it are sent."""
        self._queue.put(act)

    def flush(self) -> None:
        """Wait until the pending messages are sent, as they are once it is closed."""
        if self._thread.is_alive():
            sent = Event()
            self.then(sent.set)
            sent.wait()

    def close(self) -> None:
        """Send the pending messages, and end the thread."""
        self._queue.put(None)
        self._thread.join()

    def _send(self) -> None:
        flushes: set[Callable[[], None]] = set()  # of wires that send many messages at once
        while (item := self._next(flushes)) is not None:
            if callable(item):
                _flush(flushes)
                try:
                    item()
                except Exception as error:  # of a wire that ends meanwhile
                    self._log("services", f"a response is not sent: {error}")
                continue
            topic, draft, time, is_repeated = item
            try:
                if (data := draft.serialized()) is None:
                    continue
                for sender in topic.senders:
                    if sender.is_heard and not (is_repeated and getattr(sender, "keeps", False)):
                        sender.send(data, round(time * 1e9))
                        if (flush := getattr(sender, "flush", None)) is not None:
                            flushes.add(flush)
            except Exception as error:  # of a wire that ends, or of a topic that is taken off meanwhile
                self._log(topic.endpoint.name, f"a message is not sent: {error}")
            finally:
                self._has_room.set()

    def _next(self, flushes: set[Callable[[], None]]) -> _Message | Callable[[], object] | None:
        """Return the next message; if none comes for a moment, the pending ones are sent."""
        with suppress(Empty):
            return self._queue.get(timeout=_MOMENT if flushes else None)
        _flush(flushes)
        return self._queue.get()


def _flush(flushes: set[Callable[[], None]]) -> None:
    for flush in flushes:
        flush()
    flushes.clear()
