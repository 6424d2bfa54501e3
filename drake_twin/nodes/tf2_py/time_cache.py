"""The transforms of one frame in its parent over time."""

from bisect import bisect_left, bisect_right
from typing import NamedTuple

from drake_twin.nodes.rigid_motion import Quaternion, Vector, interpolated
from drake_twin.nodes.tf2_py.exceptions import ExtrapolationException


class Stored(NamedTuple):
    """A transform.

    Attributes:
        stamp: Its time (ns).
        parent: The frame that it is in.
        translation: The frame's origin in it (m).
        rotation: The frame's rotation in it.
    """

    stamp: int
    parent: str
    translation: Vector
    rotation: Quaternion


def shown(stamp: int) -> str:
    """Return a time as tf2's errors have it."""
    return f"{stamp // 1_000_000_000 + 1e-9 * (stamp % 1_000_000_000):.6f}"


class TimeCache:
    """Transforms of the last seconds.

    Args:
        longest: How long before the newest one they are kept (ns).
    """

    def __init__(self, longest: int):
        self._longest = longest
        self._items: list[Stored] = []  # the newest last

    def __len__(self) -> int:
        return len(self._items)

    @property
    def oldest(self) -> int:
        """The time of the oldest one (ns)."""
        return self._items[0].stamp if self._items else 0

    @property
    def latest(self) -> int:
        """The time of the newest one (ns)."""
        return self._items[-1].stamp if self._items else 0

    @property
    def latest_parent(self) -> str:
        """The parent in the newest one; empty without one."""
        return self._items[-1].parent if self._items else ""

    def insert(self, item: Stored) -> bool:
        """Add a transform; return whether it is not too old."""
        items = self._items
        del items[: bisect_left(items, self.latest - self._longest, key=_stamp)]
        if items and item.stamp < self.latest - self._longest:
            return False
        first, last = bisect_left(items, item.stamp, key=_stamp), bisect_right(items, item.stamp, key=_stamp)
        if item not in items[first:last]:
            items.insert(last, item)
        return True

    def at(self, time: int) -> Stored:
        """Return the transform at a time (ns), between the two around it; the newest at time zero.

        Raises:
            ExtrapolationException: If the time is outside of theirs.
        """
        items = self._items
        if not items:
            raise ExtrapolationException("")
        if time in (0, items[-1].stamp):
            return items[-1]
        if len(items) == 1:
            text = f"at time {shown(time)}, but only time {shown(items[0].stamp)} is in the buffer"
            raise ExtrapolationException(f"Lookup would require extrapolation {text}")
        if time > items[-1].stamp:
            raise _outside(time, "future", "latest", items[-1].stamp)
        if time < items[0].stamp:
            raise _outside(time, "past", "earliest", items[0].stamp)
        index = bisect_right(items, time, key=_stamp)
        one, other = items[index - 1], items[index]
        if one.stamp == time or one.parent != other.parent:
            return one
        ratio = (time - one.stamp) / (other.stamp - one.stamp)
        x, y, z = ((1 - ratio) * a + ratio * b for a, b in zip(one.translation, other.translation, strict=True))
        return one._replace(translation=(x, y, z), rotation=interpolated(one.rotation, other.rotation, ratio))

    def clear(self) -> None:
        """Remove all."""
        self._items.clear()


class StaticCache(TimeCache):
    """One transform, which holds at all times."""

    def __init__(self) -> None:
        super().__init__(0)

    @property
    def oldest(self) -> int:
        """The time of the oldest one (ns): zero."""
        return 0

    @property
    def latest(self) -> int:
        """The time of the newest one (ns): zero."""
        return 0

    def insert(self, item: Stored) -> bool:
        """Replace the transform."""
        self._items = [item]
        return True

    def at(self, time: int) -> Stored:
        """Return the transform."""
        return self._items[0]._replace(stamp=time)

    def clear(self) -> None:
        """Keep the transform, as tf2 does."""


def _stamp(item: Stored) -> int:
    return item.stamp


def _outside(time: int, where: str, which: str, known: int) -> ExtrapolationException:
    return ExtrapolationException(
        f"Lookup would require extrapolation into the {where}.  Requested time {shown(time)} "
        f"but the {which} data is at time {shown(known)}"
    )
