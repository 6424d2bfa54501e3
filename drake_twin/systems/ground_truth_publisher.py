"""The true poses of the robots' bases, as odometry messages."""

from collections.abc import Sequence
from functools import partial
from operator import attrgetter
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.common.value import AbstractValue
from pydrake.math import RotationMatrix
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Pose
from drake_twin.kinematics.rotations import quaternion_from_rpy
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages.draft import Drafter
from drake_twin.systems.no_message import empty_value
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem

_NO_COVARIANCE = np.zeros(36)
_PARTS = (0, 3), (3, 7), (7, 10), (10, 13)
_NO_COVARIANCE.setflags(write=False)


@dataclass(frozen=True)
class RobotBase:
    """A robot's root link.

    Attributes:
        robot: The robot.
        frame: The root link's frame, with its prefix.
        layout: The indices of the base in the plant's state.
        fixed_pose: The root link's pose in the world, if it is welded there.

    Raises:
        ValueError: If the base both moves and has a fixed pose, or neither.
    """

    robot: str
    frame: str
    layout: StateLayout
    fixed_pose: Pose | None = None

    def __post_init__(self) -> None:
        if self.layout.has_moving_base == (self.fixed_pose is not None):
            raise ValueError("a base either moves or has a fixed pose")

    def position_and_velocity(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the pose and velocity of `StateLayout.base_state`, for a welded base as well."""
        if self.fixed_pose is None:
            return self.layout.base_state(state)
        (quaternion,) = quaternion_from_rpy(np.array([self.fixed_pose.rpy]))
        return np.concatenate([quaternion, self.fixed_pose.xyz]), np.zeros(6)


class GroundTruthPublisher(WitnesslessSystem):
    """Publish the true pose and velocity of each robot's root link as an ``Odometry`` message, without noise.

    Gazebo's OdometryPublisher and p3d plugins do the same. Covariances are zero.

    .. pydrake_system::

        name: GroundTruthPublisher
        input_ports:
        - state
        output_ports:
        - <robot>/ground_truth/odom

    - ``state``: vector ``[q; v]`` of the plant.
    - ``<robot>/ground_truth/odom``: ``nav_msgs/msg/Odometry``; the pose (m, quaternion) in ``world``, the twist (m/s,
      rad/s) in the root link's own frame, as the message's definition requires.

    Args:
        bases: The robots' root links.
        size: The size of ``state``.
    """

    def __init__(self, bases: Sequence[RobotBase], size: int):
        super().__init__()
        self._state = self.DeclareVectorInputPort("state", size)
        prerequisites = {self.time_ticket(), self.input_port_ticket(self._state.get_index())}
        for base in bases:
            self.DeclareAbstractOutputPort(
                f"{base.robot}/ground_truth/odom",
                empty_value,
                weakly(self._calc_odom, base),
                prerequisites,
            )

    def get_state_input_port(self) -> InputPort:
        """Return the port ``state``."""
        return self._state

    def get_odom_output_port(self, robot: str) -> OutputPort:
        """Return the port ``<robot>/ground_truth/odom``."""
        return self.GetOutputPort(f"{robot}/ground_truth/odom")

    def drafter(self, base: RobotBase) -> Drafter:
        """Return what drafts the messages of a robot."""

        def numbers(state: np.ndarray) -> np.ndarray:
            return _numbers(*base.position_and_velocity(state))

        return Drafter(attrgetter("state"), numbers, partial(_odometry, base), 13)

    def _calc_odom(self, base: RobotBase, context: Context, output: AbstractValue) -> None:
        position, velocity = base.position_and_velocity(self._state.Eval(context))
        output.set_value(_odometry(base, context.get_time(), _numbers(position, velocity)))


def _numbers(position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return position (m), quaternion (w, x, y, z), and in the link's own axes angular and linear velocity."""
    quaternion = position[:4]
    R_BW = RotationMatrix(Quaternion(quaternion)).inverse()
    velocities = R_BW.multiply(velocity.reshape(2, 3).T).T.ravel()
    return np.concatenate((position[4:7], quaternion, velocities))


def _odometry(base: RobotBase, time: float, numbers: np.ndarray) -> Any:
    position, (w, x, y, z), angular, linear = (numbers[start:end].tolist() for start, end in _PARTS)
    pose = messages.Pose(position=messages.Point(*position), orientation=messages.Quaternion(x=x, y=y, z=z, w=w))
    twist = messages.Twist(linear=messages.Vector3(*linear), angular=messages.Vector3(*angular))
    return messages.Odometry(
        header=messages.header(time, "world"),
        child_frame_id=base.frame,
        pose=messages.PoseWithCovariance(pose=pose, covariance=_NO_COVARIANCE),
        twist=messages.TwistWithCovariance(twist=twist, covariance=_NO_COVARIANCE),
    )
