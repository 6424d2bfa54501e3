"""``drake-twin topic hz|bw|delay``: what is measured of a topic, as ``ros2 topic`` prints it once a second."""

import argparse
import math
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Arrivals, Now

if TYPE_CHECKING:
    from drake_twin.client import Client

_PERIOD = 1.0  # s between two lines


def _add_meter(parser: ArgumentParser, window: int) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    text = f"average over so many messages (default: {window})"
    parser.add_argument("-w", "--window", type=int, metavar="N", default=window, help=text)


def add_hz(parser: ArgumentParser) -> None:
    """Add the arguments of ``hz``."""
    _add_meter(parser, 10_000)


def add_bw(parser: ArgumentParser) -> None:
    """Add the arguments of ``bw``."""
    _add_meter(parser, 100)


def add_delay(parser: ArgumentParser) -> None:
    """Add the arguments of ``delay``."""
    _add_meter(parser, 10_000)
    Now.add_argument(parser)


def hz(client: "Client", options: argparse.Namespace) -> int:
    """Print how often messages arrive, by the wall clock."""
    last = 0

    def period(_: Any) -> int | None:
        nonlocal last
        before, last = last, time.monotonic_ns()
        return last - before if before else None

    return _measure(client, options, period, rate_text)


def bw(client: "Client", options: argparse.Namespace) -> int:
    """Print how many bytes arrive."""
    print(f"Subscribed to [{options.topic_name}]", flush=True)

    def size(data: bytes) -> tuple[int, int]:
        return time.monotonic_ns(), len(data)

    return _measure(client, options, size, lambda found: bandwidth_text(found, time.monotonic_ns()), is_raw=True)


def delay(client: "Client", options: argparse.Namespace) -> int:
    """Print how old messages are that have a stamp."""
    now = Now(client, options)

    def age(message: Any) -> int:
        if not hasattr(message, "header"):
            raise InputError(f"delay: a {message.__msgtype__} of {options.topic_name} has no header")
        stamp = message.header.stamp
        return now() - int(stamp.sec) * 1_000_000_000 - int(stamp.nanosec)

    return _measure(client, options, age, delay_text)


def _measure(
    client: "Client",
    options: argparse.Namespace,
    measured: Callable[[Any], Any],
    text: Callable[[Sequence[Any]], str],
    *,
    is_raw: bool = False,
) -> int:
    """Print a line of what is measured of the last messages, once a second while there are new ones."""
    if options.window < 1:
        raise InputError(f"--window {options.window}: the average is of at least one message")
    arrivals = Arrivals()
    found: deque[Any] = deque(maxlen=options.window)
    client.subscribe(options.topic_name, lambda message: arrivals.put((message,)), is_raw=is_raw)
    is_printed, due = True, time.monotonic() + _PERIOD
    try:
        while True:
            arrived = arrivals.get(due - time.monotonic())
            if arrived is not None and (value := measured(arrived[0])) is not None:
                found.append(value)
                is_printed = False
            if time.monotonic() >= due:
                due += _PERIOD
                if not is_printed:
                    print(text(found), flush=True)
                is_printed = True
    except KeyboardInterrupt:
        if not is_printed:
            print(text(found), flush=True)
    return 0


def _statistics(values: Sequence[int]) -> tuple[float, float]:
    """Return the mean and the standard deviation."""
    mean = math.fsum(values) / len(values)
    return mean, math.sqrt(math.fsum((value - mean) ** 2 for value in values) / len(values))


def _spread_text(values: Sequence[int], deviation: float) -> str:
    shortest, longest = min(values) * 1e-9, max(values) * 1e-9
    return f"\tmin: {shortest:.3f}s max: {longest:.3f}s std dev: {deviation * 1e-9:.5f}s window: {len(values)}"


def rate_text(periods: Sequence[int]) -> str:
    """Return what ``ros2 topic hz`` prints for the periods (ns) between messages."""
    mean, deviation = _statistics(periods)
    return f"average rate: {1e9 / mean if mean > 0 else 0.0:.3f}\n{_spread_text(periods, deviation)}"


def delay_text(delays: Sequence[int]) -> str:
    """Return what ``ros2 topic delay`` prints for the ages (ns) of messages."""
    mean, deviation = _statistics(delays)
    return f"average delay: {mean * 1e-9:.3f}\n{_spread_text(delays, deviation)}"


def bandwidth_text(found: Sequence[tuple[int, int]], now: int) -> str:
    """Return what ``ros2 topic bw`` prints.

    Args:
        found: When messages came (ns) and their sizes (bytes).
        now: The time (ns).
    """
    sizes = [size for _, size in found]
    rate = sum(sizes) / max(1e-9 * (now - found[0][0]), sys.float_info.min)
    divisor, digits, unit = (1, 0, "B") if rate < 1e3 else (1e3, 2, "KB") if rate < 1e6 else (1e6, 2, "MB")
    values = (rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
    a_second, mean, least, most = (f"{value / divisor:.{digits}f} {unit}" for value in values)
    return f"{a_second}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {most}"
