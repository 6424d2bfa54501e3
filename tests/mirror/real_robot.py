"""What a real robot would send, with noise, delays, a clock of its own, and faults: common to all ways to make it.

A `RealRobot` moves a `Body`, which is another twin or a robot in MuJoCo, with other parameters than those of the
scenario that a mirror is given. Random commands move it; what it measures is sent and heard later.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from robot_commands import random_commands
from robot_faults import Fault, fault_of

from drake_twin.messages.interface_types import make
from drake_twin.mirror.heard import Heard
from drake_twin.scenario import Scenario

ARRAY, STATES, ODOMETRY = "std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState", "nav_msgs/msg/Odometry"
COMMANDS, JOINT_STATES = "/robot_1/forward_velocity_controller/commands", "/robot_1/joint_states"
PLACE = "/robot_1/ground_truth/odom"

_ODOMETRY_LATER = 0.004  # s by which odometry is measured after joint states
_ACTION = 0.01  # s between two actions of a fault that goes on


@dataclass(frozen=True)
class Run:
    """The options of a run.

    Attributes:
        seed: Of commands, noise, network and the fault's joint. A healthy and a faulty run of one seed are the same up
            to the fault.
        duration: How long (s).
        fault: One of `robot_faults.FAULTS`; None for a healthy robot.
        at: When the fault begins (s of true time).
        size: The fault's size; by default that of the table in `robot_faults`.
        joint_rate: Joint states per second.
        odometry_rate: Odometry messages per second.
        position_noise: Of joint positions (rad).
        velocity_noise: Of joint velocities (rad/s).
        effort_noise: Of efforts, as a part of their typical size.
        place_noise: Of the odometry's position (m).
        angle_noise: Of its angles (rad).
        linear_noise: Of its velocity (m/s).
        angular_noise: Of its angular velocity (rad/s).
        command_delay: How much later than a command is sent the robot acts (s).
        least_delay: The least delay of the network (s).
        mean_delay: The mean of what comes on top of it, exponentially distributed (s): measurements may overtake.
        loss: The part of all messages that is never heard.
        clock_offset: What the robot's clock shows at the true time zero (s).
        clock_drift: By how much it is too fast, as a part: it shows ``time * (1 + drift) + offset``.
        elsewhere: Whether the robot starts at a random place of its range, and not as the scenario has it.
        commanded: The times at which commands are sent (s), and the velocities (rad/s); random by default.
    """

    seed: int = 0
    duration: float = 9.0
    fault: str | None = None
    at: float = 5.0
    size: float | None = None
    joint_rate: float = 50.0
    odometry_rate: float = 20.0
    position_noise: float = 1e-3
    velocity_noise: float = 5e-3
    effort_noise: float = 0.02
    place_noise: float = 5e-3
    angle_noise: float = 5e-3
    linear_noise: float = 0.01
    angular_noise: float = 0.01
    command_delay: float = 0.02
    least_delay: float = 1e-3
    mean_delay: float = 2e-3
    loss: float = 0.0
    clock_offset: float = 0.2
    clock_drift: float = 100e-6
    elsewhere: bool = False
    commanded: Sequence[tuple[float, Sequence[float]]] | None = None

    def stamp(self, time: float) -> dict[str, int]:
        """Return what the robot's clock shows at a true time (s), as a stamp."""
        nanoseconds = round((time * (1 + self.clock_drift) + self.clock_offset) * 1e9)
        return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


class Base(NamedTuple):
    """Pose of a rover in the world (m, quaternion w x y z), and its velocities in its own axes (m/s, rad/s)."""

    position: np.ndarray
    orientation: np.ndarray
    linear: np.ndarray
    angular: np.ndarray


