"""Where a robot's base really is, as an odometry message."""

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, LeafSystem, OutputPort

from drake_twin import messages
from drake_twin.description.robot_description import Pose
from drake_twin.systems.frames import quaternion_from_rpy, rotated
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.weak_callback import weakly


class GroundTruthPublisher(LeafSystem):
    """Puts the true pose and velocity of a robot's root link into an ``Odometry`` message, without noise.

    Gazebo's OdometryPublisher and p3d plugins give the same. Covariances are zero.

    .. pydrake_system::

        name: GroundTruthPublisher
        input_ports:
        - state
        output_ports:
        - odom

    - ``state``: vector ``[q; v]`` of the model instance.
    - ``odom``: ``nav_msgs/msg/Odometry``; the pose (m, quaternion) in ``world``, the twist (m/s, rad/s) in the root
      link's own frame, as the message's definition asks; topic ``ground_truth/odom``.

    Args:
        base_frame: the root link's frame, with its prefix.
        layout: where the base stands in ``state``.
        fixed_pose: the root link's pose in the world when it is welded there.
    """

    def __init__(self, base_frame: str, layout: StateLayout, fixed_pose: Pose | None = None):
        super().__init__()
        if layout.has_moving_base == (fixed_pose is not None):
            raise ValueError("a base either moves or has a fixed pose")
        self._base_frame = base_frame
        self._layout = layout
        if fixed_pose is not None:
            (quaternion,) = quaternion_from_rpy(np.array([fixed_pose.rpy]))
            self._fixed_position = np.concatenate([quaternion, fixed_pose.xyz])
        self._state = self.DeclareVectorInputPort("state", layout.size)
        self._odom = self.DeclareAbstractOutputPort(
            "odom",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_odom),
            {self.time_ticket(), self.input_port_ticket(self._state.get_index())},
        )

    def get_state_input_port(self) -> InputPort:
        """The port ``state``."""
        return self._state

    def get_odom_output_port(self) -> OutputPort:
        """The port ``odom``."""
        return self._odom

    def _calc_odom(self, context: Context, output: AbstractValue) -> None:
        if self._layout.has_moving_base:
            position, velocity = self._layout.base_state(self._state.Eval(context))
        else:
            position, velocity = self._fixed_position, np.zeros(6)
        quaternion = position[:4] / np.linalg.norm(position[:4])
        to_base = quaternion * (1.0, -1.0, -1.0, -1.0)
        angular, linear = rotated(np.array([to_base, to_base]), velocity.reshape(2, 3)).tolist()
        qw, qx, qy, qz = quaternion.tolist()
        pose = messages.Pose(
            position=messages.Point(*position[4:7].tolist()), orientation=messages.Quaternion(x=qx, y=qy, z=qz, w=qw)
        )
        twist = messages.Twist(linear=messages.Vector3(*linear), angular=messages.Vector3(*angular))
        output.set_value(
            messages.Odometry(
                header=messages.header(context.get_time(), "world"),
                child_frame_id=self._base_frame,
                pose=messages.PoseWithCovariance(pose=pose, covariance=np.zeros(36)),
                twist=messages.TwistWithCovariance(twist=twist, covariance=np.zeros(36)),
            )
        )
