"""Admittance control: joints give way to a wrench as a mass on a spring does, as in ros2_controllers."""

from dataclasses import field, replace
from math import isnan, nan
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.admittance_parameters import AdmittanceParameters
from drake_twin.controllers.admittance_rule import AdmittanceState
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.chain_kinematics import ChainKinematics, joints_between
from drake_twin.controllers.force_torque_sensor_broadcaster import wrench_interfaces
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError
from drake_twin.saved import saved


@saved("AdmittanceReference")
@dataclass(frozen=True)
class AdmittanceReference:
    """The joints' reference of a message; empty for what the message does not have.

    Attributes:
        positions: The joints' positions (rad or m).
        velocities: Their velocities (rad/s or m/s).
    """

    positions: tuple[float, ...]
    velocities: tuple[float, ...]


@saved("AdmittanceWrench")
@dataclass(frozen=True)
class AdmittanceWrench:
    """A wrench of a message in the sensor's frame, force first (N, N·m)."""

    values: tuple[float, ...]


@saved("AdmittanceMemory")
@dataclass(frozen=True)
class AdmittanceMemory:
    """The memory of the controller.

    Attributes:
        positions: The reference of each joint (rad or m).
        velocities: The velocity of the reference (rad/s or m/s).
        state: The state of the control law.
    """

    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    state: AdmittanceState = field(default_factory=lambda: AdmittanceState.at_rest(0))


