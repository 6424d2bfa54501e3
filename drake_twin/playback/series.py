"""The numbers of a topic over time, for plots and comparisons."""

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil, isfinite, nan
from typing import Any

import numpy as np

from drake_twin.cockpit.field_units import unit_at
from drake_twin.cockpit.message_fields import field_rows, number_at
from drake_twin.errors import InputError
from drake_twin.playback.bag import Bag

_MOST = 20_000  # messages of a topic, evenly chosen of more
_MOST_FIELDS = 200
_NOT_COMPARED = ("covariance", "header.", "stamp.", ".stamp", "frame_id")


class Series:
    """Numbers of the messages of a topic.

    Args:
        slides: Joint → whether it is prismatic, for the units.
        fields: The paths of the numbers; None for those of the first message that are worth comparing.

    Attributes:
        fields: The paths of the numbers.
        times: The times of the messages (s), ascending.
        rows: The numbers of each message, in the order of the fields; nan where it has none.
        units: Field → its unit, empty without one.
        problems: Field → why a message had no number there.
        every: One message of so many is taken.
    """

    def __init__(self, slides: Mapping[str, bool], fields: Sequence[str] | None = None):
        self._slides, self._is_open = slides, fields is None
        self.fields = list(fields or ())
        self.times: list[float] = []
        self.rows: list[list[float]] = []
        self.units: dict[str, str] = {}
        self.problems: dict[str, str] = {}
        self.every = 1

    def add(self, time: float, message: Any) -> None:
        """Add a message; those that are not before it are dropped, for time was turned back."""
        if self._is_open:
            self._is_open = False
            self.fields = [path for path, _, is_number in field_rows(message) if is_number and _is_compared(path)]
            del self.fields[_MOST_FIELDS:]
        while self.times and self.times[-1] >= time:
            self.times.pop()
            self.rows.pop()
        if len(self.times) >= 2 * _MOST:
            del self.times[:_MOST], self.rows[:_MOST]
        row = []
        for field in self.fields:
            try:
                row.append(number_at(message, field))
            except InputError as error:
                self.problems[field] = str(error)
                row.append(nan)
            else:
                if field not in self.units:
                    self.units[field] = unit_at(message, field, self._slides)
        self.times.append(time)
        self.rows.append(row)

    def values(self, field: str) -> np.ndarray:
        """Return the numbers of a field."""
        place = self.fields.index(field)
        return np.array([row[place] for row in self.rows])

    def curve(self, field: str, shift: float = 0.0) -> dict[str, Any]:
        """Return a curve as plain data: times (s) plus a shift (s), values with None for what is not finite, unit."""
        values = self.values(field).tolist()
        return {
            "times": [round(time + shift, 9) for time in self.times],
            "values": [value if isfinite(value) else None for value in values],
            "unit": self.units.get(field, ""),
        }


def reading(bag: Bag, topic: str, series: Series) -> Iterator[None]:
    """Read a topic of a bag into a series, a message with each step.

    Raises:
        InputError: If the bag is damaged.
    """
    series.every = ceil(bag.topics[topic][1] / _MOST) or 1
    for index, message in enumerate(bag.messages(lambda name, _: name == topic)):
        if index % series.every == 0:
            series.add(message.time, message.read())
        yield


def differences(own: Series, other: Series, shift: float) -> Iterator[tuple[str, float, float, float]]:
    """Yield for each field of both the largest difference, when it is, and the range of its values.

    The other's values are interpolated at the own times, where both are known.

    Args:
        own: The numbers.
        other: What they are compared with.
        shift: What is added to the other's times (s).
    """
    if not own.times or not other.times:
        return
    times = np.array(own.times)
    others = np.array(other.times) + shift
    begin, end = bisect_left(own.times, others[0] - 1e-6), bisect_left(own.times, others[-1] + 1e-6)
    times = times[begin:end]
    for field in own.fields:
        if field not in other.fields or not len(times):
            continue
        values, beside = own.values(field)[begin:end], other.values(field)
        known = np.isfinite(beside)
        if not known.any() or field not in own.units:
            continue
        apart = np.abs(values - np.interp(times, others[known], beside[known]))
        if np.isfinite(apart).any():
            place = int(np.nanargmax(apart))
            both = np.concatenate([values[np.isfinite(values)], beside[known]])
            yield field, float(apart[place]), float(times[place]), float(np.ptp(both))


def slides_of(plans: Sequence[Any]) -> dict[str, bool]:
    """Return for each joint of some robots whether it is prismatic."""
    return {joint.name: joint.type == "prismatic" for plan in plans for joint in plan.description.movable_joints}


def _is_compared(path: str) -> bool:
    return not any(part in path for part in _NOT_COMPARED)


def within(seconds: float, clock: Callable[[], float], work: Iterator[Any]) -> bool:
    """Let some work go on for some wall time (s); return whether it is done."""
    end = clock() + seconds
    return all(clock() < end for _ in work)
