"""The base of the controllers of bases with steered wheels."""

from abc import ABC, abstractmethod
from dataclasses import field, replace
from math import copysign, inf, isnan, nan, tan
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.drive_kinematics import SteeringDrive
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.drive_controller import DriveController, DriveMemory, check_covariances, state_joint
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.speed_limits import LimitsX, LimitsZ, zero_jerk_limits
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.systems.no_message import set_value

_UPSTREAMS_COVARIANCE = (0.0, 7.0, 14.0, 21.0, 28.0, 35.0)
_NAMES = (
    "traction_joints_names",
    "steering_joints_names",
    "traction_joints_state_names",
    "steering_joints_state_names",
)
_NO_LIMITS = {"not_of_files": "steering controllers of ros2_controllers have no speed limits"}


@dataclass(frozen=True, kw_only=True)
class SteeringParameters(ABC):
    """Parameters that ros2_controllers' steering_controllers_library reads for each of its controllers.

    Attributes:
        reference_timeout: The time after which a command expires (s); with 0 it is valid for one update.
        front_steering: Deprecated; whether the deprecated front names, not the rear ones, are those of the steered
            wheels.
        rear_wheels_names: Deprecated.
        traction_joints_names: The joints of the driven wheels; of two, the right one first.
        front_wheels_names: Deprecated.
        steering_joints_names: The steering joints; of two, the right one first.
        traction_joints_state_names: The joints that are measured; empty for the commanded ones.
        rear_wheels_state_names: Deprecated.
        steering_joints_state_names: The joints that are measured; empty for the commanded ones.
        front_wheels_state_names: Deprecated.
        open_loop: Whether the odometry and the wheels' speeds follow the commands instead of the joints.
        reduce_wheel_speed_until_steering_reached: Whether the wheels turn slower while the steering error is more than
            30°.
        velocity_rolling_window_size: The number of velocities that the odometry averages.
        base_frame_id: The frame of the base.
        odom_frame_id: The frame of the odometry.
        enable_odom_tf: Whether the odometry's transform is published.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        position_feedback: Whether the odometry uses the driven wheels' positions instead of their velocities.
        use_stamped_vel: A parameter of Humble; false replaces ``~/reference`` by ``~/reference_unstamped`` of type
            ``Twist``.
        linear: The limits of the forward velocity; the twin's own, for robots that Gazebo's plugins drive;
            ignored in parameters files.
        angular: The limits of the velocity about z; the same applies.
        largest_steering_angle: The largest angle in the middle of the steered axle (rad); the twin's own.
        angular_is_steering_angle: Whether a command's ``angular.z`` is that angle (rad), as in classic Gazebo's
            Ackermann plugin; the twin's own.
    """

    read_only: ClassVar[tuple[str, ...]] = ("front_steering", "*_names")

    reference_timeout: float = field(default=1.0, metadata={"lower": 0.0})
    front_steering: bool = True
    rear_wheels_names: tuple[str, ...] = ()
    traction_joints_names: tuple[str, ...] = ()
    front_wheels_names: tuple[str, ...] = ()
    steering_joints_names: tuple[str, ...] = ()
    traction_joints_state_names: tuple[str, ...] = ()
    rear_wheels_state_names: tuple[str, ...] = ()
    steering_joints_state_names: tuple[str, ...] = ()
    front_wheels_state_names: tuple[str, ...] = ()
    open_loop: bool = False
    reduce_wheel_speed_until_steering_reached: bool = False
    velocity_rolling_window_size: int = field(default=10, metadata={"lower": 1})
    base_frame_id: str = "base_link"
    odom_frame_id: str = "odom"
    enable_odom_tf: bool = True
    twist_covariance_diagonal: tuple[float, ...] = _UPSTREAMS_COVARIANCE
    pose_covariance_diagonal: tuple[float, ...] = _UPSTREAMS_COVARIANCE
    position_feedback: bool = False
    use_stamped_vel: bool = True
    linear: LimitsX = field(default_factory=LimitsX, metadata=_NO_LIMITS)
    angular: LimitsZ = field(default_factory=LimitsZ, metadata=_NO_LIMITS)
    largest_steering_angle: float = field(default=inf, metadata={"above": 0.0})
    angular_is_steering_angle: bool = False

    def __post_init__(self) -> None:
        drive = self.kinematics()
        for kind, expected in (("traction", drive.driven), ("steering", drive.steered)):
            for name, is_required in ((f"{kind}_joints_names", True), (f"{kind}_joints_state_names", False)):
                found = self.joints(name)
                if len(found) != expected and (found or is_required):
                    raise ParameterError(
                        f"this controller has {expected} {kind} joint{'s' * (expected > 1)}, but {name} has"
                        f" {len(found)}: [{', '.join(found)}]",
                        *([name] if getattr(self, name) else []),
                    )
                if len(set(found)) != len(found):
                    raise ParameterError(f"{name} has a duplicate name: [{', '.join(found)}]", name)
        if not drive.wheel_radius > 0.0:
            raise ParameterError("the radius of the traction wheels is missing or not positive")
        if drive.driven == 2 and not drive.driven_track > 0.0:
            raise ParameterError("the track width of the traction wheels is missing or not positive")
        check_covariances(self)

    @abstractmethod
    def kinematics(self) -> SteeringDrive:
        """Return the drive."""

    def joints(self, name: str) -> tuple[str, ...]:
        """Return a list of joints, for example ``traction_joints_names``, with the deprecated names applied."""
        kind, _, suffix = name.partition("_joints_")
        axle = "front" if (kind == "steering") == self.front_steering else "rear"
        deprecated: tuple[str, ...] = getattr(self, f"{axle}_wheels_{suffix}")
        given: tuple[str, ...] = getattr(self, name)
        return deprecated or given

    def by_axle(self, front: float, rear: float, kind: str) -> float:
        """Return the value of the ``traction`` or ``steering`` axle from deprecated ones of front and rear."""
        return front if (kind == "steering") == self.front_steering else rear


