"""Stand-in for ``message_filters``: messages of several topics with the same time, or about the same."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

from drake_twin.nodes.rclpy.clock import ROSClock
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.logging import get_logger
from drake_twin.nodes.rclpy.time import Time

__all__ = ["ApproximateTimeSynchronizer", "Cache", "SimpleFilter", "Subscriber", "TimeSynchronizer"]


class SimpleFilter:
    """Hands messages on to callbacks."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Add a callback, which gets the messages and then these arguments; return its number."""
        number = len(self.callbacks)
        self.callbacks[number] = cb, args
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Call the callbacks."""
        for callback, arguments in tuple(self.callbacks.values()):
            callback(*msg, *arguments)


class Subscriber(SimpleFilter):
    """A subscription: its arguments are the node, and those of ``create_subscription`` without the callback."""

    def __init__(self, *args: Any, **kwargs: Any):
        super().__init__()
        self.node, _, self.topic = args[:3]
        kwargs.setdefault("qos_profile", 10)
        self.sub = self.node.create_subscription(*args[1:], self.callback, **kwargs)

    def callback(self, msg: Any) -> None:
        """Take a message."""
        self.signalMessage(msg)

    def getTopic(self) -> Any:
        """Return the topic."""
        return self.topic

    def __getattr__(self, key: str) -> Any:
        if key == "sub":  # it failed to subscribe
            raise AttributeError(key)
        return getattr(self.sub, key)


class Cache(SimpleFilter):
    """Keeps the last messages.

    Args:
        f: The filter that they come from.
        cache_size: How many it keeps.
        allow_headerless: Whether those without a header are taken, with the present time.
    """

    def __init__(self, f: Any, cache_size: int = 1, allow_headerless: bool = False):
        super().__init__()
        self.cache_size, self.allow_headerless = cache_size, allow_headerless
        self.cache_msgs: list[Any] = []
        self.cache_times: list[Time] = []
        self.connectInput(f)

    def connectInput(self, f: Any) -> None:
        """Take the messages of another filter, too."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Take a message."""
        stamp = _stamp(msg, "message_filters_cache", self.allow_headerless)
        if stamp is None:
            return
        self.cache_times.append(stamp)
        self.cache_msgs.append(msg)
        if len(self.cache_msgs) > self.cache_size:
            del self.cache_msgs[0], self.cache_times[0]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:
        """Return the messages from one time to another."""
        assert from_stamp <= to_stamp, "the interval ends before it begins"
        return [msg for time, msg in self._items() if from_stamp <= time <= to_stamp]

    def getElemAfterTime(self, stamp: Time) -> Any:
        """Return the first message of this time or later; None without one."""
        return next((msg for time, msg in self._items() if time >= stamp), None)

    def getElemBeforeTime(self, stamp: Time) -> Any:
        """Return the last message of this time or earlier; None without one."""
        return next((msg for time, msg in reversed(self._items()) if time <= stamp), None)

    def getLastestTime(self) -> Any:
        """Return the time of the last message; None without one. The name is ROS's."""
        return self.cache_times[-1] if self.cache_times else None

    def getOldestTime(self) -> Any:
        """Return the time of the first message; None without one."""
        return self.cache_times[0] if self.cache_times else None

    def getLast(self) -> Any:
        """Return the first message of the time of the last one; None without one."""
        latest = self.getLastestTime()
        return None if latest is None else self.getElemAfterTime(latest)

    def _items(self) -> list[tuple[Time, Any]]:
        return [*zip(self.cache_times, self.cache_msgs, strict=True)]


class TimeSynchronizer(SimpleFilter):
    """Hands on messages of several filters that have the same time.

    Args:
        fs: The filters.
        queue_size: How many messages of each wait for others.
    """

    def __init__(self, fs: Sequence[Any], queue_size: int):
        super().__init__()
        self.queue_size = queue_size
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[Any]) -> None:
        """Take the messages of other filters, in place of those before."""
        self.queues: list[dict[int, Any]] = [{} for _ in fs]
        self.input_connections = [
            each.registerCallback(self.add, queue, index)
            for index, (each, queue) in enumerate(zip(fs, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Take a message of one of the filters."""
        self._put(my_queue, Time.from_msg(msg.header.stamp), msg)
        for time in sorted(set(self.queues[0]).intersection(*self.queues[1:])):
            self._hand_on([time] * len(self.queues))

    def _put(self, queue: dict[int, Any], stamp: Time, msg: Any) -> None:
        queue[stamp.nanoseconds] = msg
        while len(queue) > self.queue_size:
            del queue[min(queue)]

    def _hand_on(self, times: Sequence[int]) -> None:
        """Hand on one message of each queue, by their times (ns)."""
        pairs = [*zip(self.queues, times, strict=True)]
        self.signalMessage(*(queue[time] for queue, time in pairs))
        for queue, time in pairs:
            del queue[time]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Hands on messages of several filters whose times are close to each other.

    Args:
        fs: The filters.
        queue_size: How many messages of each wait for others.
        slop: Their times differ by less than this (s).
        allow_headerless: Whether those without a header are taken, with the present time.
    """

    def __init__(self, fs: Sequence[Any], queue_size: int, slop: float, allow_headerless: bool = False):
        super().__init__(fs, queue_size)
        self.slop = Duration(seconds=slop)
        self.allow_headerless = allow_headerless

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Take a message of one of the filters, and look for those of the others that are closest to it."""
        stamp = _stamp(msg, "message_filters_approx", self.allow_headerless)
        if stamp is None:
            return
        own, slop = stamp.nanoseconds, self.slop.nanoseconds
        self._put(my_queue, stamp, msg)
        choices = [
            [own]
            if index == my_queue_index
            else sorted((time for time in queue if abs(time - own) <= slop), key=lambda time: abs(time - own))
            for index, queue in enumerate(self.queues)
        ]
        for times in product(*choices):
            known = all(time in queue for time, queue in zip(times, self.queues, strict=True))
            if known and max(times) - min(times) < slop:
                self._hand_on(times)
                return


def _stamp(msg: Any, name: str, allow_headerless: bool) -> Any:
    """Return the ``Time`` of a message; None if it has none and may not get the present one."""
    stamp = getattr(getattr(msg, "header", None), "stamp", None)
    if stamp is not None:
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    get_logger(name).warning(
        "can not use message filters messages without timestamp infomation when 'allow_headerless' is disabled. auto "
        "assign ROSTIME to headerless messages once enabling constructor option of 'allow_headerless'."
    )
    return None
