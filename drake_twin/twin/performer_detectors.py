"""The regions that notice performers, as gz-sim's PerformerDetector: which are inside, and what is published then.

They are looked at after each step, in the thread that advances the twin, so that a run repeats to the last bit.
"""

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from pydrake.math import RigidTransform

from drake_twin import messages
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.messages.interface_types import make
from drake_twin.planning.owned_detectors import OwnedDetector
from drake_twin.planning.performers import Detection
from drake_twin.twin.clock import Clock
from drake_twin.twin.endpoints import PUBLISHED, TWIN_NODE, Endpoint
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.model_frame import ModelFrame, model_frame
from drake_twin.twin.physics import Physics

if TYPE_CHECKING:
    from drake_twin.description.performers import PerformerDetector

_POSE, _STAMPED, _HEADER = (
    "geometry_msgs/msg/Pose",
    "geometry_msgs/msg/PoseStamped",
    "diagnostic_msgs/msg/DiagnosticStatus",
)
_DEPTH = 10


class PerformerDetectors:
    """The regions of a session.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has.
        hear: Is called with a topic and a message, for those that trigger something.

    Attributes:
        is_watching: Whether there are regions and performers.
        endpoints: Their topics.
    """

    def __init__(self, clock: Clock, events: EventTopics, hear: Callable[[str, Any], None]):
        self._clock, self._events, self._hear = clock, events, hear
        self.is_watching = False
        self.endpoints: tuple[Endpoint, ...] = ()
        self._detectors: tuple[OwnedDetector[PerformerDetector], ...] = ()
        self._inside: dict[tuple[str, int], list[str]] = {}
        self._frames: dict[str, ModelFrame] = {}
        self._halves: dict[str, tuple[float, float, float]] = {}

    def use(self, built: TwinDiagram, detection: Detection) -> None:
        """Switch to a newly built diagram; what is inside a region stays so if both are still there."""
        self._halves = {item.model: _halved(item.size) for item in detection.performers}
        self._detectors = detection.detectors if self._halves else ()
        self.is_watching = bool(self._detectors)
        self._inside = {
            (item.model, item.number): [
                name for name in self._inside.get((item.model, item.number), ()) if name in self._halves
            ]
            for item in self._detectors
        }
        names = dict.fromkeys([*self._halves, *(item.model for item in self._detectors)])
        self._frames = {name: model_frame(built, name) for name in names} if self.is_watching else {}
        topics = dict.fromkeys(item.topic for item in detection.detectors)
        types = dict.fromkeys(topics, _STAMPED) | {f"{topic}/header": _HEADER for topic in topics}
        self.endpoints = tuple(
            Endpoint(PUBLISHED, topic, type_, TWIN_NODE, depth=_DEPTH) for topic, type_ in types.items()
        )

    def look(self, physics: Physics) -> None:
        """Publish who has entered or left a region in the step that has ended."""
        context = physics.plant_context
        poses = {name: frame.pose(context) for name, frame in self._frames.items()}
        places = {name: poses[name].translation().tolist() for name in self._halves}
        for item in self._detectors:
            X_WM, inside = poses[item.model], self._inside[item.model, item.number]
            x, y, z = (X_WM @ item.detector.offset).tolist()
            width, depth, height = item.detector.size
            for name, (own_x, own_y, own_z) in self._halves.items():
                # Boxes along the axes of the world, also where the models are turned, and their edges are part of them.
                at_x, at_y, at_z = places[name]
                is_inside = (
                    abs(at_x - x) <= width / 2 + own_x
                    and abs(at_y - y) <= depth / 2 + own_y
                    and abs(at_z - z) <= height / 2 + own_z
                )
                if is_inside != (name in inside):
                    (inside.append if is_inside else inside.remove)(name)
                    self._tell(item, name, is_inside, len(inside), X_WM.inverse() @ poses[name])

    def start(self) -> None:
        """Forget who is inside."""
        self._inside = {key: [] for key in self._inside}

    def state(self) -> dict[str, Any]:
        """Return the entry of a snapshot that this part keeps."""
        found = [[model, number, [*names]] for (model, number), names in self._inside.items() if names]
        return {"detected": found} if found else {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entry that `state` returned.

        Raises:
            ValueError: If it is that of other regions or performers.
        """
        inside = {(str(model), int(number)): [*names] for model, number, names in state.get("detected", ())}
        if not inside.keys() <= self._inside.keys() or any(
            len({*names}) != len(names) or not {*names} <= self._halves.keys() for names in inside.values()
        ):
            raise ValueError("there are no such performers or detectors")
        self._inside = {key: inside.get(key, []) for key in self._inside}

    def _tell(
        self, item: "OwnedDetector[PerformerDetector]", name: str, state: bool, count: int, X_MP: RigidTransform
    ) -> None:
        w, x, y, z = X_MP.rotation().ToQuaternion().wxyz().tolist()
        position = dict(zip("xyz", X_MP.translation().tolist(), strict=True))
        pose = {"position": position, "orientation": {"x": x, "y": y, "z": z, "w": w}}
        header = messages.header(self._clock.time, item.model)
        entries = [("frame_id", item.model), ("state", str(int(state))), ("count", str(count)), *item.detector.header]
        values = [{"key": key, "value": value} for key, value in entries]
        self._events[item.topic].put(lambda: {"header": header, "pose": pose})
        self._events[f"{item.topic}/header"].put(lambda: {"name": name, "values": values})
        data = [(key, (value,)) for key, value in entries]  # which gz's message has, and ROS's has not
        self._hear(item.topic, SimpleNamespace(**vars(make(_POSE, pose)), name=name, header=SimpleNamespace(data=data)))


def _halved(size: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = size
    return x / 2, y / 2, z / 2