@controller("admittance_controller/AdmittanceController")
class AdmittanceController(SensorReader, PeriodicController):
    """Add an offset to the joints' reference, by which the force/torque sensor gives way to a wrench.

    Behaves as ``admittance_controller/AdmittanceController`` in ROS 2 Jazzy; `AdmittanceRule` has the control law. The
    kinematics are those of a plant of the robot's links and joints, for any ``kinematics.plugin_name``; their Jacobian
    and its damped inverse are those of ``kinematics_interface_kdl``. ``joints`` are all joints between
    ``kinematics.base`` and ``kinematics.tip``, matched by their names, and the other frames are links that no other
    joint moves. Unlike upstream, a wrench is turned into the axes of ``fixed_world_frame`` by the inverse of that
    link's orientation in the base, messages that do not fit are refused, and the twin neither measures nor commands
    accelerations.

    .. pydrake_system::

        name: AdmittanceController
        input_ports:
        - wrench
        - state
        - <controller>
        - joint_references
        - wrench_reference
        output_ports:
        - command_interfaces
        - status

    - ``wrench``: vector ``[fx fy fz, tx ty tz]`` (N, N·m), as from `ForceTorqueSensor`; zero if an element is NaN.
    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``<controller>``: the references that an upstream controller writes; while it does, messages on
      ``joint_references`` are ignored.
    - ``joint_references``: a message as `AdmittanceReference`, None before the first;
      ``trajectory_msgs/msg/JointTrajectoryPoint``, topic ``~/joint_references``.
    - ``wrench_reference``: a message as `AdmittanceWrench`, which is added to the measured wrench, None before the
      first; ``geometry_msgs/msg/WrenchStamped``, topic ``~/wrench_reference``.
    - ``command_interfaces``: each of ``command_interfaces`` for all joints (rad, rad/s, or m, m/s).
    - ``status``: ``control_msgs/msg/AdmittanceControllerState`` of the last update; topic ``~/status``.

    References for other controllers: each of ``chainable_command_interfaces`` for all joints.
    """

    Parameters: ClassVar[type] = AdmittanceParameters
    kind = "force_torque"

    @classmethod
    def sensor_name(cls, parameters: AdmittanceParameters) -> str:
        """Return the name of the force/torque sensor."""
        return parameters.ft_sensor.name

    @classmethod
    def state_interfaces(cls, parameters: AdmittanceParameters) -> tuple[str, ...]:
        """Return the sensor's force and torque."""
        return wrench_interfaces(parameters.ft_sensor.name)

    @classmethod
    def claimed_interfaces(
        cls, parameters: AdmittanceParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return each command interface for all joints."""
        joints = parameters.command_joints or parameters.joints
        return tuple(Interface(joint, name) for name in parameters.written_interfaces for joint in joints)

    @classmethod
    def reference_interfaces(
        cls, parameters: AdmittanceParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return each reference for all joints."""
        names = parameters.chainable_command_interfaces
        return tuple(Interface(joint, name) for name in names for joint in parameters.joints)

    @classmethod
    def problem(cls, parameters: AdmittanceParameters, description: RobotDescription) -> str | None:
        """Return why the robot lacks the sensor or the chain; None if it has them."""
        for link in parameters.links:
            if link not in description.links:
                return f"the robot has no link {link!r} (it has {', '.join(description.links)})"
        base, tip, *others = parameters.links
        chain = joints_between(description, base, tip)
        if set(parameters.joints) != chain:
            between = ", ".join(joint.name for joint in description.joints if joint.name in chain) or "none"
            return f"joints are {', '.join(parameters.joints)}, but those between {base} and {tip} are {between}"
        for link in others:
            if moving := joints_between(description, base, link) - chain:
                return (
                    f"the link {link!r} is moved by {', '.join(sorted(moving))}, which is not between {base} and {tip}"
                )
        return super().problem(parameters, description)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: AdmittanceParameters = setup.parameters
        self._joints = parameters.joints
        kinematics = parameters.kinematics
        self._rule = parameters.rule(
            ChainKinematics(setup.description, kinematics.base, self._joints, kinematics.alpha)
        )
        if "acceleration" in (*parameters.command_interfaces, *parameters.state_interfaces):
            self.warnings += ("the twin neither measures nor commands accelerations: these interfaces are left out",)
        self.declare_sensor_input("wrench")
        self._reference = self.declare_topic_input("joint_references", "trajectory_msgs/msg/JointTrajectoryPoint")
        self._wrench = self.declare_topic_input("wrench_reference", "geometry_msgs/msg/WrenchStamped")
        kind = "control_msgs/msg/AdmittanceControllerState"
        self.declare_message_output("status", kind, self._status)

    def read(self, topic: str, message: Any, context: Context) -> AdmittanceReference | AdmittanceWrench:
        """Convert a message.

        Raises:
            CommandError: If a joint's element is missing, or the wrench is in another frame than the sensor's.
        """
        if topic == "joint_references":
            reference = AdmittanceReference(
                *(tuple(np.asarray(values, dtype=float).tolist()) for values in (message.positions, message.velocities))
            )
            for name, values in (("positions", reference.positions), ("velocities", reference.velocities)):
                if len(values) not in (0, len(self._joints)):
                    raise CommandError(
                        f"the reference has {len(values)} {name}, but there are {len(self._joints)} joints:"
                        f" {', '.join(self._joints)}"
                    )
            return reference
        frame, own = message.header.frame_id, self.setup.parameters.ft_sensor.frame.id
        if frame not in ("", own, self.setup.frame(own)):
            raise CommandError(f"the wrench is in the frame {frame!r}, but the sensor's is {own!r}")
        return AdmittanceWrench(
            tuple(getattr(vector, axis) for vector in (message.wrench.force, message.wrench.torque) for axis in "xyz")
        )

    def start(self, context: Context) -> AdmittanceMemory:
        """Return a memory with the present state as reference, and no offset."""
        velocities = np.zeros(len(self._joints))
        if "velocity" in self.setup.parameters.state_interfaces:
            velocities = self.velocities(context, self._joints)
        positions = self.positions(context, self._joints)
        state = AdmittanceState.at_rest(len(self._joints))
        return AdmittanceMemory(tuple(positions.tolist()), tuple(velocities.tolist()), state)

    def update(self, context: Context, time: float, memory: AdmittanceMemory) -> Update:
        """Move the offset by one step, and add it to the reference."""
        memory = self._with_reference(context, memory)
        wrench = self._sensor.Eval(context)
        if np.isnan(wrench).any():
            wrench = np.zeros(6)
        added: AdmittanceWrench | None = self.received(self._wrench, context)
        if added is not None:
            wrench = wrench + np.array(added.values)
        positions = np.array(memory.positions)
        dt = time - self.sample(context).time
        state = self._rule.update(memory.state, self.positions(context, self._joints), positions, wrench, dt)
        desired = {
            "position": positions + np.array(state.joint_positions),
            "velocity": np.array(memory.velocities) + np.array(state.joint_velocities),
        }
        commands = np.concatenate([desired[name] for name in self.setup.parameters.written_interfaces])
        return Update(replace(memory, state=state), commands)

    def _with_reference(self, context: Context, memory: AdmittanceMemory) -> AdmittanceMemory:
        """Return the memory with the newest reference; elements that are NaN stay as they are."""
        names = self.setup.parameters.chainable_command_interfaces
        given: dict[str, tuple[float, ...]] = {}
        upstream = self.references(context)
        message: AdmittanceReference | None = self.received(self._reference, context)
        if upstream is not None:
            given = dict(zip(names, map(tuple, upstream.reshape(len(names), -1).tolist()), strict=True))
        elif message is not None:
            given = {"position": message.positions, "velocity": message.velocities}
        nothing = (nan,) * len(self._joints)

        def merged(name: str, last: tuple[float, ...]) -> tuple[float, ...]:
            values = (given.get(name) or nothing) if name in names else nothing
            return tuple(old if isnan(new) else new for new, old in zip(values, last, strict=True))

        return replace(
            memory,
            positions=merged("position", memory.positions),
            velocities=merged("velocity", memory.velocities),
        )

    def _status(self, context: Context) -> Any:
        parameters: AdmittanceParameters = self.setup.parameters
        sample, rule, frame = self.sample(context), self._rule, self.setup.frame
        if sample.memory is None:
            return None
        state, time = sample.memory.state, sample.time
        base, sensor = frame(parameters.kinematics.base), frame(parameters.ft_sensor.frame.id)
        header = messages.header(time, base)
        twist = messages.TwistStamped
        return messages.AdmittanceControllerState(
            mass=messages.float64_multi_array(rule.mass),
            damping=messages.float64_multi_array(rule.damping),
            stiffness=messages.float64_multi_array(rule.stiffness),
            rot_base_control=_transform(state.control).rotation,
            ref_trans_base_ft=messages.TransformStamped(header, sensor, _transform(state.reference)),
            selected_axes=messages.Int8MultiArray(messages.MultiArrayLayout([], 0), rule.selected_axes.astype(np.int8)),
            ft_sensor_frame=messages.String(sensor),
            admittance_position=messages.TransformStamped(header, "admittance_offset", _transform(state.offset)),
            admittance_acceleration=twist(header, messages.Twist(*_vectors(state.acceleration))),
            admittance_velocity=twist(header, messages.Twist(*_vectors(state.velocity))),
            wrench_base=messages.WrenchStamped(header, messages.Wrench(*_vectors(state.wrench_base))),
            joint_state=messages.JointState(
                header=messages.header(time),
                name=list(self._joints),
                position=np.array(state.joint_positions),
                velocity=np.array(state.joint_velocities),
                effort=np.array(state.joint_accelerations),
            ),
        )


def _vectors(six: tuple[float, ...]) -> tuple[Any, Any]:
    return messages.Vector3(*six[:3]), messages.Vector3(*six[3:])


def _transform(numbers: tuple[float, ...]) -> Any:
    x, y, z, qw, qx, qy, qz = numbers
    return messages.Transform(messages.Vector3(x, y, z), messages.Quaternion(qx, qy, qz, qw))
