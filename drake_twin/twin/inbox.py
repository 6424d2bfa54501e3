"""What other threads ask of a twin: it waits here until the simulation's thread does it."""

from collections import deque
from collections.abc import Callable
from threading import Event, Lock
from typing import TYPE_CHECKING, Any, TypeVar

from drake_twin.dataclass import dataclass
from drake_twin.errors import RunError
from drake_twin.twin.owner import Owned, Owner, any_thread

if TYPE_CHECKING:
    from concurrent.futures import Future

_T = TypeVar("_T")

MOST = 1000  # requests that wait
MOST_BYTES = 256 << 20  # of their messages
PERIOD = 0.005  # s of simulation time between two looks; each millisecond would cost half as much as the physics
QUIET = 200  # looks that found nothing, after which one in `SELDOM` is enough: twenty times a second
SELDOM = 10


@dataclass(frozen=True)
class _Request:
    act: Callable[[], None]
    topic: str | None
    must_stay: bool
    between_advances: bool
    size: int


class Inbox(Owned, path="twin.inbox"):
    """Requests of other threads, done in the order of their arrival.

    Each is done in the thread that advances the twin: at a step boundary, or, for what a callback cannot do, between
    two advances. While nobody uses the inbox, nobody looks into it.

    Args:
        owner: The thread that the twin belongs to.

    Attributes:
        is_open: Whether anybody uses the inbox.
        is_urgent: Whether anybody uses it who needs an answer within a part of a frame.
        looks: Functions to call between two advances, before the requests.
    """

    def __init__(self, owner: Owner) -> None:
        self._owner = owner
        self._asked: set[Future[Any]] = set()
        self._has_ended = False
        self.looks: list[Callable[[], None]] = []
        self._users = self._urgent_users = 0
        self.is_open = self.is_urgent = False
        self._waiting: deque[_Request] = deque()
        self._bytes = 0
        self._quiet_looks = 0
        self._lock = Lock()
        self._arrived = Event()

    @property
    @any_thread
    def is_waiting(self) -> bool:
        """Whether a request waits."""
        return bool(self._waiting)

    @property
    def period(self) -> float:
        """The simulation time (s) until the next look: it is longer where nobody has asked for anything for long."""
        return PERIOD if self._quiet_looks < QUIET else SELDOM * PERIOD

    def has_request(self) -> bool:
        """Look whether a request waits; looks that find none are counted until one comes."""
        self._quiet_looks += 1
        return bool(self._waiting)

    @any_thread
    def open(self, *, urgent: bool = True) -> None:
        """Use the inbox until `close`.

        Args:
            urgent: Whether a run in real time advances in parts of a frame, of 5 ms, for these requests; a person's may
                wait for the next frame.
        """
        self._count(1, urgent)

    @any_thread
    def close(self, *, urgent: bool = True) -> None:
        """End what `open` began, with the same argument."""
        self._count(-1, urgent)

    def _count(self, more: int, urgent: bool) -> None:
        with self._lock:
            self._users += more
            self._urgent_users += more if urgent else 0
            self.is_open, self.is_urgent = self._users > 0, self._urgent_users > 0

    @any_thread
    def ask(self, function: Callable[[], _T], *, between_advances: bool = False) -> "Future[_T]":
        """Have the twin's own thread call a function, from any thread; in the own thread, call it at once.

        It is called at the next step boundary of an advance, where it may do what a callback may: read the twin,
        publish, pause, push; and in each frame of `Twin.run`, also while paused.

        Args:
            function: For example ``lambda: twin.robot_state("robot_1")``.
            between_advances: Whether it does what a callback cannot, such as `Entities.spawn` or `Twin.reset`: it is
                called at the next frame of `Twin.run`, or when `Twin.advance_to` is called next.

        Returns:
            ``ask(…).result(timeout)`` waits for what the function returns, and raises what it raises.

        Raises:
            RunError: If `MOST` requests wait already, or the twin is closed.
        """
        from concurrent.futures import Future  # an import that start-up spares

        future: Future[_T] = Future()
        is_here = self._owner.is_here

        def act() -> None:
            if future not in self._asked:
                return
            self._asked.remove(future)
            if not is_here:
                self.close()
            if not future.set_running_or_notify_cancel():
                return
            try:
                result = function()
            except Exception as error:
                future.set_exception(error)
            else:
                future.set_result(result)

        if self._has_ended:
            raise RunError("the twin is closed")
        self._asked.add(future)
        if is_here:
            act()
            return future
        self.open()
        if not self.put(act, between_advances=between_advances):
            self._asked.remove(future)
            self.close()
            raise RunError(f"{MOST} requests wait in the twin's inbox already: it does them only while it advances")
        if self._has_ended:  # meanwhile
            self.end()
        return future

    def end(self) -> None:
        """Refuse what was asked and is not answered, for the twin is closed."""
        self._has_ended = True
        while self._asked:
            future = self._asked.pop()
            if future.set_running_or_notify_cancel():
                future.set_exception(RunError("the twin is closed"))

    @any_thread
    def put(
        self,
        act: Callable[[], None],
        topic: str | None = None,
        *,
        must_stay: bool = False,
        between_advances: bool = False,
        is_urgent: bool = True,
        size: int = 0,
    ) -> bool:
        """Put a request into the inbox, from any thread.

        With `MOST` requests or messages of `MOST_BYTES` waiting, the oldest one of the same topic is dropped, but never
        one that must stay, and never the newest of a topic.

        Args:
            act: Does it, in the simulation's thread; it must not raise.
            topic: The topic of a command; None if it is not a command.
            must_stay: Whether a later command does not make up for it, as for a stop.
            between_advances: Whether it does what a callback cannot do, such as a spawn.
            is_urgent: Whether it ends a `wait`.
            size: The bytes of a command's message.

        Returns:
            False if something was dropped: an older request, or, of no topic, this one.
        """
        request = _Request(act, topic, must_stay, between_advances, size)
        self._quiet_looks = 0
        with self._lock:
            is_full = len(self._waiting) >= MOST or (size > 0 and self._bytes > MOST_BYTES)
            if is_full and topic is None:
                return False
            self._waiting.append(request)
            self._bytes += size
            if is_full and topic is not None:
                self._drop_one(topic)
        if is_urgent:
            self._arrived.set()
        return not is_full

    def wait(self, timeout: float) -> None:
        """Wait for a request that has not been waited for, at most for some wall time (s)."""
        self._arrived.wait(timeout)
        self._arrived.clear()

    def look(self) -> None:
        """Do what may be done at a step boundary."""
        self._do(lambda item: not item.between_advances)

    def work(self) -> None:
        """Do all pending requests, between two advances."""
        for call in tuple(self.looks):
            call()
        self._do(lambda item: True)

    def _do(self, may_be_done: Callable[[_Request], bool]) -> None:
        """Do the pending requests, up to the first request that may not be done yet: the order of arrival stays."""
        for _ in range(len(self._waiting)):
            with self._lock:
                if not self._waiting or not may_be_done(self._waiting[0]):
                    return
                request = self._waiting.popleft()
                self._bytes -= request.size
            request.act()

    def _drop_one(self, topic: str) -> None:
        newest: set[str] = set()
        of_topic: list[int] = []
        of_others: list[int] = []
        for index in reversed(range(len(self._waiting))):
            item = self._waiting[index]
            if item.topic is None:
                continue
            if item.topic in newest and not item.must_stay:
                (of_topic if item.topic == topic else of_others).append(index)
            newest.add(item.topic)
        droppable = of_topic or of_others
        if not droppable:  # all that wait must stay: the oldest of the topic says the same as a newer one
            droppable = [index for index, item in enumerate(self._waiting) if item.topic == topic][:1]
        dropped = min(droppable)
        self._bytes -= self._waiting[dropped].size
        del self._waiting[dropped]
