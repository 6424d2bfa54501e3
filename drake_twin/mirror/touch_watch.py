"""Which contacts of a simulated twin are collisions: what touches, and did not at the start, and is not stood upon."""

from math import ceil
from typing import Any

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometryId, GeometrySet, Role
from pydrake.multibody.tree import JointIndex, ModelInstanceIndex, RigidBody

from drake_twin.description.drake_urdf import urdf_link_name
from drake_twin.diagram.joint_friction import is_brake
from drake_twin.mirror.trajectory_verdict import COLLISION, Allowed, Found
from drake_twin.sensors.collision_names import static_shape_name
from drake_twin.twin.twin import Twin

_UPWARD = 0.64  # the least vertical part of the direction in which what a robot stands on pushes it: slopes to 50°
_GRAZING, _NEAR = 0.001, 0.002  # s, and rad or m that joints move, between two looks at shapes: whichever is longer
_FURTHER = 0.5  # of a longer step: with shorter ones joints may get so much further before they turn round
_MOST_FACES = 12  # of a contact's surface that are looked at for that direction

Pair = tuple[str, str]  # of what touches, in alphabetical order


class TouchWatch:
    """Looks for collisions after each step.

    A robot that can move about stands on links that touch something below them at the start, and on wheels (links at
    the ends of continuous joints): these may touch what pushes them upward, or is below them.

    Links that only graze something do so for a millisecond or two. So between two steps that are longer, shapes are
    looked at as well, at joint positions between those of the steps, and a little further.

    Args:
        allowed: What is not a problem.
        found: Where collisions are noted.
    """

    def __init__(self, allowed: Allowed, found: Found):
        self._allowed, self._found = allowed, found
        self._known: set[Pair] = set()  # touches that are not reported (again)
        self._standing: set[str] = set()  # links
        self._looked: float | None = None  # s

    def use(self, twin: Twin) -> None:
        """Look at this twin, or at its newly built diagram; the first one is at the start.

        Raises:
            RunError: If Drake cannot solve the next step.
        """
        self._twin, built, plant = twin, twin.built, twin.plant
        self._port = built.ports.contact_results()
        inspector = built.scene_graph.model_inspector()
        owners, robots = built.owners(), {parts.instance: name for name, parts in built.robots.items()}
        self._names: dict[GeometryId, str] = {}
        self._robots: dict[str, str] = {}  # link → robot
        self._bodies: dict[str, RigidBody] = {}
        self._context = plant.GetMyContextFromRoot(twin.context)
        for geometry in inspector.GetAllGeometryIds(Role.kProximity):
            if is_brake(inspector, geometry):
                continue
            body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
            owner = owners.get(body.model_instance())
            if owner is None:
                shape = static_shape_name(inspector, geometry)
                self._names[geometry] = shape.partition("/")[0] or str(inspector.GetName(geometry))
                continue
            self._names[geometry] = name = f"{owner}::{urdf_link_name(body.name())}"
            if body.model_instance() in robots:
                self._robots[name], self._bodies[name] = owner, body
        self._ignored: set[tuple[GeometryId, GeometryId]] = set()
        if self._looked is None:
            self._look_at_start()
        links = {name for name in self._robots if name not in self._standing}
        self._shapes = _Shapes(twin, self._names, links, with_own=not self._allowed.self_collisions)
        if self._looked is None:
            self._looked = self._found.time
            self._known |= self._shapes.touching(self._shapes.positions())
        self._before = self._shapes.positions()

    def look(self) -> None:
        """Note the collisions since the last look.

        Raises:
            RunError: If Drake cannot solve the next step.
        """
        self._look_between()
        for first, second, info in self._contacts():
            if (first, second) in self._ignored:
                continue
            one, other = self._names.get(first, ""), self._names.get(second, "")
            pair = _pair(one, other)
            if pair in self._known or not self._concerns(one, other):
                self._ignored.add((first, second))
            elif not self._is_stood_upon(one, other, info):
                self._report(pair)

    def _look_between(self) -> None:
        assert self._looked is not None
        passed, now = self._found.time - self._looked, self._shapes.positions()
        most = max(1, round(passed / _GRAZING))
        count = min(ceil(float(np.max(np.abs(now - self._before), initial=0.0)) / _NEAR) or 1, most)
        parts = [number / count for number in range(1, count + 1)]
        if most > 1:
            parts.append(1.0 + _FURTHER)
        for part in parts:
            for pair in self._shapes.touching((1.0 - part) * self._before + part * now):
                if pair not in self._known and self._concerns(*pair):
                    self._report(pair, self._looked + part * passed)
        self._looked, self._before = self._found.time, now

    def _look_at_start(self) -> None:
        movable = {plan.name for plan in self._twin.built.plans if not plan.model.is_fixed}
        for first, second, info in self._contacts():
            one, other = self._names.get(first, ""), self._names.get(second, "")
            self._known.add(_pair(one, other))
            up = _upward(info)
            self._standing |= {name for name, part in ((one, up), (other, -up)) if part > _UPWARD}
        self._standing = {link for link in self._standing if self._robots.get(link) in movable}
        for plan in self._twin.built.plans:
            joints = plan.description.joints if plan.name in movable else ()
            parents = {joint.parent for joint in joints}
            wheels = (joint.child for joint in joints if joint.type == "continuous" and joint.child not in parents)
            self._standing |= {f"{plan.name}::{link}" for link in wheels}

    def _contacts(self) -> "list[tuple[GeometryId, GeometryId, Any]]":
        results = self._twin.graph.evaluate(self._port)
        contacts: list[tuple[GeometryId, GeometryId, Any]] = []
        for index in range(results.num_point_pair_contacts()):
            pair = results.point_pair_contact_info(index).point_pair()
            contacts.append((pair.id_A, pair.id_B, pair))
        for index in range(results.num_hydroelastic_contacts()):
            surface = results.hydroelastic_contact_info(index).contact_surface()
            contacts.append((surface.id_M(), surface.id_N(), surface))
        return contacts

    def _concerns(self, one: str, other: str) -> bool:
        """Return whether a touch is a robot's, and not allowed."""
        if not (one and other) or (one not in self._robots and other not in self._robots):
            return False
        may = self._allowed.touches
        return not any(name in may or name.partition("::")[0] in may for name in (one, other))

    def _is_stood_upon(self, one: str, other: str, info: Any) -> bool:
        if self._robots.get(one) == self._robots.get(other):
            return False
        up = _upward(info)
        for name, part in ((one, up), (other, -up)):
            if name in self._standing and max(part, self._above(name, _place(info))) > _UPWARD:
                return True
        return False

    def _above(self, link: str, place: np.ndarray) -> float:
        """Return the vertical part of the direction from a place to a link's origin.

        A wheel that rolls onto a kerb is above its edge, whichever face of the kerb Drake has it pushed from.
        """
        way = self._bodies[link].EvalPoseInWorld(self._context).translation() - place
        length = float(np.linalg.norm(way))
        return float(way[2]) / length if length > 0.0 else 0.0

    def _report(self, pair: Pair, time: float | None = None) -> None:
        self._known.add(pair)
        first, second = pair if pair[0] in self._robots else pair[::-1]
        self._found.add(COLLISION, self._robots[first], (first, second), f"{first} touches {second}", time)


