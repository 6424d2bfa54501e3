"""Belts and tracks, and vehicles on tracks, as gz-sim's TrackController and TrackedVehicle."""

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.control.wheel_odometry import WheelOdometry
from drake_twin.controllers.base_controller import ControllerSetup, MovesSurfaces
from drake_twin.controllers.drive_controller import DriveController, DriveMemory, twist_message
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.controllers.track_parameters import TracksParameters
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import TRACKS
from drake_twin.description.robot_description import RobotDescription, Vector3
from drake_twin.description.surface_velocity import NEEDS, has_surface_velocity
from drake_twin.errors import CommandError
from drake_twin.saved import saved
from drake_twin.systems.no_message import empty_value, set_value
from drake_twin.systems.weak_callback import weakly

_FLOAT = "std_msgs/msg/Float64"
_COMMAND, _ODOMETRY, _EFFICIENCY = "track_cmd_vel", "odometry", "steering_efficiency"
_CHANGES = 1e-6  # m/s or rad/s; what changes less is not sent to the tracks again
_SAME_TIME = 1e-9  # s


@saved("TrackCommand")
@dataclass(frozen=True)
class TrackCommand:
    """A number that a message has: a speed (m/s), or the steering efficiency.

    Attributes:
        id: A number, higher than that of the command used last.
        value: The number.
    """

    id: int
    value: float


@saved("TrackMemory")
@dataclass(frozen=True)
class TrackMemory:
    """What is kept of a track from one update to the next.

    Attributes:
        wanted: The commanded speed (m/s).
        time: When it was commanded (s).
        speed: The speed of the surface from this update on (m/s).
        before: The speed before this update.
        position: How far the surface has moved until this update (m).
        published: The time (s), position and speed of the odometry on the port; None before the first.
        next_publication: When the next one is due (s).
    """

    wanted: float = 0.0
    time: float = 0.0
    speed: float = 0.0
    before: float = 0.0
    position: float = 0.0
    published: tuple[float, float, float] | None = None
    next_publication: float = 0.0


@saved("TracksMemory")
@dataclass(frozen=True)
class TracksMemory(DriveMemory):
    """What the tracks and their vehicle keep.

    Attributes:
        tracks: The tracks.
        efficiency: The steering efficiency.
        sides: The speeds that the vehicle wants of its left and its right tracks (m/s).
    """

    tracks: tuple[TrackMemory, ...] = ()
    efficiency: float = 0.5
    sides: tuple[float, float] = (0.0, 0.0)


