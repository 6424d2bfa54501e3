"""A force/torque sensor in a joint."""

from collections.abc import Iterable
from dataclasses import field

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.classic import classic_plugin, classic_topic
from drake_twin.sensors.noise import Noise, read_noise
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic

_CHANNELS = tuple(f"{part}.{axis}" for part in ("force", "torque") for axis in "xyz")


@dataclass(frozen=True)
class ForceTorqueSettings:
    """What a force/torque sensor reads of its element.

    Attributes:
        measured_on: The link that the measured wrench acts on: ``parent`` (that of the child on the parent, Gazebo's
            default) or ``child``.
        axes: Whose axes its values have: ``child`` (Gazebo's default), ``parent`` or ``sensor``.
        noises: Channel → its noise (N, N·m), where it has some.
        link: The link of a plugin of Gazebo classic that is not in a joint.
    """

    measured_on: str = "parent"
    axes: str = "child"
    noises: dict[str, Noise] = field(default_factory=dict)
    link: str = ""


@sensor("force_torque", "gazebo_ros_ft_sensor", on="joint")
class ForceTorqueSensor(SensorSystem):
    """Measure the wrench that a joint's two links exert on each other.

    Like gz-sensors' ForceTorqueSensor (src/ForceTorqueSensor.cc) and gz-sim's ForceTorque system: the torque is about
    the sensor's origin, the axes are those of the child link, the parent link or the sensor, and the wrench is the
    child's on the parent (SDF's ``child_to_parent``, the default) or the parent's on the child. It includes the
    actuator's effort. It is computed on demand. A discrete plant without sampled output ports reports the forces of the
    next step with the present commands. Gazebo classic's gazebo_ros_ft_sensor measures the child's wrench, in the
    child's axes and about its origin.

    .. pydrake_system::

        name: ForceTorqueSensor
        input_ports:
        - reaction_forces
        - body_poses
        output_ports:
        - wrench
        - message

    - ``reaction_forces``: the plant's port of this name.
    - ``body_poses``: the plant's port of this name; only declared for the axes of the parent link.
    - ``wrench``: vector ``[fx fy fz, tx ty tz]`` (N, N·m), with noise.
    - ``message``: the same as ``geometry_msgs/msg/WrenchStamped`` of the present time.
    """

    message_type = "geometry_msgs/msg/WrenchStamped"
    gz_topic = "forcetorque"
    values_port = "wrench"

    @classmethod
    def read(cls, element: SensorElement) -> ForceTorqueSettings:
        """Read direction, axes and noise.

        Raises:
            InputError: If a value is invalid.
        """
        if element.sensor.kind == "gazebo_ros_ft_sensor":
            stddev = element.number("gaussian_noise", 0.0, least=0.0)
            noises = dict.fromkeys(_CHANNELS, Noise(stddev=stddev)) if stddev else {}
            # physics::JointWrench::body2Force: what the parent exerts on the child.
            return ForceTorqueSettings("child", "child", noises, element.text("body_name"))
        direction = element.choice("force_torque/measure_direction", ("child_to_parent", "parent_to_child"))
        axes = element.choice("force_torque/frame", ("child", "parent", "sensor"))
        paths = {channel: f"force_torque/{channel.replace('.', '/')}/noise" for channel in _CHANNELS}
        noises = {channel: read_noise(element, path) for channel, path in paths.items()}
        return ForceTorqueSettings(direction.rpartition("_")[2], axes, noises)

    @classmethod
    def problem(cls, settings: ForceTorqueSettings) -> str | None:
        """Return that the force on a whole link is not simulated."""
        if settings.link:
            return f"the sum of all forces on the link {settings.link!r} is not simulated: name a <joint_name>"
        return None

    @classmethod
    def topics(cls, sensor: Sensor, settings: ForceTorqueSettings, base: str) -> Iterable[SensorTopic]:
        """Return its topic: ``wrench`` of Gazebo classic's plugin."""
        plugin = classic_plugin(sensor, "gazebo_ros_ft_sensor")
        name = base if plugin is None else classic_topic(plugin, "wrench")
        return (SensorTopic("message", cls.message_type, name, is_ros=plugin is not None),)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        settings: ForceTorqueSettings = setup.settings
        joint, pose = setup.joint, setup.pose
        self._joint = int(joint.index())
        self._parent, self._child = int(joint.parent_body().index()), int(joint.child_body().index())
        self._p_JS_J = np.array(pose.translation())
        self._sign = {"parent": -1.0, "child": 1.0}[settings.measured_on]
        R_CJ = joint.frame_on_child().GetFixedPoseInBodyFrame().rotation()
        self._R_CJ = R_CJ.matrix()
        self._R_AJ = {"child": R_CJ, "parent": R_CJ, "sensor": pose.rotation().inverse()}[settings.axes].matrix()
        self._forces = self.declare_plant_input("reaction_forces")
        self._poses = self.declare_plant_input("body_poses") if settings.axes == "parent" else None
        self._wrench = self.declare_values_output(len(_CHANNELS), self._calc_wrench)
        self.declare_message_output(self._calc_message)

    def _calc_wrench(self, context: Context, output: BasicVector) -> None:
        F_CJ_J = self._forces.Eval(context)[self._joint]
        force = np.array(F_CJ_J.translational())
        torque = np.array(F_CJ_J.rotational()) - np.cross(self._p_JS_J, force)
        R_AJ = self._R_AJ
        if self._poses is not None:
            poses = self._poses.Eval(context)
            R_PC = poses[self._parent].rotation().inverse() @ poses[self._child].rotation()
            R_AJ = R_PC.matrix() @ self._R_CJ
        values = self._sign * np.concatenate([R_AJ @ force, R_AJ @ torque])
        output.SetFromVector(self.noisy_values(_CHANNELS, values, context.get_time()))

    def _calc_message(self, context: Context, output: AbstractValue) -> None:
        fx, fy, fz, tx, ty, tz = self._wrench.Eval(context).tolist()
        wrench = messages.Wrench(force=messages.Vector3(x=fx, y=fy, z=fz), torque=messages.Vector3(x=tx, y=ty, z=tz))
        output.set_value(messages.WrenchStamped(header=self.header(context), wrench=wrench))
