"""The base of the controllers of wheeled bases: a commanded twist in, odometry and its transform out."""

from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from math import cos, isfinite, isinf, isnan, nan, sin
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.control.wheel_odometry import WheelOdometry
from drake_twin.controllers.odometry_frames import TF_ODOMETRY, odometry_frames
from drake_twin.controllers.periodic_controller import PeriodicController
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError
from drake_twin.kinematics.rotations import along_heading, heading_of
from drake_twin.saved import saved
from drake_twin.systems.no_message import set_value

_NANOSECONDS = 1e9


@saved("TwistCommand")
@dataclass(frozen=True)
class TwistCommand:
    """A commanded velocity of the base, the value of its port.

    Attributes:
        id: A number, higher than that of the command used last.
        time: Its stamp, at most the present time (s).
        linear_x: The forward velocity (m/s).
        linear_y: The velocity to the left (m/s).
        angular_z: The angular velocity about z (rad/s).
    """

    id: int
    time: float
    linear_x: float
    linear_y: float
    angular_z: float


@saved("DriveMemory")
@dataclass(frozen=True)
class DriveMemory:
    """What a drive keeps from one update to the next.

    Attributes:
        odometry: The estimated pose of the base.
        start: The time of the activation (s).
        wheels: The positions of the wheels at the odometry's time (rad), if the odometry uses positions.
        used: The id of the last command that was used up.
        last: The command of the last update, within its limits.
        second_to_last: The command of the update before it.
        limited: The command of this update; None without one.
        published: The odometry on the ports; None before the first.
        next_publication: When the next one is due (ns); None for the next update.
        state: The values of the port ``controller_state``.
    """

    odometry: WheelOdometry
    start: float
    wheels: tuple[float, ...] = ()
    used: int = 0
    last: tuple[float, ...] = (0.0, 0.0, 0.0)
    second_to_last: tuple[float, ...] = (0.0, 0.0, 0.0)
    limited: tuple[float, ...] | None = None
    published: WheelOdometry | None = None
    next_publication: int | None = None
    state: tuple[Any, ...] = ()


