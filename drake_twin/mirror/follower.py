"""A twin whose state follows a robot's: an observer over the twin's own physics.

The twin hears the robot's commands and moves as its physics says. Whenever something was measured, the difference to
what the twin has then is taken note of, and a part of it is made good (a Luenberger observer of stated gains):

    q ← q + a (q_measured − q),  v ← v + a (v_measured − v),  a = 1 − exp(−T / time constant)

with T since the last measurement; of a position at least so much that twice the measurement's noise is left. A servo
that holds a position would draw its joint back: its set-point is shifted by the same difference, more slowly. What is
not measured, such as other joints or the tilt of a base, follows from the model.
"""

from collections.abc import Mapping
from math import atan2, copysign, cos, exp, isfinite, pi, sin, tau

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.calibration.measured import NUMBERS
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.mirror.joint_observer import JointObserver, RunningNoise, followed
from drake_twin.mirror.watched import INERTIAL, JOINTS, POSE, Watched
from drake_twin.twin.twin import Twin

_FAR = {"rad": 0.5, "m": 0.25, "place": 0.5, "angle": 0.7}  # further off than that, it is set where it was measured
_MANY = 3  # times one after the other that it has to be
_GAP = 0.5  # s without a measurement, after which the next one counts whole
_SAME = 0.05  # m or rad
_LEVEL = 5.0  # s in which the height of a frame is found


@dataclass(frozen=True)
class Gains:
    """How fast the twin follows what is measured.

    Attributes:
        joints: The time constant of joints' positions and velocities (s).
        servos: That of servos' set-points (s).
        base: That of the base's place and heading (s).
    """

    joints: float = 0.1
    servos: float = 1.0
    base: float = 0.25


@dataclass(frozen=True)
class Innovation:
    """What was measured at one moment, beside what the twin had before it followed.

    Attributes:
        time: The twin's time (s).
        watched: The topic.
        measured: Name of a number → what was measured.
        predicted: Name of a number → what the twin had; also of numbers that were not measured.
        caught_up: Whether the twin was set where the robot is, as it was far off.
    """

    time: float
    watched: Watched
    measured: Mapping[str, float]
    predicted: Mapping[str, float]
    caught_up: bool = False


@dataclass(frozen=True)
class Measured:
    """Where a robot was measured last.

    Attributes:
        positions: Joint → its position (rad or m).
        place: x, y (m) and yaw (rad) of the root link in the twin's world; None before it was measured.
    """

    positions: Mapping[str, float]
    place: tuple[float, float, float] | None = None


