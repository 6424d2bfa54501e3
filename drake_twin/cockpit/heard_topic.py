"""Topics that the page listens to: those of the diagram, and what node programs have between themselves."""

from collections import deque
from collections.abc import Callable
from math import ceil, isfinite
from typing import Any

from drake_twin.cockpit.field_units import unit_at
from drake_twin.cockpit.message_fields import number_at
from drake_twin.errors import InputError
from drake_twin.twin.endpoints import PUBLISHED, Endpoint
from drake_twin.twin.twin import Twin

_MOST_A_SECOND = 50.0  # messages of a topic
_MOST_SAMPLES = 500  # of a curve in one snapshot: the last ones
_MEASURED = 50  # messages over which a rate is measured
_TRANSFORMS = "tf2_msgs/msg/TFMessage"


def all_endpoints(twin: Twin, known: tuple[Endpoint, ...]) -> tuple[Endpoint, ...]:
    """Return the endpoints of a twin and of its node programs; the known ones if these are still the same."""
    more = twin.more_topics
    found = twin.graph.endpoints if more is None else (*twin.graph.endpoints, *more.endpoints())
    return known if found == known else found


def is_of_twin(twin: Twin, topic: str) -> bool:
    """Return whether the diagram itself publishes a topic."""
    return any(item.name == topic and item.kind == PUBLISHED for item in twin.graph.endpoints)


def tap(twin: Twin, type_: str, topics: Callable[[str], bool], note: Callable[[str, Any], None]) -> Callable[[], None]:
    """Call a function with topic and message of what node programs publish, with the latched messages first.

    Args:
        twin: The twin.
        type_: The type of the messages.
        topics: Whether a topic is listened to.
        note: The function.

    Returns:
        A function that ends it.
    """
    more = twin.more_topics
    if more is None:
        return lambda: None

    def hear(publication: Any, message: Any) -> None:
        if publication.type == type_ and topics(publication.topic):
            note(publication.topic, message)

    for publications in list(more.publications.values()):
        for publication in publications:
            for message in publication.kept():
                hear(publication, message)
    more.taps.append(hear)
    return lambda: more.taps.remove(hear)


def tap_transforms(twin: Twin, add: Callable[..., None]) -> Callable[[], None]:
    """Call ``add(message, is_static=…)`` with what node programs publish on /tf and /tf_static; return what ends it."""
    topics = ("/tf", "/tf_static")
    return tap(twin, _TRANSFORMS, topics.__contains__, lambda topic, item: add(item, is_static=topic == topics[1]))


def _sliding_joints(twin: Twin, robot: str) -> dict[str, bool]:
    """Return for each joint of a robot, or of all for a topic of none, whether it is prismatic."""
    plans = [plan for plan in twin.built.plans if robot in ("", plan.name)]
    return {joint.name: joint.type == "prismatic" for plan in plans for joint in plan.description.movable_joints}


class _Heard:
    """A topic that is listened to, until it ends."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._ends: list[Callable[[], None]] = []

    def end(self) -> None:
        """Listen no longer."""
        for end in self._ends:
            end()


class HeardTopic(_Heard):
    """A topic that is listened to."""

    def __init__(self, twin: Twin, endpoint: Endpoint):
        super().__init__(twin)
        self.message: Any = None
        self.time = 0.0
        self.pending: dict[str, deque[tuple[float, float | None]]] = {}  # field → samples since the last snapshot
        self.problems: dict[str, str] = {}  # field → why the last message has no number there
        self.units: dict[str, str] = {}  # field → its unit
        self._slides = _sliding_joints(twin, endpoint.robot)
        name, rate = endpoint.name, endpoint.rate
        self._ends = [tap(twin, endpoint.type, name.__eq__, lambda _, message: self._note(message))]
        if is_of_twin(twin, name):
            seldom = rate / ceil(rate / _MOST_A_SECOND - 1e-9) if rate else None
            self._ends.append(twin.subscribe(name, self._note, seldom))

    def plot(self, fields: set[str]) -> None:
        """Take samples of these fields from now on, and of no others."""
        self.pending = {field: self.pending.get(field, deque(maxlen=_MOST_SAMPLES)) for field in sorted(fields)}
        self.problems = {field: text for field, text in self.problems.items() if field in fields}
        self.units = {field: unit for field, unit in self.units.items() if field in fields}

    def _note(self, message: Any) -> None:
        self.message, self.time = message, self._twin.time
        for field, samples in self.pending.items():
            try:
                value = number_at(message, field)
            except InputError as error:
                self.problems[field] = str(error)
                continue
            self.problems.pop(field, None)
            if field not in self.units:
                self.units[field] = unit_at(message, field, self._slides)
            samples.append((round(self.time, 9), value if isfinite(value) else None))


class TopicRate(_Heard):
    """The measured rate of a topic whose messages are shown; no message is made for it."""

    def __init__(self, twin: Twin, endpoint: Endpoint):
        super().__init__(twin)
        self._times: deque[float] = deque(maxlen=_MEASURED)
        self._ends = [tap(twin, endpoint.type, endpoint.name.__eq__, self._note)]
        if is_of_twin(twin, endpoint.name):
            self._ends.append(twin.graph.subscribe_drafts(endpoint.name, self._note))

    def _note(self, *_: object) -> None:
        if self._times and self._twin.time <= self._times[-1]:  # after a jump back in time
            self._times.clear()
        self._times.append(self._twin.time)

    @property
    def rate(self) -> float | None:
        """Messages per second of simulation time; None before the second message."""
        return round((len(self._times) - 1) / (self._times[-1] - self._times[0]), 2) if len(self._times) > 1 else None
