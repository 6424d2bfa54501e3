"""The panel of the world: its tree, and the details of what each tab has selected. Nobody looks: nothing is read."""

from collections import deque
from collections.abc import Callable
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import Any

from drake_twin.cockpit.inspector import details, pose_of
from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import read_as
from drake_twin.cockpit.world_tree import Node, every_node, world_tree
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Vector3
from drake_twin.diagram.footprint import footprint
from drake_twin.errors import InputError
from drake_twin.scenario import Robot
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.twin import Twin

_PATIENCE = 60  # snapshots, about 4 s, that a tab is given data for without asking again
_MOST_SELECTED = 20
_MOST_EDITS = 20  # that can be undone
_HOLD = 1.0  # s of wall time after which the drag of a tab that has gone ends
_GAP = 0.3  # m between a robot and its duplicate
_STEP = 1.0  # m from a model of the world to its duplicate


@dataclass(frozen=True)
class Look:
    """A tab shows the panel; repeated about once a second.

    Attributes:
        version: The version of the tree that it has; 0 for none.
        node: The selected node; empty for none.
    """

    version: int
    node: str


@dataclass(frozen=True)
class Place:
    """Put a robot or a model of the world elsewhere (m, rad)."""

    entity: str
    xyz: Vector3
    rpy: Vector3


@dataclass(frozen=True)
class Duplicate:
    """Add a robot or a model of the world like one that is there, beside it."""

    entity: str


@dataclass(frozen=True)
class Remove:
    """Delete a robot or a model of the world."""

    entity: str


@dataclass(frozen=True)
class Undo:
    """Return the twin to the moment before the last edit."""


@dataclass(frozen=True)
class Drag:
    """Draw a point of a link (m, in its frame) to a point of the world (m); repeated while the mouse holds it."""

    entity: str
    at: Vector3
    target: Vector3


@dataclass(frozen=True)
class Release:
    """End a drag."""

    entity: str


@dataclass(frozen=True)
class Push:
    """Push a link with a force (N, in the world's axes) for a time (s)."""

    entity: str
    force: Vector3
    duration: float


_REQUESTS = {kind.__name__: kind for kind in (Look, Place, Duplicate, Remove, Undo, Drag, Release, Push)}


@panel("world", Path(__file__).with_name("static") / "world_panel.js")
class WorldPanel:
    """The world's tree and what is selected in it."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._plans: object = None
        self._version = 0
        self._tree: tuple[Node, ...] = ()
        self._nodes: dict[str, Node] = {}
        self._looks: dict[Look, int] = {}  # → snapshots for which it holds
        self._owes_tree = False  # to a tab that has asked since the last snapshot
        self._undo: deque[tuple[str, Snapshot]] = deque(maxlen=_MOST_EDITS)

    def state(self) -> dict[str, Any] | None:
        """Return the tree for those who do not have it, and details; None while nobody looks."""
        self._looks = {look: left - 1 for look, left in self._looks.items() if left > 1}
        if not self._looks:
            return None
        before = self._version
        self._read()
        is_owed = self._owes_tree or self._version != before
        needs_tree = is_owed and any(look.version != self._version for look in self._looks)
        self._owes_tree = False
        nodes = [self._nodes[name] for name in dict.fromkeys(look.node for look in self._looks) if name in self._nodes]
        return {
            "version": self._version,
            "tree": [node.as_plain() for node in self._tree] if needs_tree else None,
            "undo": self._undo[-1][0] if self._undo else "",
            "details": {node.id: asdict(details(self._twin, node)) for node in nodes},
        }

    def ask(self, data: Any) -> None:
        """Do what a tab asks.

        Raises:
            InputError: If the request is not one, or the twin refuses it.
        """
        request = read_as(_REQUESTS, data)
        match request:
            case Look():
                self._looks = {look: left for look, left in self._looks.items() if look != request}
                self._looks = dict([*self._looks.items(), (request, _PATIENCE)][-_MOST_SELECTED:])
                self._owes_tree = True
            case Place(entity, xyz, rpy):
                self._edit(f"move {entity}", lambda: self._twin.entities.place(entity, xyz, rpy))
            case Duplicate(entity):
                self._edit(f"duplicate {entity}", lambda: self._duplicate(entity))
            case Remove(entity):
                self._edit(f"delete {entity}", lambda: self._twin.entities.delete(entity))
            case Drag(entity, at, target):
                duration = _HOLD * max(1.0, self._twin.clock.real_time_rate)
                self._twin.entities.drag(entity, target, at, duration)
            case Release(entity):
                self._twin.entities.release(entity)
            case Push(entity, force, duration):
                self._twin.entities.apply_wrench(entity, force, duration=duration)
            case Undo() if self._undo:
                self._twin.restore(self._undo[-1][1])
                self._undo.pop()
            case Undo():
                raise InputError("no edit is left to undo")
            case _:
                raise InputError(f"unknown request {data!r} of the panel of the world")

    def _edit(self, what: str, do: Callable[[], None]) -> None:
        before = self._twin.snapshot()
        do()
        self._undo.append((f"{what} at {self._twin.time:.2f} s", before))

    def _duplicate(self, name: str) -> None:
        """Add a robot or model like one that is there, under a free name, beside it."""
        twin = self._twin
        models = {} if twin.built.world_file is None else {model.name: model for model in twin.built.world_file.models}
        stem = name.rstrip("0123456789").rstrip("_")
        taken = {*twin.robots, *models, *twin.scenario.world.without_models}
        free = next(own for own in (f"{stem}_{number}" for number in count(2)) if own not in taken)
        if name in models:
            xyz, rpy = pose_of(twin, name)
            twin.entities.copy_model(name, free, (xyz[0], xyz[1] + _STEP, xyz[2]), rpy)
        else:
            twin.entities.spawn(self._beside(name, free))

    def _beside(self, name: str, free: str) -> Robot:
        """Return a robot like one that is there, under a free name, beside it on the side that it faces y."""
        twin = self._twin
        robot = next((item for item in twin.scenario.robots if item.name == name), None)
        if robot is None:
            raise InputError(f"unknown robot {name!r}", value=name, valid=twin.robots)
        box = footprint(next(plan for plan in twin.built.plans if plan.name == name))
        width = box.upper[1] - box.lower[1] + _GAP
        x, y, _ = twin.entities.state(name).position
        return replace(robot, name=free, namespace=None, frame_prefix=None, xyz=(x, y + width, robot.xyz[2]))

    def _read(self) -> None:
        """Read the tree again if robots or models have come or gone."""
        if self._plans is self._twin.built.plans:
            return
        self._plans = self._twin.built.plans
        self._version += 1
        self._tree = world_tree(self._twin)
        self._nodes = {node.id: node for node in every_node(self._tree)}