class DriveController(PeriodicController):
    """Drive a base; a subclass declares the ports and implements ``update``.

    Odometry is calculated and published from the first update, also before a command has come, and wheels may start
    at any angle. When a controller is activated again, its odometry continues, and its last commands are forgotten.
    """

    _components: tuple[str, ...] = ("linear_x", "angular_z")  # those of `TwistCommand` that the base follows
    _odometry_wheels: tuple[str, ...]
    _limiters: tuple[Any, ...] = ()
    _nan_stops = False  # whether a NaN command stops the base instead of being refused

    def get_command_input_port(self) -> InputPort:
        """Return the port of the commanded twist: ``cmd_vel`` or ``reference``, or ``cmd_vel_unstamped`` and so on."""
        return self._command

    def get_odometry_output_port(self) -> OutputPort:
        """Return the port of the odometry: ``odom`` or ``odometry``."""
        return self._odometry

    def reset_odometry(self, context: Context) -> None:
        """Set the odometry to the origin of its frame; upstream's service ``~/reset_odometry``."""
        sample = self.sample(context)
        if sample.memory is not None:
            self.set_memory(context, replace(sample.memory, odometry=sample.memory.odometry.reset()))

    def start(self, context: Context) -> DriveMemory:
        """Return a memory without commands; the odometry continues from the last activation."""
        time = context.get_time()
        before: DriveMemory | None = self.sample(context).memory
        if before is not None:
            return DriveMemory(before.odometry, time, before.wheels, published=before.published)
        wheels = tuple(map(float, self.positions(context, self._odometry_wheels)))
        return DriveMemory(WheelOdometry(time=time), time, wheels)

    def read(self, topic: str, message: Any, context: Context) -> TwistCommand:
        """Convert a message; a stamp of zero or in the future means now.

        Raises:
            CommandError: If the message has timed out or is not finite; the previous command stays.
        """
        now = context.get_time()
        stamped = self.subscribed[topic].endswith("Stamped")
        twist = message.twist if stamped else message
        stamp = now
        if stamped and (message.header.stamp.sec or message.header.stamp.nanosec):
            stamp = min(message.header.stamp.sec + message.header.stamp.nanosec / _NANOSECONDS, now)
        command = TwistCommand(
            id=self.newest_id(context) + 1,
            time=stamp,
            linear_x=float(twist.linear.x),
            linear_y=float(twist.linear.y),
            angular_z=float(twist.angular.z),
        )
        if self._is_expired(now, stamp):
            raise CommandError(
                f"the command's stamp is {now - stamp:g} s old, but a command expires after {self._command_timeout:g} s"
            )
        refusal = self._refusal(command)
        if refusal:
            raise CommandError(refusal)
        return command

    def used_id(self, memory: DriveMemory) -> int:
        """Return the id of the last command that was used up."""
        return memory.used

    def _refusal(self, command: TwistCommand) -> str | None:
        """Return why a command is refused; None if it is accepted."""
        for name in ("linear_x", "linear_y", "angular_z"):
            value = getattr(command, name)
            if isinf(value) or (isnan(value) and not self._nan_stops):
                return f"the command's {name.replace('_', '.')} is {value}, which is not a finite number"
        return None

    def _declare_command(self, topic: str, *, stamped: bool, timeout: float) -> None:
        """Declare the port of the commanded twist, which expires after a time-out (s; 0 for never)."""
        self._command_timeout = timeout
        self._command = (
            self.declare_topic_input(topic, "geometry_msgs/msg/TwistStamped")
            if stamped
            else self.declare_topic_input(f"{topic}_unstamped", "geometry_msgs/msg/Twist")
        )

    def _declare_odometry(self, topic: str, *, with_pose: bool = True) -> None:
        """Declare the ports of the odometry and, if enabled, of its transform ``tf_odometry``."""
        parameters = self.setup.parameters
        self._frames = odometry_frames(
            self.setup,
            parameters.odom_frame_id,
            parameters.base_frame_id,
            prefix_enable=getattr(parameters, "tf_frame_prefix_enable", False),
            prefix=getattr(parameters, "tf_frame_prefix", ""),
        )
        diagonals = (parameters.pose_covariance_diagonal, parameters.twist_covariance_diagonal)
        self._covariances = tuple(np.diag(diagonal).ravel() for diagonal in diagonals)
        self._with_pose, self._odometry_topic = with_pose, topic
        tickets = {self.sample_ticket()}
        if self.setup.true_odometry:
            tickets.add(self.input_port_ticket(self.get_state_input_port().get_index()))
        self._odometry = self.declare_topic_output(topic, "nav_msgs/msg/Odometry", self._calc_odometry, tickets)
        if parameters.enable_odom_tf:
            self.odometry_frames = self._frames
            self.declare_topic_output(TF_ODOMETRY, "tf2_msgs/msg/TFMessage", self._calc_tf_odometry, tickets)

    def _feedback(
        self, context: Context, memory: DriveMemory, time: float, *, from_positions: bool
    ) -> tuple[tuple[float, ...], DriveMemory]:
        """Return the wheels' velocities (rad/s), measured or calculated from their positions at the last step."""
        if not from_positions:
            return tuple(map(float, self.velocities(context, self._odometry_wheels))), memory
        if not memory.odometry.is_due(time):
            return (0.0,) * len(self._odometry_wheels), memory
        positions = tuple(map(float, self.positions(context, self._odometry_wheels)))
        step = time - memory.odometry.time
        velocities = tuple((now - before) / step for now, before in zip(positions, memory.wheels, strict=True))
        return velocities, replace(memory, wheels=positions)

    def _limited(self, values: Sequence[float], memory: DriveMemory) -> tuple[float, ...]:
        """Return a command within its limits, given the commands of the last two updates."""
        period = self.setup.update_period
        return tuple(
            limiter.limited(value, last, before, period)
            for limiter, value, last, before in zip(
                self._limiters, values, memory.last, memory.second_to_last, strict=False
            )
        )

    def _is_expired(self, now: float, stamp: float) -> bool:
        """Return whether a command with this stamp has timed out (s); a time-out of zero never does."""
        return bool(self._command_timeout) and is_older(now, stamp, self._command_timeout)

    def _with_publication(self, memory: DriveMemory, time: float, rate: float = 0.0) -> DriveMemory:
        """Return the memory with its odometry published, if that is due.

        Args:
            memory: The memory.
            time: The present time (s).
            rate: The rate at which diff_drive_controller publishes (Hz); 0 for each update. A plugin of Gazebo has its
                own period, which counts from one publication to the next.
        """
        now, due = round(time * _NANOSECONDS), memory.next_publication
        period = round(self.setup.publication_period * _NANOSECONDS)
        if period:
            if due is not None and now < due:
                return memory
            due = now if due is None or due + period <= now else due
        elif rate:
            if due is not None and now <= due:
                return memory
            due, period = now if due is None else due, int(_NANOSECONDS / rate)
        following = None if due is None else due + period
        return replace(memory, published=replace(memory.odometry, time=time), next_publication=following)

    def _valid_command(self, context: Context, time: float) -> TwistCommand | None:
        """Return the last command; None before the first and after it has timed out."""
        command: TwistCommand | None = self.received(self._command, context)
        return None if command is None or self._is_expired(time, command.time) else command

    def _reference(self, context: Context, time: float, memory: DriveMemory) -> tuple[tuple[float, ...], DriveMemory]:
        """Return other controllers' references, else the command; NaN without one.

        With a time-out of zero a command is valid for one update.
        """
        chained = self.references(context)
        if chained is not None:
            return tuple(map(float, chained)), memory
        if self._command_timeout:
            command = self._valid_command(context, time)
        else:
            command = self.pending(context, self._command)
            memory = memory if command is None else replace(memory, used=command.id)
        if command is None:
            return (nan,) * len(self._components), memory
        return tuple(getattr(command, name) for name in self._components), memory

    def _wanted(self, context: Context, time: float, memory: DriveMemory) -> tuple[float, ...] | None:
        """Return the velocity to follow; None to keep what was written last.

        Before the first command, the time-out counts from the activation.
        """
        chained = self.references(context)
        if chained is not None:
            return tuple(map(float, chained)) if all(map(isfinite, chained)) else None
        command = self.received(self.get_command_input_port(), context)
        if self._is_expired(time, memory.start if command is None else command.time):
            return (0.0,) * len(self._components)
        return None if command is None else tuple(getattr(command, name) for name in self._components)

    def _with_odometry(
        self,
        context: Context,
        time: float,
        memory: DriveMemory,
        commanded: tuple[float, float],
        base_velocity: Callable[[tuple[float, ...]], tuple[float, float]],
        *,
        from_positions: bool,
    ) -> DriveMemory:
        """Return the memory with the odometry at the present time.

        Args:
            context: The controller's own context.
            time: The present time (s).
            memory: The memory.
            commanded: The base's commanded velocity (m/s, rad/s), for ``open_loop``.
            base_velocity: Calculates the base's velocity from those of the wheels (rad/s).
            from_positions: Whether the wheels' velocities are calculated from their positions.
        """
        parameters = self.setup.parameters
        if parameters.open_loop:
            return replace(memory, odometry=memory.odometry.moved_open_loop(*commanded, time))
        wheels, memory = self._feedback(context, memory, time, from_positions=from_positions)
        window = parameters.velocity_rolling_window_size
        return replace(memory, odometry=memory.odometry.moved(*base_velocity(wheels), time, window))

    def publication(self, topic: str, context: Context) -> Any:
        """Return the time at which the message of a topic was published (s); None before the first."""
        if topic not in (self._odometry_topic, TF_ODOMETRY):
            return super().publication(topic, context)
        memory: DriveMemory | None = self.sample(context).memory
        return None if memory is None or memory.published is None else memory.published.time

    def _seen_odometry(self, context: Context) -> WheelOdometry | None:
        """Return the published odometry, the true one with `ControllerSetup.true_odometry`; None before it."""
        memory: DriveMemory | None = self.sample(context).memory
        if memory is None or memory.published is None:
            return None
        return self.true_odometry(context, memory.published.time) if self.setup.true_odometry else memory.published

    def true_odometry(self, context: Context, time: float) -> WheelOdometry:
        """Return the true planar pose of the root link in the world, and its velocity in its own axes."""
        layout = self.setup.layout
        if not layout.has_moving_base:
            return WheelOdometry(time=time)
        pose, velocity = layout.base_state(self.get_state_input_port().Eval(context))
        qw, qx, qy, qz, x, y, _ = pose.tolist()
        *_, angular, along_x, along_y, _ = velocity.tolist()
        heading = heading_of(qw, qx, qy, qz)
        forwards, to_the_left = along_heading(heading, along_x, along_y)
        return WheelOdometry(x, y, heading, forwards, to_the_left, angular, time)

    def _calc_odometry(self, context: Context, output: AbstractValue) -> None:
        odometry = self._seen_odometry(context)
        if odometry is None:
            set_value(output, None)
            return
        seen = odometry if self._with_pose else odometry.reset()
        pose_covariance, twist_covariance = self._covariances
        odom_frame, base_frame = self._frames
        pose = messages.Pose(position=messages.Point(x=seen.x, y=seen.y, z=0.0), orientation=_rotation(seen.heading))
        output.set_value(
            messages.Odometry(
                header=messages.header(odometry.time, odom_frame),
                child_frame_id=base_frame,
                pose=messages.PoseWithCovariance(pose=pose, covariance=pose_covariance.copy()),
                twist=messages.TwistWithCovariance(
                    twist=twist_message(odometry.linear_x, odometry.linear_y, odometry.angular_z),
                    covariance=twist_covariance.copy(),
                ),
            )
        )

    def _calc_tf_odometry(self, context: Context, output: AbstractValue) -> None:
        odometry = self._seen_odometry(context)
        if odometry is None:
            set_value(output, None)
            return
        odom_frame, base_frame = self._frames
        transform = messages.TransformStamped(
            header=messages.header(odometry.time, odom_frame),
            child_frame_id=base_frame,
            transform=messages.Transform(
                translation=messages.Vector3(x=odometry.x, y=odometry.y, z=0.0), rotation=_rotation(odometry.heading)
            ),
        )
        output.set_value(messages.TFMessage(transforms=[transform]))