class Body(Protocol):
    """The moving robot without its sensors, clock and network.

    Attributes:
        kind: ``rover`` or ``arm``.
        joints: All joints that it reports.
        commanded: Those that are commanded.
        effort_sizes: A typical effort of each joint that it reports (N·m).
        time: True time (s).
    """

    kind: str
    joints: tuple[str, ...]
    commanded: tuple[str, ...]
    effort_sizes: np.ndarray

    @property
    def time(self) -> float: ...

    def start(self, generator: np.random.Generator | None) -> None:
        """Return to the start at time zero, or with a generator to a random place."""

    def advance(self, time: float) -> None:
        """Move until a time (s)."""

    def command(self, velocities: Sequence[float]) -> None:
        """Drive the commanded joints with these velocities (rad/s)."""

    def measured(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return positions (rad), velocities (rad/s) and efforts (N·m, NaN without a motor) of all joints."""

    def base(self) -> Base | None:
        """Return where it is; None of what stands in one place."""

    def begin(self, fault: Fault) -> None:
        """Let a fault of the body begin; the others are made here."""

    def go_on(self, fault: Fault) -> None:
        """Go on with one that has an end, a few milliseconds later."""

    def end(self, fault: Fault) -> None:
        """End one that has an end."""


@dataclass
class Truth:
    """What really happened in a run.

    Attributes:
        times: The true times at which joint states were measured (s), shape (N,).
        positions: The joints' positions then (rad), shape (N, J).
        velocities: Their velocities (rad/s).
        efforts: Their efforts (N·m).
        base_times: The true times of the odometry (s), shape (M,).
        base: x, y, z (m) and yaw (rad) of the base then, shape (M, 4).
        commands: The times at which commands were sent (s), and the commanded velocities (rad/s).
        fault: The fault with its joint and size.
        joint: The name of the fault's joint.
    """

    times: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    efforts: np.ndarray
    base_times: np.ndarray
    base: np.ndarray
    commands: list[tuple[float, np.ndarray]]
    fault: Fault | None
    joint: str | None


class RealRobot:
    """A robot as it is heard.

    Args:
        body: What moves.
        scenario: What a mirror is given: the nominal robot.

    Attributes:
        truth: What really happened in the last run.
    """

    def __init__(self, body: Body, scenario: Scenario):
        self.body, self.scenario = body, scenario
        self.truth: Truth | None = None

    @property
    def kind(self) -> str:
        """``rover`` or ``arm``, of which `robot_faults.FAULTS` has the faults."""
        return self.body.kind

    def run(self, run: Run) -> list[Heard]:
        """Run and return what was heard, in the order in which it was.

        Raises:
            ValueError: If the robot does not have this fault.
        """
        recorder = _Recorder(self.body, run)
        body, fault = self.body, recorder.fault
        body.start(np.random.default_rng([run.seed, 4]) if run.elsewhere else None)
        for time, _, act in sorted(recorder.events(), key=lambda event: event[:2]):
            if time > body.time + 1e-9:
                body.advance(time)
            act()
        self.truth = recorder.truth(None if fault is None or fault.joint is None else body.commanded[fault.joint])
        return sorted(recorder.heard, key=lambda heard: heard.received)

    def close(self) -> None:
        """Free the body's memory."""
        getattr(self.body, "close", lambda: None)()


class _Recorder:
    """One run: what happens at which time, and what is heard of it."""

    def __init__(self, body: Body, run: Run):
        self._body, self._run = body, run
        self.fault = fault_of(body.kind, run.fault, run.at, run.size, run.seed, len(body.commanded))
        self.heard: list[Heard] = []
        self._sent = list(
            random_commands(body.kind, run.seed, run.duration, elsewhere=run.elsewhere)
            if run.commanded is None
            else ((time, np.array(velocities, dtype=float)) for time, velocities in run.commanded)
        )
        self._command = np.zeros(len(body.commanded))  # the last one that arrived
        self._noise, self._network = (np.random.default_rng([run.seed, stream]) for stream in (2, 3))
        self._place = [body.joints.index(name) for name in body.commanded]
        self._frozen: tuple[float, float] | None = None
        self._last_reported: tuple[np.ndarray, np.ndarray] | None = None
        self._commanded_at = 0.0
        self._states: list[tuple[Any, ...]] = []
        self._bases: list[tuple[float, list[float]]] = []

    # What happens ----------------------------------------------------------------------------------------------------

    def events(self) -> Iterator[tuple[float, int, Callable[[], None]]]:
        """Yield all events: the time (s), their order at one time, and what happens."""
        run, fault = self._run, self.fault
        for time, velocities in self._sent:
            late = run.command_delay + (fault.size if fault and fault.acts("delay", time=time) else 0.0)
            message = make(ARRAY, {"data": velocities.tolist()})
            yield time, 3, lambda message=message: self._send(COMMANDS, ARRAY, message)
            if time + late < run.duration:
                yield time + late, 1, lambda velocities=velocities: self._arrive(velocities)
        for index in range(int(run.duration * run.joint_rate)):
            yield index / run.joint_rate, 2, self._measure
        if self._body.kind == "rover":
            for index in range(int((run.duration - _ODOMETRY_LATER) * run.odometry_rate)):
                yield index / run.odometry_rate + _ODOMETRY_LATER, 2, self._locate
        if fault is not None and fault.at < run.duration:
            yield fault.at, 0, self._begin
            if np.isfinite(fault.until):
                ahead = np.arange(fault.at + _ACTION, min(fault.until, run.duration) - _ACTION / 2, _ACTION)
                yield from ((float(time), 0, lambda: self._body.go_on(fault)) for time in ahead)
                if fault.until < run.duration:
                    yield fault.until, 0, lambda: self._body.end(fault)
        yield run.duration, 9, lambda: None

    def _arrive(self, velocities: np.ndarray) -> None:
        self._command = velocities
        self._drive()

    def _drive(self) -> None:
        """Drive the joints as they are told, or as the fault has it."""
        fault, velocities = self.fault, self._command.copy()
        if fault is not None and fault.acts("emergency_stop", time=self._body.time + 1e-9):
            velocities[:] = 0.0
        elif fault is not None and fault.acts("motor_weak", time=self._body.time + 1e-9):
            velocities[fault.joint] *= fault.size
        self._body.command(velocities.tolist())

    def _begin(self) -> None:
        fault = self.fault
        assert fault is not None
        if fault.kind in ("emergency_stop", "motor_weak"):
            self._drive()
        elif fault.kind == "encoder_frozen" and self._last_reported is not None:
            position, velocity = self._last_reported
            self._frozen = position[self._place[fault.joint]], velocity[self._place[fault.joint]]
        else:
            self._body.begin(fault)

    # What is sent ----------------------------------------------------------------------------------------------------

    def _send(self, topic: str, kind: str, message: Any) -> None:
        """Let a message be heard, unless it is lost."""
        run, time = self._run, self._body.time
        late = run.least_delay + self._network.exponential(run.mean_delay)
        is_lost = self._network.random() < run.loss
        if self.fault is not None and topic != COMMANDS:
            is_lost = is_lost or self.fault.acts("connection_lost", time=time + 1e-9)
        received = float(time + late)
        if topic == COMMANDS:  # a reliable topic keeps its order, and only the order tells which command is the last
            self._commanded_at = received = max(received, self._commanded_at)
        if not is_lost:
            self.heard.append(Heard(received, topic, kind, message))

    def _measure(self) -> None:
        run, body, fault, time = self._run, self._body, self.fault, self._body.time
        position, velocity, effort = body.measured()
        self._states.append((time, position, velocity, effort))
        factor = np.ones(len(body.joints))
        if fault is not None and fault.acts("noise_risen", time=time + 1e-9):
            factor[self._place if fault.joint is None else self._place[fault.joint]] = fault.size
        noise = self._noise.normal(size=(3, len(body.joints)))
        position = position + factor * run.position_noise * noise[0]
        velocity = velocity + factor * run.velocity_noise * noise[1]
        effort = effort + run.effort_noise * body.effort_sizes * noise[2]
        if fault is not None and fault.joint is not None and fault.at <= time + 1e-9:
            joint = self._place[fault.joint]
            position[joint] += fault.size if fault.kind == "encoder_offset" else 0.0
            effort[joint] += fault.size if fault.kind == "effort_offset" else 0.0
            if self._frozen is not None:
                position[joint], velocity[joint] = self._frozen
        self._last_reported = position, velocity
        header = {"stamp": run.stamp(time)}
        fields = {"header": header, "name": body.joints, "position": position, "velocity": velocity, "effort": effort}
        self._send(JOINT_STATES, STATES, make(STATES, fields))

    def _locate(self) -> None:
        run, time, base = self._run, self._body.time, self._body.base()
        assert base is not None
        w, x, y, z = base.orientation
        self._bases.append((time, [*base.position, np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))]))
        noise = self._noise.normal(size=(4, 3))
        place = base.position + run.place_noise * noise[0]
        turned = _turned(base.orientation, run.angle_noise * noise[1])
        linear, angular = base.linear + run.linear_noise * noise[2], base.angular + run.angular_noise * noise[3]
        pose = {"position": _xyz(place), "orientation": dict(zip("wxyz", turned.tolist(), strict=True))}
        fields = {
            "header": {"stamp": run.stamp(time), "frame_id": "world"},
            "child_frame_id": "robot_1_base_link",
            "pose": {"pose": pose},
            "twist": {"twist": {"linear": _xyz(linear), "angular": _xyz(angular)}},
        }
        self._send(PLACE, ODOMETRY, make(ODOMETRY, fields))

    def truth(self, joint: str | None) -> Truth:
        """Return what really happened."""
        numbers = [np.array([state[index] for state in self._states]) for index in range(4)]
        times, bases = (np.array([item[index] for item in self._bases]) for index in range(2))
        return Truth(*numbers, times, bases.reshape(-1, 4), self._sent, self.fault, joint)


def _xyz(vector: np.ndarray) -> dict[str, float]:
    return dict(zip("xyz", vector.tolist(), strict=True))


def _turned(q: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Return a quaternion (w, x, y, z) that is turned further by a small rotation vector (rad)."""
    w, x, y, z = q
    a, b, c = by / 2
    more = np.array([-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a])
    turned = q + more
    return turned / np.linalg.norm(turned)


def real(name: str) -> RealRobot:
    """Return a robot: ``rover`` or ``arm``, which another twin moves, or ``mujoco_arm``."""
    if name == "mujoco_arm":
        from real_by_mujoco import mujoco_arm

        return mujoco_arm()
    from real_by_twin import twin_robot

    return twin_robot(name)
