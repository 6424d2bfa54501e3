"""Messages that are made later: their numbers are read now, and another thread turns them into messages or bytes.

Reading numbers takes a tenth of the time that a message takes, and a wire needs only its bytes, in its sender's thread.
"""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any, Protocol

import numpy as np

from drake_twin.messages.interface_types import serialize

_HEADER = 4  # bytes before the payload, in which numbers are aligned
_TIMES = 1234567890.123456789, 987654321.987654321  # s; not found in a message by chance


class Draft(Protocol):
    """A message that is not made yet; its methods may be called in any thread.

    Attributes:
        time: The time that it is of (s); None for that at which it is delivered.
    """

    time: float | None

    def message(self) -> Any:
        """Make the message; it may be None."""

    def serialized(self) -> bytes | None:
        """Return its CDR bytes; None without a message."""


class LaterDraft:
    """A message that is made and serialized as a whole.

    Args:
        make: Makes it, in any thread.
        time: The time that it is of (s); None for that at which it is delivered.
    """

    def __init__(self, make: Callable[[], Any], time: float | None = None):
        self._make = make
        self._message: Any = None
        self.time = time

    def message(self) -> Any:
        """Make the message, once; it may be None."""
        if self._message is None:
            self._message = self._make()
        return self._message

    def serialized(self) -> bytes | None:
        """Return its CDR bytes; None without a message."""
        message = self.message()
        return None if message is None else serialize(message)


class Drafter:
    """Drafts a topic's messages, which differ from each other in their stamp and in numbers only.

    Args:
        read: Reads what the numbers follow from, of a reading, which has a ``time`` (s).
        numbers: Returns them, shape (n,), from what was read; in any thread.
        make: Makes a message of a time (s) and the numbers; it puts each into places of type float64, unchanged.
        size: The number of numbers, n.
    """

    def __init__(
        self,
        read: Callable[[Any], np.ndarray],
        numbers: Callable[[np.ndarray], np.ndarray],
        make: Callable[[float, np.ndarray], Any],
        size: int,
    ):
        self._read = read
        self.numbers = numbers
        self.make = make
        self._size = size

    def __call__(self, reading: Any) -> Draft:
        """Draft a message."""
        return _NumbersDraft(self, reading.time, self._read(reading))

    def at(self, time: float, values: np.ndarray) -> Draft:
        """Draft a message of a time (s) from what would be read then."""
        return _NumbersDraft(self, time, values)

    def serialized(self, time: float, numbers: np.ndarray) -> bytes | None:
        """Return the CDR bytes of a message."""
        if self._layout is None:
            return LaterDraft(partial(self.make, time, numbers)).serialized()
        return self._layout.fill(time, numbers)

    @cached_property
    def _layout(self) -> "_Layout | None":
        """The places of the stamp and the numbers in the bytes; None without messages, or if they differ in more."""
        first, second = (base * np.linspace(1.0, 2.0, self._size) for base in (np.pi * 1e200, -np.pi * 1e100))
        message = self.make(_TIMES[0], first)
        layout = None if message is None else _Layout(serialize(message), first)
        is_right = layout is not None and layout.fill(_TIMES[1], second) == serialize(self.make(_TIMES[1], second))
        return layout if is_right else None


class _NumbersDraft:  # few calls: there is one for each message that is heard
    def __init__(self, drafter: Drafter, time: float, values: np.ndarray):
        self._drafter, self._time, self._values = drafter, time, values
        self._message: Any = None
        self.time: float | None = time

    def message(self) -> Any:
        if self._message is None:
            self._message = self._drafter.make(self._time, self._drafter.numbers(self._values))
        return self._message

    def serialized(self) -> bytes | None:
        return self._drafter.serialized(self._time, self._drafter.numbers(self._values))


class _Layout:
    """The places of stamps and numbers in a message's bytes.

    Args:
        data: The bytes of a message with the first of `_TIMES`.
        numbers: Its numbers, all different.
    """

    def __init__(self, data: bytes, numbers: np.ndarray):
        payload = data[_HEADER:]
        self._head, self._size = data[:_HEADER], len(payload)
        self._template = np.frombuffer(payload.ljust(-(-len(payload) // 8) * 8, b"\0"), dtype=np.uint8)
        bits = self._template.view("<u8")
        index_of = {int(pattern): index for index, pattern in enumerate(numbers.astype("<f8").view("<u8"))}
        found = [(place, index_of[pattern]) for place, pattern in enumerate(bits.tolist()) if pattern in index_of]
        self._places, self._indices = np.array(found, dtype=int).reshape(-1, 2).T
        words = self._template.view("<u4")
        stamp = _stamp(_TIMES[0])
        starts = np.flatnonzero((words[:-1] == stamp[0]) & (words[1:] == stamp[1]))
        self._stamps = np.add.outer(starts, (0, 1))

    def fill(self, time: float, numbers: np.ndarray) -> bytes:
        """Return the bytes of a message with this stamp and these numbers."""
        payload = self._template.copy()
        payload.view("<f8")[self._places] = numbers[self._indices]
        payload.view("<u4")[self._stamps] = _stamp(time)
        return self._head + payload.tobytes()[: self._size]


def _stamp(time: float) -> tuple[int, int]:
    return divmod(round(time * 1e9), 1_000_000_000)