class SteeringController(DriveController):
    """Drive a base with driven and steered wheels at a commanded twist, and publish its odometry.

    Behaves as the controllers of ros2_controllers' steering_controllers_library do in ROS 2 Jazzy: the driven wheels
    are commanded zero before the first command, after a NaN command, and after ``reference_timeout``, while the steered
    ones keep their last command. With a time-out of zero a command is valid for one update.

    .. pydrake_system::

        name: SteeringController
        input_ports:
        - state
        - reference
        - <upstream controller>
        output_ports:
        - command_interfaces
        - odometry
        - tf_odometry
        - controller_state

    - ``reference``: ``geometry_msgs/msg/TwistStamped`` (m/s forwards, rad/s), or ``reference_unstamped``,
      ``geometry_msgs/msg/Twist``, with ``use_stamped_vel: false``; topic below the controller's name.
    - ``command_interfaces``: velocities of the driven wheels (rad/s), then positions of the steering joints (rad).
    - ``odometry``: ``nav_msgs/msg/Odometry`` at every update; None before the first.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    - ``controller_state``: ``control_msgs/msg/SteeringControllerStatus`` at every update.

    References for other controllers: ``linear/velocity`` (m/s) and ``angular/velocity`` (rad/s).
    """

    _nan_stops = True

    @classmethod
    def claimed_interfaces(cls, parameters: SteeringParameters, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the velocities of the driven wheels, then the positions of the steering joints."""
        return (
            *(Interface(joint, "velocity") for joint in parameters.joints("traction_joints_names")),
            *(Interface(joint, "position") for joint in parameters.joints("steering_joints_names")),
        )

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the base's velocity as references."""
        return Interface("linear", "velocity"), Interface("angular", "velocity")

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: SteeringParameters = setup.parameters
        self._drive = replace(parameters.kinematics(), largest_angle=parameters.largest_steering_angle)
        self._limiters = (parameters.linear.x.limiter(), parameters.angular.z.limiter())
        self.warnings += tuple(zero_jerk_limits(parameters))
        self._odometry_wheels, self._steering_joints = (
            tuple(
                state_joint(name, setup.layout.velocities)
                for name in parameters.joints(f"{kind}_joints_state_names") or parameters.joints(f"{kind}_joints_names")
            )
            for kind in ("traction", "steering")
        )
        self._declare_command("reference", stamped=parameters.use_stamped_vel, timeout=parameters.reference_timeout)
        self._declare_odometry("odometry")
        self.declare_topic_output(
            "controller_state",
            "control_msgs/msg/SteeringControllerStatus",
            self._calc_controller_state,
            {self.sample_ticket()},
        )

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Update the odometry, drive the driven wheels and steer the others."""
        parameters: SteeringParameters = self.setup.parameters
        (linear, angular), memory = self._limited_reference(context, time, memory)
        angles = tuple(map(float, self.positions(context, self._steering_joints)))
        measured = self._drive.mean_steering_angle(angles)
        if parameters.angular_is_steering_angle:
            angle = self._drive.within_limits(copysign(1.0, linear) * angular)
            angular = tan(angle) * linear / self._drive.wheelbase
        else:
            angle = self._drive.steering_angle(linear, angular)
        memory = self._with_odometry(
            context,
            time,
            memory,
            (0.0 if isnan(linear) else linear, 0.0 if isnan(angular) else angular),
            lambda wheels: self._drive.base_velocity(wheels, measured),
            from_positions=parameters.position_feedback,
        )
        measure = self.positions if parameters.position_feedback else self.velocities
        state = (*map(float, measure(context, self._odometry_wheels)), *angles)
        memory = self._with_publication(replace(memory, state=state), time)
        if isnan(linear) or isnan(angular):
            held = self.sample(context).commands[self._drive.driven :]
            return Update(memory, (0.0,) * self._drive.driven + held)
        speeds, steering = self._drive.wheel_commands(
            linear,
            angle,
            None if parameters.open_loop else measured,
            slow_while_steering=parameters.reduce_wheel_speed_until_steering_reached,
        )
        return Update(memory, (*speeds, *steering))

    def _limited_reference(
        self, context: Context, time: float, memory: DriveMemory
    ) -> tuple[tuple[float, float], DriveMemory]:
        (linear, angular), memory = self._reference(context, time, memory)
        if isnan(linear) or isnan(angular):
            return (nan, nan), replace(memory, last=(0.0, 0.0), second_to_last=(0.0, 0.0))
        linear, angular = self._limited((linear, angular), memory)
        return (linear, angular), replace(memory, last=(linear, angular), second_to_last=memory.last)

    def _calc_controller_state(self, context: Context, output: AbstractValue) -> None:
        sample = self.sample(context)
        if sample.memory is None or not sample.memory.state:
            set_value(output, None)
            return
        driven = self._drive.driven
        wheels, nothing = np.array(sample.memory.state[:driven]), np.array([])
        by_position = self.setup.parameters.position_feedback
        output.set_value(
            messages.SteeringControllerStatus(
                header=messages.header(sample.time, self._frames[0]),
                traction_wheels_position=wheels if by_position else nothing,
                traction_wheels_velocity=nothing if by_position else wheels,
                steer_positions=np.array(sample.memory.state[driven:]),
                linear_velocity_command=np.array(sample.commands[:driven]),
                steering_angle_command=np.array(sample.commands[driven:]),
            )
        )