class _Shapes:
    """The shapes of robots' links in a context of their own, in which only some pairs of them are looked at.

    These are links and what does not belong to their robot, and links of one robot that no joint holds together,
    whether or not they may pass in the twin.

    Args:
        twin: The twin.
        names: What each shape belongs to.
        links: The links that are looked at beside what does not belong to their robot.
        with_own: Whether to look at links of one robot.
    """

    def __init__(self, twin: Twin, names: dict[GeometryId, str], links: set[str], *, with_own: bool):
        self._plant, self._names = twin.plant, names
        self._context = twin.plant.GetMyContextFromRoot(twin.context)
        root = twin.diagram.CreateDefaultContext()
        self._own_context = twin.plant.GetMyMutableContextFromRoot(root)
        scene_graph = twin.built.scene_graph
        self._scene_context = scene_graph.GetMyMutableContextFromRoot(root)
        self._query = scene_graph.get_query_output_port()
        manager = scene_graph.collision_filter_manager(self._scene_context)
        every = GeometrySet([*scene_graph.model_inspector().GetAllGeometryIds(Role.kProximity)])
        manager.Apply(CollisionFilterDeclaration().ExcludeWithin(every))
        for robot, parts in twin.built.robots.items():
            own = [each for each in names if names[each] in links and names[each].partition("::")[0] == robot]
            others = [each for each in names if names[each].partition("::")[0] != robot]
            pairs = [(own, others), *(_apart(self._plant, parts.instance, names) if with_own else ())]
            for one, other in pairs:
                if one and other:
                    manager.Apply(CollisionFilterDeclaration().AllowBetween(GeometrySet(one), GeometrySet(other)))

    def positions(self) -> np.ndarray:
        """Return the positions of the twin's plant."""
        return np.array(self._plant.GetPositions(self._context))

    def touching(self, positions: np.ndarray) -> set[Pair]:
        """Return what is in each other at some positions of the plant."""
        self._plant.SetPositions(self._own_context, positions)
        query = self._query.Eval(self._scene_context)
        if not query.HasCollisions():
            return set()
        return {_pair(self._names[item.id_A], self._names[item.id_B]) for item in query.ComputePointPairPenetration()}


