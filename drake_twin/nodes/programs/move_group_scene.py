"""The objects around a robot, those that it holds, and what may touch what.

Source: moveit_core (ros2), planning_scene/src/planning_scene.cpp and collision_detection/src/collision_matrix.cpp.
"""

from collections.abc import Callable, Iterable, Iterator
from copy import deepcopy
from typing import Any

import numpy as np
from moveit_msgs.msg import (
    AllowedCollisionEntry,
    AllowedCollisionMatrix,
    AttachedCollisionObject,
    CollisionObject,
    PlanningScene,
)
from pydrake.geometry import Box, Convex, Cylinder, Shape, Sphere
from pydrake.math import RigidTransform

from drake_twin.nodes.motion.arm_model import Body
from drake_twin.nodes.motion.constraints import fill_pose, to_pose

_BOX, _SPHERE, _CYLINDER, _CONE = 1, 2, 3, 4  # SolidPrimitive.type
_SIDES = 32  # of a cone's circle

Place = Callable[[str], RigidTransform]  # a frame's name → its pose in the robot's root link


class Scene:
    """What a robot has to keep away from.

    Args:
        root: The robot's root link, in which objects are kept.
        touching: Pairs of links that may touch.

    Attributes:
        version: A number that grows with each change.
    """

    def __init__(self, root: str, touching: Iterable[frozenset[str]]):
        self.version = 0
        self._root = root
        self._allowed = {pair: True for pair in touching if len(pair) == 2}
        self._defaults: dict[str, bool] = {}
        self._objects: dict[str, CollisionObject] = {}
        self._attached: dict[str, AttachedCollisionObject] = {}

    def may_touch(self, one: str, other: str) -> bool:
        """Tell whether two links or objects may touch each other."""
        if (known := self._allowed.get(frozenset((one, other)))) is not None:
            return known
        defaults = [self._defaults[name] for name in (one, other) if name in self._defaults]
        return bool(defaults) and all(defaults)

    def bodies(self) -> Iterator[Body]:
        """Yield the shapes of all objects.

        Raises:
            ValueError: If a shape is not supported.
        """
        for name, item in self._objects.items():
            for shape, pose in _shapes(item):
                yield Body(name, shape, to_pose(item.pose) @ pose)
        for name, held in self._attached.items():
            for shape, pose in _shapes(held.object):
                yield Body(name, shape, to_pose(held.object.pose) @ pose, held.link_name, tuple(held.touch_links))

    def process(self, item: CollisionObject, place: Place) -> str:
        """Add, move or remove an object of the world.

        Returns:
            What is wrong with it; empty if it is processed.
        """
        operation = item.operation
        if operation == CollisionObject.REMOVE:
            if item.id and item.id not in self._objects:
                return f"Tried to remove world object '{item.id}', but it does not exist in this scene."
            for name in [item.id] if item.id else list(self._objects):
                del self._objects[name]
        elif operation in (CollisionObject.APPEND, CollisionObject.MOVE) and item.id in self._objects:
            known = self._objects[item.id]
            pose = place(item.header.frame_id) @ to_pose(item.pose)
            if operation == CollisionObject.MOVE:
                fill_pose(known.pose, pose)
            else:
                self._append(known, item, to_pose(known.pose).inverse() @ pose)
        elif operation == CollisionObject.MOVE:
            return f"World object '{item.id}' does not exist. Cannot move."
        elif not (item.primitives or item.meshes):
            return f"There are no shapes specified in the collision object message '{item.id}'"
        else:
            self._objects[item.id] = self._in(item, self._root, place)
        self.version += 1
        return ""

    def attach(self, item: AttachedCollisionObject, place: Place) -> str:
        """Attach an object to a link, or put one that is attached back into the world; see `process`."""
        name = item.object.id
        if item.object.operation == CollisionObject.REMOVE:
            names = [name] if name else [key for key, held in self._attached.items() if _is_on(held, item.link_name)]
            if name and name not in self._attached:
                return f"No object '{name}' is attached"
            for key in names:
                held = self._attached.pop(key)
                self._objects[key] = self._in(held.object, self._root, place)
        else:
            known = item.object if item.object.primitives or item.object.meshes else self._objects.get(name)
            if known is None:
                return f"Attempting to attach object '{name}' which does not exist in the collision world"
            self._objects.pop(name, None)
            held = deepcopy(item)
            held.object = self._in(known, item.link_name, place)
            self._attached[name] = held
        self.version += 1
        return ""

    def apply(self, scene: PlanningScene, place: Place) -> list[str]:
        """Apply a scene, or a difference to it; return what is wrong with its parts."""
        if not scene.is_diff:
            self._objects.clear()
            self._attached.clear()
        elif scene.robot_state.attached_collision_objects and not scene.robot_state.is_diff:
            self._attached.clear()
        matrix = scene.allowed_collision_matrix
        if matrix.entry_names or not scene.is_diff:
            self._allowed = {
                frozenset((one, other)): bool(allowed)
                for one, entry in zip(matrix.entry_names, matrix.entry_values, strict=False)
                for other, allowed in zip(matrix.entry_names, entry.enabled, strict=False)
                if one != other
            }
            pairs = zip(matrix.default_entry_names, matrix.default_entry_values, strict=False)
            self._defaults = {name: bool(value) for name, value in pairs}
        wrong = [self.process(item, place) for item in scene.world.collision_objects]
        wrong += [self.attach(item, place) for item in scene.robot_state.attached_collision_objects]
        self.version += 1
        return [text for text in wrong if text]

    def fill(self, message: PlanningScene, links: Iterable[str]) -> None:
        """Set a message's objects and its matrix of what may touch what."""
        message.world.collision_objects = [deepcopy(item) for item in self._objects.values()]
        message.robot_state.attached_collision_objects = [deepcopy(item) for item in self._attached.values()]
        names = sorted({*links, *(name for pair in self._allowed for name in pair)})
        message.allowed_collision_matrix = AllowedCollisionMatrix(
            entry_names=names,
            entry_values=[
                AllowedCollisionEntry(enabled=[self._allowed.get(frozenset((one, other)), False) for other in names])
                for one in names
            ],
            default_entry_names=list(self._defaults),
            default_entry_values=list(self._defaults.values()),
        )

    def _in(self, item: CollisionObject, frame: str, place: Place) -> CollisionObject:
        found = deepcopy(item)
        pose = place(frame).inverse() @ place(item.header.frame_id) @ to_pose(item.pose)
        found.header.frame_id = frame
        fill_pose(found.pose, pose)
        found.operation = CollisionObject.ADD
        return found

    def _append(self, known: CollisionObject, item: CollisionObject, offset: RigidTransform) -> None:
        for shapes, poses in (("primitives", "primitive_poses"), ("meshes", "mesh_poses")):
            for shape, pose in zip(getattr(item, shapes), getattr(item, poses), strict=False):
                moved = deepcopy(pose)
                fill_pose(moved, offset @ to_pose(pose))
                getattr(known, shapes).append(shape)
                getattr(known, poses).append(moved)


