"""Fixed joints that come and go: what their controllers ask for is done in the plant's context."""

from dataclasses import replace

import numpy as np
from pydrake.geometry import FilterId
from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from drake_twin.controllers.detachable_joint import Attachment, DetachableJoint
from drake_twin.dataclass import dataclass
from drake_twin.diagram.detachable_joints import JointInPlant
from drake_twin.diagram.twin_diagram import TwinDiagram


@dataclass
class _Joint:
    """A joint, its controller, and what was done last: the pose of its rods, and the filter of its shapes."""

    controller: DetachableJoint
    context: Context
    in_plant: JointInPlant | None
    pose: tuple[float, ...] | None = None
    filter: FilterId | None = None


class DetachableJoints:
    """The detachable joints of one diagram.

    All of their state is in their controllers' memory; the rods and the collision filters follow from it. As in
    Gazebo's engine, where what is attached becomes part of the other model, the two models do not touch.

    Args:
        built: The diagram.
        root: Its context.

    Attributes:
        is_empty: Whether the diagram lacks such joints.
    """

    def __init__(self, built: TwinDiagram, root: Context):
        self._built, self._root = built, root
        self._plant_context = built.plant.GetMyMutableContextFromRoot(root)
        places = {(joint.robot, joint.controller): joint for joint in built.detachable_joints}
        self._joints = [
            _Joint(item, item.GetMyMutableContextFromRoot(root), places.get((robot, name)))
            for robot, parts in built.parts.items()
            for name, item in parts.controllers.items()
            if isinstance(item, DetachableJoint)
        ]
        self.is_empty = not self._joints

    def attachments(self) -> dict[tuple[str, str], tuple[float, ...]]:
        """Return robot and controller of each joint → the child's pose in the parent's frame; empty if it is loose."""
        return {
            (joint.in_plant.robot, joint.in_plant.controller): joint.pose or ()
            for joint in self._joints
            if joint.in_plant is not None
        }

    def forget(self) -> None:
        """Know that the context has its default values."""
        for joint in self._joints:
            joint.pose = joint.filter = None

    def follow(self) -> None:
        """Attach and detach what the controllers ask for."""
        for joint in self._joints:
            memory = joint.controller.asked(joint.context)
            is_attached = memory.wanted and joint.in_plant is not None
            if is_attached != bool(memory.pose):
                pose = self._present_pose(joint) if is_attached else ()
                memory = replace(memory, pose=pose, since=self._root.get_time())
            self._put(joint, memory)

    def moved(self, entity: str, before: frozenset[str] = frozenset()) -> None:
        """Follow a robot or model that was put elsewhere.

        What is attached to it comes along where it can, as in Gazebo. Otherwise, and where it was attached itself, the
        joint keeps the pose that the two have now.

        Args:
            entity: Its name.
            before: Those that have moved already.
        """
        for joint in self._joints:
            memory = joint.controller.asked(joint.context)
            if not memory.pose or joint.in_plant is None:
                continue
            parent, child = (self._owner(body) for body in (joint.in_plant.parent, joint.in_plant.child))
            if entity == parent and child not in {parent, *before} and self._carry(joint.in_plant, memory):
                self.moved(child, before | {entity})
            elif entity in (parent, child):
                self._put(joint, replace(memory, pose=self._present_pose(joint)))

    def _carry(self, in_plant: JointInPlant, memory: Attachment) -> bool:
        """Move the child's model with the parent link, if it is free; return whether it is."""
        plant, context, child = self._built.plant, self._plant_context, in_plant.child
        bodies = [plant.get_body(index) for index in plant.GetBodyIndices(child.model_instance())]
        free = [body for body in bodies if body.is_floating_base_body() and body.has_quaternion_dofs()]
        if len(free) != 1:
            return False
        X_CR = plant.CalcRelativeTransform(context, child.body_frame(), free[0].body_frame())
        X_PR = RigidTransform(np.array(memory.pose).reshape(3, 4)) @ X_CR
        X_WP = plant.EvalBodyPoseInWorld(context, in_plant.parent)
        V_WP = plant.EvalBodySpatialVelocityInWorld(context, in_plant.parent)
        plant.SetFreeBodyPose(context, free[0], X_WP @ X_PR)
        plant.SetFreeBodySpatialVelocity(context, free[0], V_WP.Shift(X_WP.rotation() @ X_PR.translation()))
        return True

    def _put(self, joint: _Joint, memory: Attachment) -> None:
        if memory != joint.controller.sample(joint.context).memory:
            joint.controller.set_memory(joint.context, memory)
        if memory.pose == joint.pose or joint.in_plant is None:
            return
        joint.pose = memory.pose
        X_PC = RigidTransform(np.array(memory.pose).reshape(3, 4)) if memory.pose else None
        joint.filter = joint.in_plant.hold(self._built.plant, self._built.scene_graph, self._root, X_PC, joint.filter)

    def _present_pose(self, joint: _Joint) -> tuple[float, ...]:
        assert joint.in_plant is not None, "it is attached"
        frames = joint.in_plant.parent.body_frame(), joint.in_plant.child.body_frame()
        X_PC = self._built.plant.CalcRelativeTransform(self._plant_context, *frames)
        return tuple(X_PC.GetAsMatrix34().ravel().tolist())

    def _owner(self, body: RigidBody) -> str:
        return self._built.owners().get(body.model_instance(), "")
