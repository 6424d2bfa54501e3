"""The frames of all robots on ROS's ``/tf`` and ``/tf_static``."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue, Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.systems.joint_frames import JointFrames
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


@dataclass(frozen=True)
class FixedFrame:
    """A frame fixed in another one."""

    parent: str
    child: str
    pose: Pose


@dataclass(frozen=True)
class LinkFrame:
    """A link's frame in another link's, as in the plant.

    Attributes:
        parent: The parent frame.
        child: The child frame.
        parent_body: The index of the parent link's body in the plant.
        child_body: The index of the child link's body in the plant.
    """

    parent: str
    child: str
    parent_body: int
    child_body: int


@dataclass(frozen=True)
class RobotFrames:
    """A robot whose frames are published.

    Attributes:
        name: The robot's name.
        description: Its joints and links, and the text that it was read from.
        layout: The indices of its joints and its base in the plant's state.
        frame_prefix: The prefix of every link's name.
        base_frame: The frame of its root link, if its true pose in ``world`` is to be on ``tf``; else None.
    """

    name: str
    description: RobotDescription
    layout: StateLayout
    frame_prefix: str = ""
    base_frame: str = ""


class RobotStatePublisher(WitnesslessSystem):
    """Publish one transform for each joint: the child link in the parent link.

    Behaves for each robot as ``robot_state_publisher`` in ROS 2 Jazzy: moving joints on ``tf``, fixed ones on
    ``tf_static``, the frame prefix before every frame name, floating and planar joints skipped; and as
    ``static_transform_publisher`` for further frames. SDF's ball, universal and screw joints, which URDF does not have,
    are on ``tf`` as well. One system serves all robots, because all joints together take hardly longer than those of
    one robot.

    .. pydrake_system::

        name: RobotStatePublisher
        input_ports:
        - state
        - body_poses
        - <robot>/<controller>/tf_odometry
        output_ports:
        - tf
        - tf_static
        - <robot>/robot_description

    - ``state``: vector ``[q; v]`` of the plant (rad, rad/s, or m, m/s).
    - ``body_poses``: the plant's port of this name; only declared if there are ``links``.
    - ``<robot>/<controller>/tf_odometry``: ``tf2_msgs/msg/TFMessage`` or None, from the drives' controllers.
    - ``tf``: ``tf2_msgs/msg/TFMessage``: true base poses, odometry, then one transform for each revolute, continuous
      and prismatic joint, in the order of the robots, then ``links``; topic ``/tf``.
    - ``tf_static``: ``tf2_msgs/msg/TFMessage``: the static transforms, then one for each fixed joint; never changes;
      topic ``/tf_static``.
    - ``<robot>/robot_description``: ``std_msgs/msg/String`` with the URDF (or SDF) text; never changes.

    Args:
        robots: The robots.
        size: The size of ``state``.
        static_transforms: Further frames for ``tf_static``.
        odometry: The names of the ports for drives' transforms.
        links: The links whose joints do not have exactly one position.

    Raises:
        ValueError: If the pose of a fixed base is to be published.
    """

    def __init__(
        self,
        robots: Sequence[RobotFrames],
        size: int,
        static_transforms: Iterable[FixedFrame] = (),
        odometry: Iterable[str] = (),
        links: Sequence[LinkFrame] = (),
    ):
        super().__init__()
        moving, indices = [], []
        for robot in robots:
            joints = [joint for joint in robot.description.movable_joints if joint.name in robot.layout.positions]
            moving += [(robot.frame_prefix, joint) for joint in joints]
            indices += [robot.layout.positions[joint.name] for joint in joints]
        fixed = [(robot.frame_prefix, j) for robot in robots for j in robot.description.joints if j.type == "fixed"]
        self._moving, self._fixed = _Transforms(moving), _Transforms(fixed)
        self._indices = np.array(indices, dtype=int)
        self._bases = [(robot.base_frame, robot.layout) for robot in robots if robot.base_frame]
        if not all(layout.has_moving_base for _, layout in self._bases):
            raise ValueError("a base that does not move is a static transform")
        self._static = _Transforms(
            [("", Joint(frame.child, "fixed", frame.parent, frame.child, frame.pose)) for frame in static_transforms]
        )
        self._state = self.DeclareVectorInputPort("state", size)
        self._odometry = [self.DeclareAbstractInputPort(name, AbstractValue.Make(None)) for name in odometry]
        self._links = tuple(links)
        self._poses = []
        if links:
            self._poses = [self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())]
        ports = (self._state, *self._odometry, *self._poses)
        inputs = {self.input_port_ticket(port.get_index()) for port in ports}
        self._tf = self._declare_output("tf", weakly(self._calc_tf), {self.time_ticket(), *inputs})
        self._tf_static = self._declare_output("tf_static", weakly(self._calc_tf_static), {self.nothing_ticket()})
        for robot in robots:
            calc = weakly(self._calc_robot_description, robot.description.text)
            self._declare_output(f"{robot.name}/robot_description", calc, {self.nothing_ticket()})

    def get_state_input_port(self) -> InputPort:
        """Return the port ``state``."""
        return self._state

    def get_tf_output_port(self) -> OutputPort:
        """Return the port ``tf``."""
        return self._tf

    def get_tf_static_output_port(self) -> OutputPort:
        """Return the port ``tf_static``."""
        return self._tf_static

    def _declare_output(self, name: str, calc: Callable[..., None], prerequisites: set[Any]) -> OutputPort:
        return self.DeclareAbstractOutputPort(name, lambda: AbstractValue.Make(None), calc, prerequisites)

    def _calc_tf(self, context: Context, output: AbstractValue) -> None:
        state = self._state.Eval(context)
        stamp = messages.time_message(context.get_time())
        transforms = []
        if self._bases:
            header = messages.Header(stamp, "world")
            transforms = [_base_transform(header, frame, layout, state) for frame, layout in self._bases]
        for message in (port.Eval(context) for port in self._odometry):
            if message is not None:
                transforms += message.transforms
        transforms += self._moving.messages(state[self._indices], stamp)
        for poses in (port.Eval(context) for port in self._poses):
            transforms += [_link_transform(stamp, link, poses) for link in self._links]
        output.set_value(messages.TFMessage(transforms))

    def _calc_tf_static(self, context: Context, output: AbstractValue) -> None:
        stamp = messages.time_message(0.0)
        output.set_value(messages.TFMessage([*self._static.messages(None, stamp), *self._fixed.messages(None, stamp)]))

    def _calc_robot_description(self, text: str, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.String(text))


class _Transforms:
    """The ``geometry_msgs/msg/TransformStamped`` messages of joints, each with its frame prefix."""

    def __init__(self, joints: Sequence[tuple[str, Joint]]):
        self._frames = JointFrames([joint for _, joint in joints])
        self._parents = [prefix + joint.parent for prefix, joint in joints]
        self._children = [prefix + joint.child for prefix, joint in joints]
        self._at_zero = np.zeros(len(joints))
        self._moves = [bool(moves) for moves in self._frames.moves_along]
        self._translations: list[Any] | None = None  # transforms that no position changes are made once

    def messages(self, positions: np.ndarray | None, stamp: Any) -> list[Any]:
        """Return the transforms for joint positions (rad or m; None for all zero) at a time (s)."""
        positions = self._at_zero if positions is None else positions
        if self._translations is None:
            self._translations = [messages.Vector3(*xyz) for xyz in self._frames.xyz(self._at_zero).tolist()]
        translations = self._translations
        if any(self._moves):
            translations = [
                messages.Vector3(*xyz) if changes else constant
                for xyz, changes, constant in zip(
                    self._frames.xyz(positions).tolist(), self._moves, translations, strict=True
                )
            ]
        headers = {parent: messages.Header(stamp, parent) for parent in self._parents}
        stamped, transform, rotation = messages.TransformStamped, messages.Transform, messages.Quaternion
        return [
            stamped(headers[parent], child, transform(translation, rotation(x, y, z, w)))
            for parent, child, translation, (w, x, y, z) in zip(
                self._parents, self._children, translations, self._frames.quaternions(positions).tolist(), strict=True
            )
        ]


def _link_transform(stamp: Any, link: LinkFrame, poses: Sequence[RigidTransform]) -> Any:
    X_PC = poses[link.parent_body].inverse() @ poses[link.child_body]
    w, x, y, z = X_PC.rotation().ToQuaternion().wxyz().tolist()
    transform = messages.Transform(messages.Vector3(*X_PC.translation().tolist()), messages.Quaternion(x, y, z, w))
    return messages.TransformStamped(messages.Header(stamp, link.parent), link.child, transform)


def _base_transform(header: Any, frame: str, layout: StateLayout, state: np.ndarray) -> Any:
    w, x, y, z, *xyz = layout.base_state(state)[0].tolist()
    norm = sqrt(w * w + x * x + y * y + z * z)
    rotation = messages.Quaternion(x / norm, y / norm, z / norm, w / norm)
    return messages.TransformStamped(header, frame, messages.Transform(messages.Vector3(*xyz), rotation))