def _is_on(held: AttachedCollisionObject, link: str) -> bool:
    return not link or held.link_name == link


def _shapes(item: CollisionObject) -> Iterator[tuple[Shape, RigidTransform]]:
    if item.planes:
        raise ValueError(f"object '{item.id}': planes are not supported")
    poses = [*map(to_pose, item.primitive_poses)]
    for number, primitive in enumerate(item.primitives):
        yield _shape(item.id, primitive), poses[number] if number < len(poses) else RigidTransform()
    poses = [*map(to_pose, item.mesh_poses)]
    for number, mesh in enumerate(item.meshes):
        points = np.array([(point.x, point.y, point.z) for point in mesh.vertices]).T
        yield Convex(points, item.id or "mesh"), poses[number] if number < len(poses) else RigidTransform()


def _shape(name: str, primitive: Any) -> Shape:
    size = [float(value) for value in primitive.dimensions]
    if primitive.type == _BOX and len(size) == 3:
        return Box(*size)
    if primitive.type == _SPHERE and size:
        return Sphere(size[0])
    if primitive.type == _CYLINDER and len(size) == 2:
        return Cylinder(size[1], size[0])
    if primitive.type == _CONE and len(size) == 2:
        angles = np.linspace(0.0, 2 * np.pi, _SIDES, endpoint=False)
        circle = np.array([size[1] * np.cos(angles), size[1] * np.sin(angles), np.full(_SIDES, -0.5 * size[0])])
        return Convex(np.hstack([circle, [[0.0], [0.0], [0.5 * size[0]]]]), name or "cone")
    raise ValueError(f"object '{name}': a primitive of type {primitive.type} with {len(size)} dimensions")