def _apart(
    plant: Any, instance: ModelInstanceIndex, names: dict[GeometryId, str]
) -> list[tuple[list[GeometryId], list[GeometryId]]]:
    """Return the shapes of each two groups of welded links of a robot that no joint holds together."""
    bodies: list[RigidBody] = [plant.get_body(index) for index in plant.GetBodyIndices(instance)]
    group = {body.index(): number for number, body in enumerate(bodies)}
    joints = [plant.get_joint(JointIndex(index)) for index in plant.GetJointIndices(instance)]
    joints = [joint for joint in joints if {joint.parent_body().index(), joint.child_body().index()} <= group.keys()]
    for joint in joints:
        if joint.type_name() == "weld":
            old, new = group[joint.child_body().index()], group[joint.parent_body().index()]
            group = {body: new if number == old else number for body, number in group.items()}
    held = {(group[joint.parent_body().index()], group[joint.child_body().index()]) for joint in joints}
    shapes: dict[int, list[GeometryId]] = {}
    for body in bodies:
        own = [geometry for geometry in plant.GetCollisionGeometriesForBody(body) if geometry in names]
        if own:
            shapes.setdefault(group[body.index()], []).extend(own)
    numbers = sorted(shapes)
    return [
        (shapes[one], shapes[other])
        for index, one in enumerate(numbers)
        for other in numbers[index + 1 :]
        if (one, other) not in held and (other, one) not in held
    ]


def _upward(info: Any) -> float:
    """Return the vertical part of the direction in which the second shape of a contact pushes the first one."""
    if hasattr(info, "nhat_BA_W"):
        return float(info.nhat_BA_W[2])
    faces = range(min(info.num_faces(), _MOST_FACES))
    normal = sum((info.area(face) * np.array(info.face_normal(face)) for face in faces), np.zeros(3))
    length = float(np.linalg.norm(normal))
    return float(normal[2]) / length if length > 0.0 else 0.0


def _place(info: Any) -> np.ndarray:
    """Return where two shapes touch (m)."""
    if hasattr(info, "nhat_BA_W"):
        return np.array((info.p_WCa + info.p_WCb) / 2)
    return np.array(info.centroid())


def _pair(one: str, other: str) -> Pair:
    return (one, other) if one <= other else (other, one)
