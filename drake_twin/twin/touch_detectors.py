"""What tells that a model has touched another one, as gz-sim's TouchPlugin: since when, and what is published then.

While one of them looks, contacts are read after each step, in the thread that advances the twin; Drake computes them
for the next step in any case.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.messages.interface_types import make
from drake_twin.planning.owned_detectors import OwnedDetector
from drake_twin.planning.performers import Detection
from drake_twin.sensors.sensor_host import SensorHost, sensor_hosts
from drake_twin.twin.clock import Clock
from drake_twin.twin.endpoints import PUBLISHED, TWIN_NODE, Endpoint
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.physics import Physics

if TYPE_CHECKING:
    from drake_twin.description.touches import EnableTouch, TouchDetector
    from drake_twin.sensors.contact import ContactSensor

_FLAG = "std_msgs/msg/Bool"
_DEPTH = 10

Key = tuple[str, int]


class TouchDetectors:
    """The detectors of touches of a session.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has.
        hear: Is called with a topic and a message, for those that trigger something.

    Attributes:
        is_watching: Whether one of them looks.
        endpoints: Their topics.
    """

    def __init__(self, clock: Clock, events: EventTopics, hear: Callable[[str, Any], None]):
        self._clock, self._events, self._hear = clock, events, hear
        self.is_watching = False
        self.endpoints: tuple[Endpoint, ...] = ()
        self._detectors: dict[Key, OwnedDetector[TouchDetector]] = {}
        self._looking: dict[Key, float | None] = {}  # those that look → since when they touch (s)
        self._sensors: dict[Key, list[tuple[SensorHost, ContactSensor]]] = {}

    def use(self, built: TwinDiagram, detection: Detection) -> None:
        """Switch to a newly built diagram; what is touched stays so."""
        known = self._detectors
        self._detectors = {(item.model, item.number): item for item in detection.touches}
        for key, item in self._detectors.items():
            if key not in known and item.detector.is_enabled:
                self._looking[key] = None
        self._look_with({key: since for key, since in self._looking.items() if key in self._detectors})
        self._sensors = _sensors_of(built, self._detectors) if self._detectors else {}
        topics = dict.fromkeys(item.topic for item in self._detectors.values())
        self.endpoints = tuple(Endpoint(PUBLISHED, topic, _FLAG, TWIN_NODE, depth=_DEPTH) for topic in topics)

    def enable(self, request: "EnableTouch") -> None:
        """Let detectors look from now on, or no longer."""
        looking = dict(self._looking)
        for key, item in self._detectors.items():
            if item.detector.topic == request.topic:
                looking.pop(key, None)
                if request.is_enabled:
                    looking[key] = None
        self._look_with(looking)

    def look(self, physics: Physics) -> None:
        """Publish which models have touched their targets for long enough in the step that has ended."""
        time, looking = self._clock.time, dict(self._looking)
        for key, since in self._looking.items():
            item = self._detectors[key]
            if not self._touches(key, item, physics):
                looking[key] = None
            elif since is None:
                looking[key] = since = time
            if looking[key] is not None and time - looking[key] > item.detector.time + 1e-9:  # type: ignore[operator]
                del looking[key]
                self._events[item.topic].put(lambda: {"data": True})
                self._hear(item.topic, make(_FLAG, {"data": True}))
        self._look_with(looking)

    def start(self) -> None:
        """Look where that is meant from the start on."""
        self._look_with({key: None for key, item in self._detectors.items() if item.detector.is_enabled})

    def state(self) -> dict[str, Any]:
        """Return the entry of a snapshot that this part keeps: each detector that looks, and since when it touches."""
        found = [[model, number, since] for (model, number), since in self._looking.items()]
        return {"touching": found} if found else {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entry that `state` returned.

        Raises:
            ValueError: If it is that of other models.
        """
        looking = {
            (str(model), int(number)): None if since is None else float(since)
            for model, number, since in state.get("touching", ())
        }
        if not looking.keys() <= self._detectors.keys():
            raise ValueError("its models touch others")
        self._look_with(looking)

    def _look_with(self, looking: dict[Key, float | None]) -> None:
        self._looking = {key: looking[key] for key in self._detectors if key in looking}
        self.is_watching = bool(self._looking)

    def _touches(self, key: Key, item: "OwnedDetector[TouchDetector]", physics: Physics) -> bool:
        with suppress(RuntimeError, SystemExit):  # where Drake cannot solve the next step, that says so
            for host, sensor in self._sensors[key]:
                pairs = sensor.pairs(host.GetMyContextFromRoot(physics.context))
                if any(item.detector.is_met(own, other) for own, other in pairs):
                    return True
        return False


def _sensors_of(built: TwinDiagram, keys: Iterable[Key]) -> dict[Key, list[tuple[SensorHost, "ContactSensor"]]]:
    """Return the contact sensors of the model of each detector."""
    from drake_twin.sensors.contact import ContactSensor

    found: dict[Key, list[tuple[SensorHost, ContactSensor]]] = {key: [] for key in keys}
    for host in sensor_hosts(built.diagram):
        for sensor in host.sensors:
            for key in found:
                if isinstance(sensor, ContactSensor) and sensor.setup.owner == key[0]:
                    found[key].append((host, sensor))
    return found
