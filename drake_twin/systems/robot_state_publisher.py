"""The frames of all robots on ROS's ``/tf`` and ``/tf_static``."""

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import repeat
from operator import attrgetter
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue, Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.kinematics.joint_frames import JointFrames
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages.draft import Draft, Drafter, LaterDraft
from drake_twin.systems.no_message import empty_value, or_none
from drake_twin.systems.plant_reading import Reading
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

    Attributes:
        placed_by_others: Frames whose true poses are left out, since programs publish transforms to them.

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
        self._base_frames = [("world", robot.base_frame) for robot in robots if robot.base_frame]
        self.placed_by_others: set[str] = set()
        self._bases = [robot.layout for robot in robots if robot.base_frame]
        if not all(layout.has_moving_base for layout in self._bases):
            raise ValueError("a base that does not move is a static transform")
        self._static = _Transforms(
            [("", Joint(frame.child, "fixed", frame.parent, frame.child, frame.pose)) for frame in static_transforms]
        )
        self._state = self.DeclareVectorInputPort("state", size)
        self._odometry = [self.DeclareAbstractInputPort(name, empty_value()) for name in odometry]
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
        return self.DeclareAbstractOutputPort(name, empty_value, calc, prerequisites)

    def tf_drafter(self) -> Callable[[Reading], Draft]:
        """Return what drafts the messages of ``tf`` without the drives' transforms, which drives publish themselves.

        If nothing moves, it drafts nothing. It refers to this system, which must not keep it.
        """
        numbers = 7 * (len(self._bases) + len(self._moving.frames))
        if not numbers and not self._links:
            return lambda reading: LaterDraft(lambda: None)
        if not self._links:
            return Drafter(attrgetter("state"), self._numbers, self._message, numbers)

        def draft(reading: Reading) -> Draft:
            state, links = reading.state, self._links_in(self.GetMyContextFromRoot(reading.root_context))
            return LaterDraft(lambda: self._message(reading.time, self._numbers(state), (), links))

        return draft

    def _calc_tf(self, context: Context, output: AbstractValue) -> None:
        numbers = self._numbers(self._state.Eval(context))
        messages_of_drives = [or_none(port.Eval(context)) for port in self._odometry]
        of_drives = [item for message in messages_of_drives if message is not None for item in message.transforms]
        output.set_value(self._message(context.get_time(), numbers, of_drives, self._links_in(context)))

    def _links_in(self, context: Context) -> list[Any]:
        """Return the transforms of links, which do not follow from the state."""
        stamp = messages.time_message(context.get_time())
        return [_link_transform(stamp, link, port.Eval(context)) for port in self._poses for link in self._links]

    def _numbers(self, state: np.ndarray) -> np.ndarray:
        """Return the true poses of the bases, then the poses of the joints: x, y, z, qx, qy, qz, qw of each."""
        poses = np.empty((len(self._bases) + len(self._moving.frames), 7))
        for index, layout in enumerate(self._bases):
            qw, qx, qy, qz, x, y, z = layout.base_pose(state)
            poses[index] = x, y, z, qx, qy, qz, qw
        self._moving.fill(poses[len(self._bases) :], state[self._indices])
        return poses.ravel()

    def _message(
        self, time: float, numbers: np.ndarray, of_drives: Sequence[Any] = (), of_links: Sequence[Any] = ()
    ) -> Any:
        stamp = messages.time_message(time)
        poses = numbers.reshape(-1, 7)
        bases, joints = poses[: len(self._bases)], poses[len(self._bases) :]
        moving = _transforms(stamp, self._moving.frames, joints, self._moving.translations)
        own = _transforms(stamp, self._base_frames, bases)
        if self.placed_by_others:
            own = [transform for transform in own if transform.child_frame_id not in self.placed_by_others]
        transforms = [*own, *of_drives, *moving]
        return messages.TFMessage([*transforms, *of_links])

    def _calc_tf_static(self, context: Context, output: AbstractValue) -> None:
        stamp = messages.time_message(0.0)
        static = [_transforms(stamp, item.frames, item.poses()) for item in (self._static, self._fixed)]
        output.set_value(messages.TFMessage([transform for transforms in static for transform in transforms]))

    def _calc_robot_description(self, text: str, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.String(text))


class _Transforms:
    """The poses of joints, each with its frame prefix.

    Attributes:
        frames: The parent and the child frame of each.
    """

    def __init__(self, joints: Sequence[tuple[str, Joint]]):
        self._joints = JointFrames([joint for _, joint in joints])
        self.frames = [(prefix + joint.parent, prefix + joint.child) for prefix, joint in joints]
        self._at_zero = np.zeros(len(joints))
        self._xyz_at_zero = self._joints.xyz(self._at_zero)
        self._slides = bool(self._joints.moves_along.any())

    @cached_property
    def translations(self) -> list[Any]:
        """The translations (m) that do not change, as ``geometry_msgs/msg/Vector3``; None for the others."""
        moves, xyz = self._joints.moves_along, self._xyz_at_zero
        return [None if moves[index] else messages.Vector3(*xyz[index].tolist()) for index in range(len(self.frames))]

    def poses(self) -> np.ndarray:
        """Return x, y, z (m), qx, qy, qz, qw for joint positions of zero, shape (n, 7)."""
        poses = np.empty((len(self.frames), 7))
        self.fill(poses, self._at_zero)
        return poses

    def fill(self, poses: np.ndarray, positions: np.ndarray) -> None:
        """Write x, y, z (m), qx, qy, qz, qw for joint positions (rad or m) into an array of shape (n, 7)."""
        quaternions = self._joints.quaternions(positions)
        poses[:, :3] = self._joints.xyz(positions) if self._slides else self._xyz_at_zero
        poses[:, 3:6] = quaternions[:, 1:]
        poses[:, 6] = quaternions[:, 0]


def _transforms(
    stamp: Any, frames: Sequence[tuple[str, str]], poses: np.ndarray, translations: Iterable[Any] = repeat(None)
) -> list[Any]:
    """Return ``geometry_msgs/msg/TransformStamped`` messages of frames, parent and child, and their poses."""
    headers = {parent: messages.Header(stamp, parent) for parent in dict(frames)}
    stamped, transform = messages.TransformStamped, messages.Transform
    vector, rotation = messages.Vector3, messages.Quaternion
    return [
        stamped(headers[parent], child, transform(still or vector(x, y, z), rotation(qx, qy, qz, qw)))
        for (parent, child), (x, y, z, qx, qy, qz, qw), still in zip(frames, poses.tolist(), translations, strict=False)
    ]


def _link_transform(stamp: Any, link: LinkFrame, poses: Sequence[RigidTransform]) -> Any:
    X_PC = poses[link.parent_body].inverse() @ poses[link.child_body]
    w, x, y, z = X_PC.rotation().ToQuaternion().wxyz().tolist()
    transform = messages.Transform(messages.Vector3(*X_PC.translation().tolist()), messages.Quaternion(x, y, z, w))
    return messages.TransformStamped(messages.Header(stamp, link.parent), link.child, transform)
