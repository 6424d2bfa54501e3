"""The pose of a link as messages and as a transform, as ros2_controllers' pose_broadcaster publishes it."""

from dataclasses import field
from math import fsum, isfinite
from typing import Any, ClassVar

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import transform_message
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.sensors.pose_sensor import MeasuredPose, PoseSensor

_INTERFACES = (*(f"position.{axis}" for axis in "xyz"), *(f"orientation.{axis}" for axis in "xyzw"))
_LENGTH_TOLERANCE = 0.01  # of a quaternion's squared length: upstream's 10e-3


@dataclass(frozen=True)
class PoseTransform:
    """The transform of a pose.

    Attributes:
        enable: Whether the pose is published on ``/tf`` as well.
        child_frame_id: The transform's child frame; empty for ``pose_name``.
        publish_rate: The highest rate of the transforms (Hz); deprecated in Jazzy.
    """

    enable: bool = True
    child_frame_id: str = ""
    publish_rate: float = field(
        default=0.0, metadata={"lower": 0.0, "unsupported": "the transform is in each message on /tf"}
    )


@dataclass(frozen=True)
class PoseBroadcasterParameters:
    """Parameters of ``pose_broadcaster/PoseBroadcaster``.

    Attributes:
        frame_id: The frame in which the pose is.
        pose_name: The sensor in ``<ros2_control>``.
        tf: The transform of the pose.
    """

    frame_id: str = field(metadata={"not_empty": True})
    pose_name: str = field(metadata={"not_empty": True})
    tf: PoseTransform = PoseTransform()


@controller("pose_broadcaster/PoseBroadcaster")
class PoseBroadcaster(HardwareSensorBroadcaster):
    """Publish the pose of a link as ``PoseStamped`` messages and as a transform.

    Behaves as ``pose_broadcaster/PoseBroadcaster`` in ROS 2 Jazzy: a pose that is not finite, or whose quaternion does
    not have the length one, is not published as a transform. The pose is the true one of a link: the first of the
    sensor's ``<param name="frame_id">`` in ``<ros2_control>``, ``tf.child_frame_id`` and ``pose_name`` that is a link
    of the robot. It is relative to the link ``frame_id``, or to the world if the robot has no such link. If none of the
    three is a link, the values are the state interfaces' ``initial_value``, or NaN. Since a frame has one parent in the
    twin, a link is published as a transform only if it is the robot's root. The child frame has the robot's prefix.

    .. pydrake_system::

        name: PoseBroadcaster
        input_ports:
        - values
        output_ports:
        - pose
        - tf_odometry

    - ``values``: vector ``[x y z, qx qy qz qw]`` (m), as from `PoseSensor`.
    - ``pose``: ``geometry_msgs/msg/PoseStamped`` of the present time, None while inactive; topic ``~/pose``.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``tf.enable`` only. None
      while inactive or without a valid pose.
    """

    Parameters: ClassVar[type] = PoseBroadcasterParameters

    @classmethod
    def sensor_name(cls, parameters: PoseBroadcasterParameters) -> str:
        """Return the name of the sensor in ``<ros2_control>`` that the controller reads."""
        return parameters.pose_name

    @classmethod
    def state_interfaces(cls, parameters: PoseBroadcasterParameters) -> tuple[str, ...]:
        """Return position and orientation."""
        return tuple(f"{parameters.pose_name}/{name}" for name in _INTERFACES)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: PoseBroadcasterParameters = setup.parameters
        self.declare_message_output("pose", "geometry_msgs/msg/PoseStamped", self._pose, self._present())
        self._link = _link(setup)
        if self._link is None:
            names = f"tf.child_frame_id ({parameters.tf.child_frame_id!r}) and pose_name ({parameters.pose_name!r})"
            self.warnings += (f"the sensor's frame_id, {names} name no link: the pose is not simulated",)
        child = parameters.tf.child_frame_id or parameters.pose_name
        if not parameters.tf.enable:
            return
        if child in setup.description.links and child != setup.description.root_link:
            self.warnings += (f"the frame {child!r} has its parent in the robot's file: its pose is not on /tf",)
            return
        self.odometry_frames = (setup.frame(parameters.frame_id), setup.frame_prefix + child)
        self.declare_message_output("tf_odometry", "tf2_msgs/msg/TFMessage", self._tf, self._present())

    def own_sensor(self, plant: MultibodyPlant, instance: ModelInstanceIndex) -> PoseSensor | None:
        """Return a sensor of the link's pose; None if no link is named."""
        if self._link is None:
            return None
        frame = self.setup.parameters.frame_id
        is_link = frame in self.setup.description.links
        body = plant.GetBodyByName(drake_link_name(self._link), instance)
        reference = plant.GetBodyByName(drake_link_name(frame), instance) if is_link else plant.world_body()
        return PoseSensor([MeasuredPose(body.index(), reference.index())])

    def _pose(self, context: Context) -> Any:
        x, y, z, *quaternion = self._sensor.Eval(context).tolist()
        return messages.PoseStamped(
            header=messages.header(context.get_time(), self.setup.frame(self.setup.parameters.frame_id)),
            pose=messages.Pose(messages.Point(x, y, z), messages.Quaternion(*quaternion)),
        )

    def _tf(self, context: Context) -> Any:
        values = self._sensor.Eval(context).tolist()
        if not _is_pose(values) or self.odometry_frames is None:
            return None
        return messages.TFMessage([transform_message(context.get_time(), *self.odometry_frames, values)])


def _link(setup: ControllerSetup) -> str | None:
    """Return the link whose pose is published; None if none is named."""
    parameters: PoseBroadcasterParameters = setup.parameters
    sensor = setup.description.hardware_sensors.get(parameters.pose_name)
    frame = sensor.parameters.get("frame_id", "") if sensor is not None else ""
    names = (frame, parameters.tf.child_frame_id, parameters.pose_name)
    return next((name for name in names if name in setup.description.links), None)


def _is_pose(values: list[float]) -> bool:
    length_squared: float = fsum(value * value for value in values[3:])
    return all(map(isfinite, values)) and abs(length_squared - 1.0) <= _LENGTH_TOLERANCE