def is_older(now: float, stamp: float, timeout: float) -> bool:
    """Return whether a stamp is older than a time-out, to the nanosecond, as ROS compares times (all in s)."""
    return not isinf(timeout) and round(now * _NANOSECONDS) - round(stamp * _NANOSECONDS) > round(
        timeout * _NANOSECONDS
    )


def state_joint(wheel: str, joints: Container[str]) -> str:
    """Return the joint of a wheel's name, which may be a reference: ``pid_controller/left_wheel``."""
    return wheel if wheel in joints else wheel.partition("/")[2]


def check_covariances(parameters: Any, *names: str) -> None:
    """Check that covariance diagonals have six elements, by default those of pose and twist.

    Raises:
        ParameterError: If one has more or fewer.
    """
    for name in names or ("pose_covariance_diagonal", "twist_covariance_diagonal"):
        if len(getattr(parameters, name)) != 6:
            raise ParameterError(f"{name} has {len(getattr(parameters, name))} elements; it needs six", name)


def twist_message(linear_x: float = nan, linear_y: float = nan, angular_z: float = nan) -> Any:
    """Return a planar ``geometry_msgs/msg/Twist`` (m/s, rad/s)."""
    return messages.Twist(
        linear=messages.Vector3(x=linear_x, y=linear_y, z=0.0), angular=messages.Vector3(x=0.0, y=0.0, z=angular_z)
    )


def _rotation(heading: float) -> Any:
    return messages.Quaternion(x=0.0, y=0.0, z=sin(0.5 * heading), w=cos(0.5 * heading))