class Follower:
    """Lets a twin follow a robot.

    Args:
        twin: The twin; its scenario's own commands should be left out.
        gains: How fast it follows.

    Attributes:
        twin: The twin.
        catches: How often it was set where the robot is, since it began.
        notes: What was noticed of the measurements.
        measured: Robot → where it was measured last.
    """

    def __init__(self, twin: Twin, gains: Gains | None = None):
        self.twin = twin
        self._gains = gains or Gains()
        self._last: dict[str, float] = {}
        self._far: dict[str, int] = {}
        self._frames: dict[str, tuple[float, ...]] = {}  # topic → its frame in the world: x, y, yaw, z
        self._joints = {
            plan.name: {joint.name: joint for joint in plan.description.movable_joints} for plan in twin.built.plans
        }
        self._levels: dict[str, int] = {}
        self.catches = 0
        self.notes: list[str] = []
        self.measured: dict[str, Measured] = {}
        self._noise: dict[tuple[str, str], RunningNoise] = {}
        self._observers: dict[str, JointObserver] = {}

    def advance_to(self, time: float) -> None:
        """Let the twin's time pass; times that have passed are now."""
        if time > self.twin.time:
            self.twin.advance_to(time)

    def measure(self, time: float, watched: Watched, message: object) -> Innovation | None:
        """Compare a measurement with the twin, and follow it.

        Args:
            time: When it was measured, in the twin's time (s).
            watched: Its topic.
            message: Its message.

        Returns:
            What was measured and predicted; None of a message without a number that the twin has.
        """
        self.advance_to(time)
        numbers = {name: value for name, value in NUMBERS[watched.type](message).items() if isfinite(value)}
        since = time - self._last.get(watched.topic, -1e9)
        self._last[watched.topic] = time
        follow = {JOINTS: self._follow_joints, POSE: self._follow_pose, INERTIAL: self._follow_nothing}[watched.kind]
        return follow(time, watched, numbers, since)

    # Joints ----------------------------------------------------------------------------------------------------------

    def _follow_joints(
        self, time: float, watched: Watched, numbers: Mapping[str, float], since: float
    ) -> Innovation | None:
        joints = self._joints[watched.robot]
        if watched.robot not in self._observers:
            self._begin(watched, numbers)
        state = self.twin.robot_state(watched.robot)
        own = dict(zip(state.joints, zip(state.positions, state.velocities, state.efforts, strict=True), strict=True))
        predicted: dict[str, float] = {}
        measured: dict[str, float] = {}
        far = False
        for name, value in numbers.items():
            joint, _, kind = name.rpartition(".")
            if joint not in own:
                continue
            for what, number in zip(("position", "velocity", "effort"), own[joint], strict=True):
                predicted[f"{joint}.{what}"] = number
            measured[name] = value
            if kind == "position":
                if joints[joint].type == "continuous":
                    measured[name] = predicted[name] + _turned(value - predicted[name])
                unit = "m" if joints[joint].type == "prismatic" else "rad"
                far = far or abs(measured[name] - predicted[name]) > _FAR[unit]
        if not measured:
            return None
        before = self.measured.get(watched.robot, Measured({}))
        at = {name.removesuffix(".position"): value for name, value in measured.items() if name.endswith(".position")}
        self.measured[watched.robot] = Measured({**before.positions, **at}, before.place)
        caught = self._is_caught(watched.topic, far, since)
        self._observers[watched.robot].correct(measured, predicted, since, whole=caught)
        return Innovation(time, watched, measured, predicted, caught)

    def _begin(self, watched: Watched, numbers: Mapping[str, float]) -> None:
        """Look at the first joint states.

        Raises:
            InputError: If they are of another robot, or in degrees.
        """
        joints = self._joints[watched.robot]
        named = {name.rpartition(".")[0] for name in numbers}
        if not named & joints.keys():
            what = (
                f"{watched.topic} has the joints {', '.join(sorted(named)) or 'none'}, none of them of {watched.robot}"
            )
            raise InputError(what, valid=joints)
        for name in sorted(named & joints.keys()):
            limits, at = joints[name].limits, abs(numbers.get(f"{name}.position", 0.0))
            most = max(abs(limits.lower), abs(limits.upper))
            if joints[name].type == "revolute" and at > max(3 * most, tau):
                text = f"{watched.topic}: {name} is at {at:.4g} rad, and its limits are {limits.lower:g} to"
                raise InputError(f"{text} {limits.upper:g}: are its positions in degrees? ROS has radians")
        if missing := sorted(joints.keys() - named):
            self.notes.append(f"{', '.join(missing)} are not measured on {watched.topic}: they follow from the model")
        gains = self._gains
        self._observers[watched.robot] = JointObserver(self.twin, watched.robot, gains.joints, gains.servos)

    # The base --------------------------------------------------------------------------------------------------------

    def _follow_pose(
        self, time: float, watched: Watched, numbers: Mapping[str, float], since: float
    ) -> Innovation | None:
        if not {"x", "y", "yaw"} <= numbers.keys():
            return None
        twin = self.twin
        plan = next(plan for plan in twin.built.plans if plan.name == watched.robot)
        body = twin.plant.GetBodyByName(plan.model.root_body, twin.built.robots[watched.robot].instance)
        context = twin.plant.GetMyMutableContextFromRoot(twin.context)
        X = body.EvalPoseInWorld(context)
        R = X.rotation().matrix()
        x, y, z = X.translation().tolist()
        yaw = atan2(R[1, 0], R[0, 0])
        frame = self._frames.get(watched.topic)
        if frame is None:  # the topic's frame lies as the twin stands at the start
            turn = _turned(yaw - numbers["yaw"])
            if max(abs(x - numbers["x"]), abs(y - numbers["y"]), abs(turn)) < _SAME:
                east = north = turn = 0.0  # it is the world, as far as its noise tells
            else:
                east, north = x - _east(turn, numbers), y - _north(turn, numbers)
            frame = east, north, turn, z - numbers.get("z", 0.0)
            self._frames[watched.topic] = frame
        there = frame[0] + _east(frame[2], numbers), frame[1] + _north(frame[2], numbers), numbers["yaw"] + frame[2]
        known = self.measured.get(watched.robot, Measured({}))
        self.measured[watched.robot] = Measured(known.positions, there)
        dx, dy, turned = there[0] - x, there[1] - y, _turned(there[2] - yaw)
        ahead, left = dx * cos(yaw) + dy * sin(yaw), dy * cos(yaw) - dx * sin(yaw)
        up = numbers.get("z", 0.0) + frame[3] - z
        count = self._levels[watched.topic] = self._levels.get(watched.topic, 0) + 1
        level = max(1.0 / count, 1.0 - exp(-since / _LEVEL))  # at first the mean, for the first one is noisy, too
        self._frames[watched.topic] = (*frame[:3], frame[3] - up * level)
        measured = {"ahead": ahead, "left": left, "yaw": turned, "up": up}
        predicted = dict.fromkeys(measured, 0.0)
        V = body.EvalSpatialVelocityInWorld(context)  # a twist is in the base's frame
        v, w = R.T @ V.translational(), R.T @ V.rotational()
        for name, value in (("linear.x", v[0]), ("linear.y", v[1]), ("angular.z", w[2])):
            predicted[name] = float(value)
            if name in numbers:
                measured[name] = numbers[name]
        far = max(abs(dx), abs(dy)) > _FAR["place"] or abs(turned) > _FAR["angle"]
        caught = self._is_caught(watched.topic, far, since)
        if body.is_floating_base_body():
            part = 1.0 if caught else 1.0 - exp(-since / self._gains.base)
            noises = [self._noise.setdefault((watched.topic, name), RunningNoise()) for name in ("x", "y", "yaw")]
            ways = [
                difference if caught else followed(difference, part, noise.add(at))
                for difference, noise, at in zip((dx, dy, turned), noises, there, strict=True)
            ]
            about = RotationMatrix.MakeZRotation(ways[2])
            place = X.translation() + np.array([ways[0], ways[1], 0.0])
            speed = body.EvalSpatialVelocityInWorld(context)
            twin.plant.SetFreeBodyPose(context, body, RigidTransform(about @ X.rotation(), place))
            twin.plant.SetFreeBodySpatialVelocity(context, body, speed.Rotate(about))
        return Innovation(time, watched, measured, predicted, caught)

    # The inertial unit -----------------------------------------------------------------------------------------------

    def _follow_nothing(
        self, time: float, watched: Watched, numbers: Mapping[str, float], since: float
    ) -> Innovation | None:
        message = self.twin.latest(watched.twin_topic)
        if message is None:
            return None
        predicted = {name: value for name, value in NUMBERS[watched.type](message).items() if isfinite(value)}
        measured = {name: value for name, value in numbers.items() if name in predicted}
        return Innovation(time, watched, measured, predicted) if measured else None

    def _is_caught(self, topic: str, far: bool, since: float) -> bool:
        """Return whether the twin is to be set where the robot is; the first measurement does so, too."""
        self._far[topic] = self._far.get(topic, 0) + 1 if far else 0
        if since < _GAP and self._far[topic] < _MANY:
            return False
        self.catches += since < 1e8
        self._far[topic] = 0
        return True


def _turned(angle: float) -> float:
    """Return an angle without whole turns, from −π to π."""
    return angle - copysign(tau, angle) * int((abs(angle) + pi) / tau)


def _east(turn: float, numbers: Mapping[str, float]) -> float:
    return cos(turn) * numbers["x"] - sin(turn) * numbers["y"]


def _north(turn: float, numbers: Mapping[str, float]) -> float:
    return sin(turn) * numbers["x"] + cos(turn) * numbers["y"]