@controller(TRACKS)
class Tracks(DriveController, MovesSurfaces):
    """Move the surfaces of belts and tracks, and with those on its two sides a vehicle: ``gz_sim/Tracks``.

    Behaves as gz-sim's TrackController and TrackedVehicle (from their sources), but for the direction of friction: it
    is against the slip, in place of along the circle that the vehicle is to drive on. So a turn is as slow as the slip
    of the tracks across makes it, for which ``steering_efficiency`` is there. A command of the vehicle replaces those
    of its tracks, and a command of a track is valid until the vehicle's next one. The vehicle's odometry follows from
    the wanted speeds, as if it were on wheels without slip; a track's is how far its surface has moved.

    .. pydrake_system::

        name: Tracks
        input_ports:
        - state
        - <track>/track_cmd_vel
        - cmd_vel
        - steering_efficiency
        output_ports:
        - command_interfaces
        - surface_speeds
        - <track>/odometry
        - odom
        - tf_odometry

    - ``state``: the robot's ``[q; v]``.
    - ``<track>/track_cmd_vel``: ``std_msgs/msg/Float64``, the speed of a track (m/s): at its top along its link's x.
    - ``cmd_vel``: ``geometry_msgs/msg/TwistStamped`` (m/s, rad/s), or with ``use_stamped_vel: false``
      ``cmd_vel_unstamped``, ``geometry_msgs/msg/Twist``; with a vehicle only, as all below.
    - ``steering_efficiency``: ``std_msgs/msg/Float64``.
    - ``surface_speeds``: the speed of each track (m/s).
    - ``<track>/odometry``: ``nav_msgs/msg/Odometry`` with its position and speed in x (m, m/s).
    - ``odom``: ``nav_msgs/msg/Odometry`` of the vehicle; None before the first update.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    """

    Parameters: ClassVar[type] = TracksParameters
    _odometry_topic = ""

    @classmethod
    def surfaces(cls, parameters: TracksParameters) -> Mapping[str, Vector3]:
        """Return the link of each track and the axis that its surface turns about."""
        return {track.link: _vector(track.axis) for track in parameters.tracks.values()}

    @classmethod
    def problem(cls, parameters: TracksParameters, description: RobotDescription) -> str | None:
        """Return why surfaces cannot move; None if they can."""
        missing = next((link for link in cls.surfaces(parameters) if link not in description.links), None)
        if missing is not None:
            return f"the robot has no link {missing!r}"
        return None if has_surface_velocity() else NEEDS

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: TracksParameters = setup.parameters
        self._odometry_wheels = ()
        self._names = tuple(parameters.tracks)
        self._track_limiters = tuple(track.limits.limiter() for track in parameters.tracks.values())
        self._sides = tuple(parameters.sides())
        self._commands = [self.declare_topic_input(f"{name}/{_COMMAND}", _FLOAT) for name in self._names]
        for index, name in enumerate(self._names):
            self.published[f"{name}/{_ODOMETRY}"] = "nav_msgs/msg/Odometry"
            calc = weakly(self._calc_track_odometry, index)
            self.DeclareAbstractOutputPort(f"{name}/{_ODOMETRY}", empty_value, calc, {self.sample_ticket()})
        self.DeclareVectorOutputPort(
            "surface_speeds", len(self._names), weakly(self._calc_surface_speeds), {self.sample_ticket()}
        )
        if parameters.is_vehicle:
            self._limiters = (parameters.linear.x.limiter(), parameters.angular.z.limiter())
            self._declare_command("cmd_vel", stamped=parameters.use_stamped_vel, timeout=0.0)
            self._efficiency = self.declare_topic_input(_EFFICIENCY, _FLOAT)
            self._declare_odometry("odom")

    def start(self, context: Context) -> TracksMemory:
        """Return a memory with tracks that stand still; the odometries continue from the last activation."""
        time, parameters = context.get_time(), self.setup.parameters
        before: TracksMemory | None = self.sample(context).memory
        efficiency = parameters.steering_efficiency
        if before is None:
            tracks = (TrackMemory(time=time, next_publication=time),) * len(self._names)
            return TracksMemory(WheelOdometry(time=time), time, tracks=tracks, efficiency=efficiency)
        tracks = tuple(replace(track, wanted=0.0, time=time, speed=0.0, before=0.0) for track in before.tracks)
        odometry = replace(before.odometry, time=time)
        return TracksMemory(odometry, time, published=before.published, tracks=tracks, efficiency=efficiency)

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """Return a twist as a command of the vehicle, and a number with an id.

        Raises:
            CommandError: If it is not finite, or an efficiency of zero or less.
        """
        if self.subscribed[topic] != _FLOAT:
            return super().read(topic, message, context)
        value = float(message.data)
        if not isfinite(value):
            raise CommandError(f"{topic}: {value:g} is not finite")
        if topic == _EFFICIENCY and value <= 0.0:
            raise CommandError(f"{topic}: {value:g} is not above zero")
        return TrackCommand(self.newest_id(context) + 1, value)

    def update(self, context: Context, time: float, memory: TracksMemory) -> Update:
        """Move the vehicle's odometry, and take the commands of the vehicle and of the tracks."""
        passed, used = time - self.sample(context).time, memory.used
        sent: tuple[float | None, ...] = (None, None)
        if self.setup.parameters.is_vehicle:
            memory, sent = self._driven(context, time, memory)
            used = memory.used
        tracks = []
        for index, track in enumerate(memory.tracks):
            track = replace(track, position=track.position + track.speed * passed)
            command = self.pending(context, self._commands[index])
            side = self._sides[index]
            if command is not None:
                track, used = replace(track, wanted=command.value, time=time), max(used, command.id)
            if side is not None and (speed := sent[side]) is not None:
                track = replace(track, wanted=speed, time=time)
            tracks.append(self._followed(index, track, time))
        return Update(replace(memory, tracks=tuple(tracks), used=used), ())

    def publication(self, topic: str, context: Context) -> Any:
        """Return the time at which the message of a topic was published (s); None before the first."""
        track = next((index for index, name in enumerate(self._names) if topic == f"{name}/{_ODOMETRY}"), None)
        if track is None:
            return super().publication(topic, context)
        published = self._published(context, track)
        return None if published is None else published[0]

    def _driven(
        self, context: Context, time: float, memory: TracksMemory
    ) -> tuple[TracksMemory, tuple[float | None, ...]]:
        """Return the memory with the vehicle's part of an update, and the speeds that its tracks are to have (m/s).

        They are None where its command is as before: gz-sim's vehicle sends what changes.
        """
        separation = self.setup.parameters.tracks_separation
        left, right = memory.sides
        odometry = memory.odometry.moved((left + right) / 2, (right - left) / separation, time)
        twist, efficiency = self.pending(context, self._command), self.pending(context, self._efficiency)
        limited = self._limited(self._wanted(context, time, memory) or (0.0, 0.0), memory)
        changes = any(abs(now - before) > _CHANGES for now, before in zip(limited, memory.last, strict=False))
        memory = replace(
            memory,
            odometry=odometry,
            used=max(memory.used, *(command.id for command in (twist, efficiency) if command is not None), 0),
            efficiency=memory.efficiency if efficiency is None else efficiency.value,
            last=limited,
            second_to_last=memory.last,
        )
        sent: tuple[float | None, ...] = (None, None)
        if changes or twist is not None or efficiency is not None:
            linear, angular = limited
            turning = angular * separation / (2 * memory.efficiency)
            memory = replace(memory, sides=(linear - turning, linear + turning))
            sent = memory.sides
        published = self._with_publication(memory, time)
        return replace(memory, published=published.published, next_publication=published.next_publication), sent

    def _followed(self, index: int, track: TrackMemory, time: float) -> TrackMemory:
        """Return a track with the speed that it has from a time on, and its odometry where it is due."""
        parameters = self.setup.parameters.tracks[self._names[index]]
        is_valid = time - track.time <= parameters.max_command_age + _SAME_TIME
        limiter, period = self._track_limiters[index], self.setup.update_period
        speed = limiter.limited(track.wanted if is_valid else 0.0, track.speed, track.before, period)
        track = replace(track, speed=speed, before=track.speed)
        if time < track.next_publication - _SAME_TIME:
            return track
        rate = parameters.odometry_publish_frequency
        due = track.next_publication + (1 / rate if rate else 0.0)
        following = due if due > time else time + (1 / rate if rate else 0.0)
        return replace(track, published=(time, track.position, speed), next_publication=following)

    def _published(self, context: Context, index: int) -> tuple[float, float, float] | None:
        memory: TracksMemory | None = self.sample(context).memory
        return None if memory is None else memory.tracks[index].published

    def _calc_surface_speeds(self, context: Context, output: BasicVector) -> None:
        sample = self.sample(context)
        if not sample.active or sample.memory is None:
            output.SetZero()
            return
        output.SetFromVector([track.speed for track in sample.memory.tracks])

    def _calc_track_odometry(self, index: int, context: Context, output: AbstractValue) -> None:
        published = self._published(context, index)
        if published is None:
            set_value(output, None)
            return
        time, position, speed = published
        pose = messages.Pose(messages.Point(x=position, y=0.0, z=0.0), messages.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0))
        no_covariance = np.zeros(36)
        output.set_value(
            messages.Odometry(
                header=messages.header(time),
                child_frame_id="",
                pose=messages.PoseWithCovariance(pose=pose, covariance=no_covariance.copy()),
                twist=messages.TwistWithCovariance(
                    twist=twist_message(speed, 0.0, 0.0), covariance=no_covariance.copy()
                ),
            )
        )


def _vector(values: tuple[float, ...]) -> Vector3:
    x, y, z = values
    return x, y, z
