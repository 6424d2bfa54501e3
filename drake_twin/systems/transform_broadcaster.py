"""All frames of all robots on one port, as they meet on ROS's ``/tf`` and ``/tf_static``."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, LeafSystem, OutputPort

from drake_twin import messages
from drake_twin.description.robot_description import Pose
from drake_twin.systems.frames import quaternion_from_rpy, transform_messages
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True)
class FixedFrame:
    """A frame fixed in another one."""

    parent: str
    child: str
    pose: Pose


class TransformBroadcaster(LeafSystem):
    """Gathers the robots' transforms, their true base poses and the static transforms.

    .. pydrake_system::

        name: TransformBroadcaster
        input_ports:
        - <robot>/tf
        - <robot>/tf_static
        - <robot>/ground_truth/odom
        - <robot>/<controller>/tf_odometry
        output_ports:
        - tf
        - tf_static

    - ``<robot>/tf``, ``<robot>/tf_static``: ``tf2_msgs/msg/TFMessage``, one port each for every robot.
    - ``<robot>/ground_truth/odom``: ``nav_msgs/msg/Odometry``, for the robots whose base frame nobody else publishes.
    - ``<robot>/<controller>/tf_odometry``: ``tf2_msgs/msg/TFMessage``, or ``None``, from the drives' controllers.
    - ``tf``: ``tf2_msgs/msg/TFMessage``: the robots' moving frames, in the order of the robots; topic ``/tf``.
    - ``tf_static``: ``tf2_msgs/msg/TFMessage``: all frames that never move; topic ``/tf_static``.

    Args:
        robots: the robots' names.
        moving_bases: the robots among them whose true base pose is put on ``tf``.
        static_transforms: further frames for ``tf_static``.
        odometry: the names of the ports for drives' transforms.
    """

    def __init__(
        self,
        robots: Iterable[str],
        moving_bases: Iterable[str] = (),
        static_transforms: Iterable[FixedFrame] = (),
        odometry: Iterable[str] = (),
    ):
        super().__init__()
        self._static_transforms = tuple(static_transforms)
        moving_bases = set(moving_bases)
        self._tf_inputs = []
        self._tf_static_inputs = []
        self._odom_inputs = []
        for robot in robots:
            self._tf_inputs.append(self._declare_input(f"{robot}/tf"))
            self._tf_static_inputs.append(self._declare_input(f"{robot}/tf_static"))
            if robot in moving_bases:
                self._odom_inputs.append(self._declare_input(f"{robot}/ground_truth/odom"))
        self._tf_inputs[:0] = [self._declare_input(name) for name in odometry]
        self._tf = self.DeclareAbstractOutputPort(
            "tf",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_tf),
            {self.input_port_ticket(port.get_index()) for port in (*self._tf_inputs, *self._odom_inputs)}
            or {self.nothing_ticket()},
        )
        self._tf_static = self.DeclareAbstractOutputPort(
            "tf_static",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_tf_static),
            {self.input_port_ticket(port.get_index()) for port in self._tf_static_inputs} or {self.nothing_ticket()},
        )

    def get_tf_output_port(self) -> OutputPort:
        """The port ``tf``."""
        return self._tf

    def get_tf_static_output_port(self) -> OutputPort:
        """The port ``tf_static``."""
        return self._tf_static

    def _declare_input(self, name: str) -> InputPort:
        return self.DeclareAbstractInputPort(name, AbstractValue.Make(None))

    def _calc_tf(self, context: Context, output: AbstractValue) -> None:
        transforms = [_base_transform(port.Eval(context)) for port in self._odom_inputs]
        for message in (port.Eval(context) for port in self._tf_inputs):
            if message is not None:
                transforms.extend(message.transforms)
        output.set_value(messages.TFMessage(transforms=transforms))

    def _calc_tf_static(self, context: Context, output: AbstractValue) -> None:
        frames = self._static_transforms
        transforms = transform_messages(
            [frame.parent for frame in frames],
            [frame.child for frame in frames],
            np.array([frame.pose.xyz for frame in frames]).reshape(-1, 3),
            quaternion_from_rpy(np.array([frame.pose.rpy for frame in frames]).reshape(-1, 3)),
            0.0,
        )
        for port in self._tf_static_inputs:
            transforms.extend(port.Eval(context).transforms)
        output.set_value(messages.TFMessage(transforms=transforms))


def _base_transform(odometry: Any) -> Any:
    pose = odometry.pose.pose
    return messages.TransformStamped(
        header=odometry.header,
        child_frame_id=odometry.child_frame_id,
        transform=messages.Transform(
            translation=messages.Vector3(x=pose.position.x, y=pose.position.y, z=pose.position.z),
            rotation=pose.orientation,
        ),
    )
