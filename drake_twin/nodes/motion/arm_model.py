"""Where a robot's links are at given joint positions, what they touch, and which positions place a link."""

from collections.abc import Callable, Mapping, Sequence
from math import inf, pi

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometryId, GeometrySet, Role, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.systems.framework import DiagramBuilder

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name, urdf_link_name
from drake_twin.diagram.plant import parse_robot
from drake_twin.planning.robot_plan import RobotPlan

_STEPS = 200  # of a search for positions
_PROGRESS, _STALLED = 0.99, 15  # the error has to fall below so much of the least one within so many steps
_DAMPING = 1e-3  # of its least squares
_LONGEST_STEP = 0.3  # rad or m, of a joint


@dataclass(frozen=True)
class Body:
    """A shape of an object in a planning scene.

    Attributes:
        name: The object's name.
        shape: Its shape.
        pose: Its pose in the link that it is attached to, or in the robot's root link.
        link: The link that it is attached to; empty for an object of the world.
        touching: Links that it may touch.
    """

    name: str
    shape: Shape
    pose: RigidTransform
    link: str = ""
    touching: tuple[str, ...] = ()


class ArmModel:
    """Computes poses, contacts and Jacobians of a robot whose root link stands still.

    Args:
        plan: The robot.
        bodies: Objects around it, and attached to it.
        may_touch: Whether two of its links and the objects, by their names, may touch each other.

    Attributes:
        joints: The movable joints that follow no other, by their names.
        lower: Their lower limits (rad or m), shape (n,); -inf without one.
        upper: Their upper limits (rad or m), shape (n,).
    """

    def __init__(
        self, plan: RobotPlan, bodies: Sequence[Body] = (), may_touch: Callable[[str, str], bool] = lambda *_: False
    ):
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 1e-3)
        (instance,) = parse_robot(plant, plan)
        root = plant.GetBodyByName(plan.model.root_body, instance)
        plant.WeldFrames(plant.world_frame(), root.body_frame())
        names: dict[GeometryId, str] = {}
        inspector = scene_graph.model_inspector()
        for index in plant.GetBodyIndices(instance):
            body = plant.get_body(index)
            # Not the plant's list: pydrake's ids of it would end with the next geometry of the body.
            for geometry in inspector.GetGeometries(plant.GetBodyFrameIdOrThrow(index), Role.kProximity):
                names[geometry] = urdf_link_name(body.name())
        self._own = len(names)
        for number, item in enumerate(bodies):
            body = plant.GetBodyByName(drake_link_name(item.link), instance) if item.link else plant.world_body()
            label = f"{item.name} {number}"
            names[plant.RegisterCollisionGeometry(body, item.pose, item.shape, label, CoulombFriction())] = item.name
        plant.Finalize()
        followers = [joint for joint in plan.description.movable_joints if joint.mimic is not None]
        free = [joint for joint in plan.description.movable_joints if joint.mimic is None]
        self._plant, self._scene_graph, self._names = plant, scene_graph, names
        self._places = {
            joint.name: plant.GetJointByName(joint.name, instance).position_start() for joint in (*free, *followers)
        }
        self._followers = tuple(followers)
        self._instance = instance
        self.joints = tuple(joint.name for joint in free)
        turns = [joint.type == "continuous" for joint in free]
        self.lower = np.array([-inf if turn else joint.limits.lower for joint, turn in zip(free, turns, strict=True)])
        self.upper = np.array([inf if turn else joint.limits.upper for joint, turn in zip(free, turns, strict=True)])
        self._filter(plan, bodies, may_touch)
        self._diagram = builder.Build()
        self._root_context = self._diagram.CreateDefaultContext()
        self._context = plant.GetMyMutableContextFromRoot(self._root_context)
        self._scene_context = scene_graph.GetMyContextFromRoot(self._root_context)

    def _filter(self, plan: RobotPlan, bodies: Sequence[Body], may_touch: Callable[[str, str], bool]) -> None:
        """Look at all pairs but links that a joint joins, and those that may touch."""
        by_name: dict[str, list[GeometryId]] = {}
        for geometry, name in self._names.items():
            by_name.setdefault(name, []).append(geometry)
        joined = {frozenset((joint.parent, joint.child)) for joint in plan.description.joints}
        joined |= {frozenset((item.name, link)) for item in bodies if item.link for link in (item.link, *item.touching)}
        of_world = {item.name for item in bodies if not item.link}
        filters = self._scene_graph.collision_filter_manager()
        filters.Apply(CollisionFilterDeclaration().AllowWithin(GeometrySet(list(self._names))))
        for item in by_name.values():
            filters.Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(item)))
        for one in by_name:
            for other in by_name:
                both_stand = one in of_world and other in of_world
                if one < other and (both_stand or frozenset((one, other)) in joined or may_touch(one, other)):
                    sets = GeometrySet(by_name[one]), GeometrySet(by_name[other])
                    filters.Apply(CollisionFilterDeclaration().ExcludeBetween(*sets))

    @property
    def names(self) -> frozenset[str]:
        """The names of the links and objects that have collision shapes."""
        return frozenset(self._names.values())

    def has_link(self, name: str) -> bool:
        """Tell whether the robot has a link."""
        return bool(self._plant.HasBodyNamed(drake_link_name(name), self._instance))

    def indices(self, joints: Sequence[str]) -> list[int]:
        """Return the places of joints in `joints`."""
        return [self.joints.index(name) for name in joints]

    def pose(self, positions: np.ndarray, link: str) -> RigidTransform:
        """Return a link's pose in the root link.

        Args:
            positions: Of all `joints` (rad or m), shape (n,).
            link: The link's name.
        """
        self._set(positions)
        body = self._plant.GetBodyByName(drake_link_name(link), self._instance)
        return self._plant.EvalBodyPoseInWorld(self._context, body)

    def touching(self, positions: np.ndarray) -> tuple[str, str] | None:
        """Return two links or objects that touch each other; None if none do."""
        self._set(positions)
        query = self._scene_graph.get_query_output_port().Eval(self._scene_context)
        if not query.HasCollisions():
            return None
        for pair in query.ComputePointPairPenetration():
            return self._names.get(pair.id_A, "?"), self._names.get(pair.id_B, "?")
        return None

    def solve(
        self,
        error: Callable[["ArmModel", np.ndarray], np.ndarray],
        start: np.ndarray,
        joints: Sequence[int],
    ) -> np.ndarray | None:
        """Return positions near given ones at which an error vanishes, by damped least squares; None without any.

        Args:
            error: Returns the error, shape (m,), whose elements have to be within ±1 at last, for positions.
            start: Positions of all `joints` (rad or m), shape (n,), to begin with.
            joints: The places of the joints that may move.
        """
        positions: np.ndarray = np.clip(start, self.lower, self.upper)
        columns = list(joints)
        best, stalled = inf, 0
        for _ in range(_STEPS):
            residual = error(self, positions)
            if not residual.size or np.abs(residual).max() <= 1.0:
                return positions
            size = float(np.linalg.norm(residual))
            stalled = 0 if size < _PROGRESS * best else stalled + 1
            best = min(best, size)
            if stalled > _STALLED:
                return None
            jacobian = np.empty((residual.size, len(columns)))
            for place, column in enumerate(columns):
                moved = positions.copy()
                moved[column] += 1e-6
                jacobian[:, place] = (error(self, moved) - residual) / 1e-6
            scale = _DAMPING * np.abs(jacobian).max() or _DAMPING
            stacked = np.vstack([jacobian, scale * np.eye(len(columns))])
            step = np.linalg.lstsq(stacked, np.concatenate([-residual, np.zeros(len(columns))]), rcond=None)[0]
            step *= min(1.0, _LONGEST_STEP / max(np.abs(step).max(), 1e-12))
            positions[columns] += step
            positions = np.clip(positions, self.lower, self.upper)
            if np.abs(step).max() < 1e-9:
                return None
        return None

    def random(self, sampler: np.random.Generator, joints: Sequence[int], near: np.ndarray) -> np.ndarray:
        """Return random positions within the limits; those without limits turn up to half a turn to each side."""
        positions = near.copy()
        for index in joints:
            low, high = max(self.lower[index], -pi), min(self.upper[index], pi)
            positions[index] = sampler.uniform(low, high)
        return positions

    def with_followers(self, positions: np.ndarray) -> dict[str, float]:
        """Return the positions of all joints, those that follow others as well."""
        found = dict(zip(self.joints, map(float, positions), strict=True))
        for joint in self._followers:
            if joint.mimic is not None:
                found[joint.name] = joint.mimic.multiplier * found.get(joint.mimic.joint, 0.0) + joint.mimic.offset
        return found

    def from_names(self, values: Mapping[str, float], base: np.ndarray) -> np.ndarray:
        """Return positions with some joints' replaced; names that are not of `joints` are ignored."""
        positions = base.copy()
        for index, name in enumerate(self.joints):
            if name in values:
                positions[index] = values[name]
        return positions

    def _set(self, positions: np.ndarray) -> None:
        all_positions = self._plant.GetPositions(self._context)
        for name, value in self.with_followers(positions).items():
            all_positions[self._places[name]] = value
        self._plant.SetPositions(self._context, all_positions)
