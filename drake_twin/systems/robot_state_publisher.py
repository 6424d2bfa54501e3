"""A robot's link frames from its joint positions, as robot_state_publisher publishes them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, LeafSystem, OutputPort

from drake_twin import messages
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.systems.frames import quaternion_from_rpy, quaternion_product, rotated, transform_messages
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.weak_callback import weakly


class RobotStatePublisher(LeafSystem):
    """Turns joint positions into one transform for each joint: the child link in the parent link.

    Behaves as ``robot_state_publisher`` in ROS 2 Jazzy: moving joints on ``tf``, fixed ones on ``tf_static``, the frame
    prefix put before every frame name, floating and planar joints skipped.

    .. pydrake_system::

        name: RobotStatePublisher
        input_ports:
        - state
        output_ports:
        - tf
        - tf_static
        - robot_description

    - ``state``: vector ``[q; v]`` of the model instance (rad, rad/s, or m, m/s).
    - ``tf``: ``tf2_msgs/msg/TFMessage`` with one transform for each revolute, continuous and prismatic joint.
    - ``tf_static``: ``tf2_msgs/msg/TFMessage`` with one transform for each fixed joint; never changes.
    - ``robot_description``: ``std_msgs/msg/String`` with the URDF (or SDF) text; never changes.

    Args:
        description: the robot.
        layout: where the joints stand in ``state``.
        frame_prefix: put before every link's name.
    """

    def __init__(self, description: RobotDescription, layout: StateLayout, frame_prefix: str = ""):
        super().__init__()
        self._text = description.text
        self._moving = _JointFrames(
            [joint for joint in description.movable_joints if joint.name in layout.positions], frame_prefix
        )
        self._fixed = _JointFrames([joint for joint in description.joints if joint.type == "fixed"], frame_prefix)
        self._position_indices = np.array([layout.positions[name] for name in self._moving.names], dtype=int)
        self._state = self.DeclareVectorInputPort("state", layout.size)
        self._tf = self.DeclareAbstractOutputPort(
            "tf",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_tf),
            {self.time_ticket(), self.input_port_ticket(self._state.get_index())},
        )
        self._tf_static = self.DeclareAbstractOutputPort(
            "tf_static", lambda: AbstractValue.Make(None), weakly(self._calc_tf_static), {self.nothing_ticket()}
        )
        self._robot_description = self.DeclareAbstractOutputPort(
            "robot_description",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_robot_description),
            {self.nothing_ticket()},
        )

    def get_state_input_port(self) -> InputPort:
        """The port ``state``."""
        return self._state

    def get_tf_output_port(self) -> OutputPort:
        """The port ``tf``."""
        return self._tf

    def get_tf_static_output_port(self) -> OutputPort:
        """The port ``tf_static``."""
        return self._tf_static

    def get_robot_description_output_port(self) -> OutputPort:
        """The port ``robot_description``."""
        return self._robot_description

    def _calc_tf(self, context: Context, output: AbstractValue) -> None:
        positions = self._state.Eval(context)[self._position_indices]
        output.set_value(self._moving.message(positions, context.get_time()))

    def _calc_tf_static(self, context: Context, output: AbstractValue) -> None:
        output.set_value(self._fixed.message(np.zeros(len(self._fixed.names)), 0.0))

    def _calc_robot_description(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.String(data=self._text))


class _JointFrames:
    """The transforms of a list of joints, computed for all of them at once."""

    def __init__(self, joints: Sequence[Joint], frame_prefix: str):
        self.names = tuple(joint.name for joint in joints)
        self._parents = [frame_prefix + joint.parent for joint in joints]
        self._children = [frame_prefix + joint.child for joint in joints]
        self._xyz = np.array([joint.origin.xyz for joint in joints]).reshape(-1, 3)
        self._quaternions = quaternion_from_rpy(np.array([joint.origin.rpy for joint in joints]).reshape(-1, 3))
        axes = np.array([joint.axis for joint in joints]).reshape(-1, 3)
        slides = np.array([[joint.type == "prismatic"] for joint in joints], dtype=bool).reshape(-1, 1)
        self._sliding_axes = np.where(slides, axes, 0.0)
        self._turning_axes = np.where(slides, 0.0, axes)
        self._child_xyz = np.array([joint.child_origin.xyz for joint in joints]).reshape(-1, 3)
        self._child_quaternions = quaternion_from_rpy(
            np.array([joint.child_origin.rpy for joint in joints]).reshape(-1, 3)
        )

    def message(self, positions: np.ndarray, time: float) -> Any:
        """A ``TFMessage`` for joint positions (rad or m) at a simulation time (s)."""
        half = 0.5 * positions[:, None]
        turn = np.hstack([np.cos(half), np.sin(half) * self._turning_axes])
        turn[~self._turning_axes.any(axis=1)] = (1.0, 0.0, 0.0, 0.0)
        joint_xyz = self._xyz + rotated(self._quaternions, positions[:, None] * self._sliding_axes)
        joint_quaternions = quaternion_product(self._quaternions, turn)
        xyz = joint_xyz + rotated(joint_quaternions, self._child_xyz)
        quaternions = quaternion_product(joint_quaternions, self._child_quaternions)
        return messages.TFMessage(transforms=transform_messages(self._parents, self._children, xyz, quaternions, time))
