"""Real robots that another twin moves, with other masses, dampings and frictions than the mirror's."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydrake.multibody.tree import PdControllerGains
from real_robot import COMMANDS, PLACE, Base, RealRobot
from robot_commands import arm_start
from robot_faults import Fault

from drake_twin import Twin
from drake_twin.builder.demo import demo_scenario
from drake_twin.scenario import Scenario

_CREEP = 1e-3  # velocity at which a joint has its full dry friction (rad/s)
_STUCK = 1e6  # damping (N·m·s/rad) and largest effort (N·m) of a joint that is stuck
_LIFT = 0.15  # height to which a rover is lifted (m)
_WHEELS = tuple(f"robot_1_{place}_wheel_joint" for place in ("front_left", "front_right", "rear_left", "rear_right"))
_ARM = ("joint_1", "joint_2", "joint_3", "joint_4")

# What differs from the files that the mirror has.
FRICTION = {"rover": dict.fromkeys(_WHEELS, 0.05), "arm": dict(zip(_ARM, (0.1, 0.15, 0.08, 0.01), strict=True))}  # N·m
VALUES = {
    "rover": {
        "friction": 0.75,  # in place of 1: nearly -20 % of what acts between wheels and ground
        "robot_1.base_link.mass": 13.44,  # kg: +12 %
        "robot_1.front_left_wheel_joint.damping": 0.04,  # N·m·s/rad, in place of 0.01
        "robot_1.front_right_wheel_joint.damping": 0.03,
        "robot_1.rear_left_wheel_joint.damping": 0.03,
        "robot_1.rear_right_wheel_joint.damping": 0.05,
    },
    "arm": {
        "robot_1.turret.mass": 0.9,  # kg: +12 %
        "robot_1.upper_arm.mass": 0.77,  # +10 %
        "robot_1.forearm.mass": 0.38,  # -5 %
        "robot_1.claw.payload": 0.1,
        "robot_1.joint_1.damping": 0.2,  # N·m·s/rad, in place of 0.1
        "robot_1.joint_2.damping": 0.25,
        "robot_1.joint_3.damping": 0.15,
    },
}
EFFORTS = {"rover": np.full(4, 2.0), "arm": np.array([0.3, 1.5, 1.2, 0.1, 0.0])}  # typical ones (N·m)
LIMITS = {"rover": (10.0,) * 4, "arm": (20.0, 20.0, 15.0, 5.0)}  # of the motors (N·m)
_TIME_STEP = 0.002  # s; the mirror's twin has half of it


class TwinBody:
    """The package's rover or arm in another twin.

    Args:
        kind: ``rover`` or ``arm``.
        scenario: The scenario with the real robot's parameters.
    """

    def __init__(self, kind: str, scenario: Scenario):
        self.kind = kind
        self.twin = Twin(scenario)
        self.joints = tuple(self.twin.joint_states("robot_1").name)
        self.commanded = _WHEELS if kind == "rover" else _ARM
        self.effort_sizes = EFFORTS[kind]
        self._friction = np.zeros(len(self.joints))  # N·m
        self._damping = np.zeros(len(self.joints))  # N·m·s/rad, up to the friction
        self._stuck: int | None = None
        self._command = [0.0] * len(self.commanded)
        self._lifted: tuple[np.ndarray, np.ndarray] | None = None  # from where, and its orientation

    @property
    def time(self) -> float:
        """True time (s)."""
        return self.twin.time

    def start(self, generator: np.random.Generator | None) -> None:
        """Return to the start."""
        self.twin.reset()
        self._stuck, self._command = None, [0.0] * len(self.commanded)
        for joint, friction in FRICTION[self.kind].items():
            self._brake(joint, friction, friction / _CREEP)
        if generator is None:
            return
        if self.kind == "arm":
            self.twin.entities.set_joint_positions("robot_1", dict(zip(_ARM, arm_start(generator), strict=True)))
        else:
            x, y, yaw = generator.uniform((-1, -1, -np.pi), (1, 1, np.pi))
            self.twin.entities.place("robot_1", (x, y, 0.13), (0, 0, yaw))

    def advance(self, time: float) -> None:
        """Move until a time (s)."""
        self.twin.advance_to(time)

    def command(self, velocities: Sequence[float]) -> None:
        """Drive the joints."""
        self._command = list(velocities)
        if self._stuck is not None:  # else it creeps: what its motor tries is said in `measured`
            velocities = [0.0 if index == self._stuck else value for index, value in enumerate(velocities)]
        self.twin.publish(COMMANDS, velocities)

    def measured(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return positions, velocities and efforts of all joints."""
        state = self.twin.joint_states("robot_1")
        velocity = np.array(state.velocity)
        # Drake gives both actuators of a joint, its motor and its dry friction, their sum as the effort.
        effort = state.effort + np.clip(self._damping * velocity, -self._friction, self._friction)
        if self._stuck is not None:  # the motor tries as hard as it can
            effort[self.joints.index(self.commanded[self._stuck])] = LIMITS[self.kind][self._stuck] * np.sign(
                self._command[self._stuck]
            )
        return np.array(state.position), velocity, effort

    def base(self) -> Base | None:
        """Return where the rover is; None of an arm."""
        if self.kind == "arm":
            return None
        message = self.twin.latest(PLACE)
        pose, twist = message.pose.pose, message.twist.twist
        vectors = [np.array([item.x, item.y, item.z]) for item in (pose.position, twist.linear, twist.angular)]
        q = pose.orientation
        return Base(vectors[0], np.array([q.w, q.x, q.y, q.z]), vectors[1], vectors[2])

    def begin(self, fault: Fault) -> None:
        """Let a fault begin."""
        joint = None if fault.joint is None else self.commanded[fault.joint]
        entities = self.twin.entities
        if fault.kind == "friction_risen":
            friction = FRICTION[self.kind][joint] + fault.size
            self._brake(joint, friction, friction / _CREEP)
        elif fault.kind == "joint_stuck":
            self._brake(joint, _STUCK, _STUCK)
            self._stuck = fault.joint
            self.command(self._command)
        elif fault.kind == "collision" and self.kind == "rover":
            toward = np.array([np.cos(fault.direction), np.sin(fault.direction), 0.0])
            at = -toward / max(abs(toward[:2]) / (0.29, 0.16))  # on the side of the chassis that is hit
            entities.apply_wrench("robot_1", fault.size * toward, (0, 0, 0), fault.until - fault.at, "robot_1", at)
        elif fault.kind == "collision":
            force = fault.size * np.array([0.0, np.cos(fault.direction), np.sin(fault.direction)])
            entities.apply_wrench(
                "robot_1::claw", force, (0, 0, 0), fault.until - fault.at, "robot_1::claw", (0.06, 0, 0)
            )
        elif fault.kind == "payload_changed":
            entities.set_values({"robot_1.claw.payload": VALUES["arm"]["robot_1.claw.payload"] + fault.size})
        elif fault.kind == "wheel_slip":
            entities.set_values({"friction": fault.size})
        elif fault.kind == "carried":
            state = entities.state("robot_1")
            self._lifted = np.array(state.position), np.array(state.orientation)
            self.go_on(fault)

    def go_on(self, fault: Fault) -> None:
        """Hold a rover that is carried where the hands have it by now: up, to the side, down."""
        if fault.kind != "carried":
            return
        assert self._lifted is not None
        place, (w, x, y, z) = self._lifted
        left = np.array([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 0.0])
        share = (self.time - fault.at) / (fault.until - fault.at)
        (up, rising), (aside, moving) = _smooth(share, 0.0, 0.25), _smooth(share, 0.15, 0.85)
        down, sinking = _smooth(share, 0.75, 1.0)
        above, lateral = np.array([0.0, 0.0, _LIFT]), fault.direction * fault.size * left / np.linalg.norm(left)
        velocity = (above * (rising - sinking) + lateral * moving) / (fault.until - fault.at)
        place = place + above * (up - down) + lateral * aside
        self.twin.entities.set_state("robot_1", place, (w, x, y, z), velocity, (0, 0, 0))

    def end(self, fault: Fault) -> None:
        """Let a rover go that was carried."""
        if fault.kind == "carried":
            self.go_on(fault)

    def close(self) -> None:
        """Free the twin's memory."""
        self.twin.close()

    def _brake(self, joint: str, friction: float, damping: float) -> None:
        """Give a joint another dry friction (N·m), which it has from a velocity of friction / damping on."""
        index = self.joints.index(joint)
        self._friction[index], self._damping[index] = friction, damping
        brake = self.twin.plant.GetJointActuatorByName(f"{joint}/friction")
        brake.set_effort_limit(friction)
        brake.set_controller_gains(PdControllerGains(p=0.0, d=damping))


def twin_robot(kind: str) -> RealRobot:
    """Return the rover or the arm, moved by another twin."""
    scenario = demo_scenario("rover" if kind == "rover" else "arduinobot", 1, drive=False)
    robot = replace(scenario.robots[0], joint_friction=FRICTION[kind])
    other = replace(scenario, robots=(robot,), values=VALUES[kind], time_step=_TIME_STEP)
    return RealRobot(TwinBody(kind, other), scenario)


def _smooth(share: float, first: float, last: float) -> tuple[float, float]:
    """Return how far a smooth motion from 0 to 1 is between two shares, and its rate."""
    t = min(max((share - first) / (last - first), 0.0), 1.0)
    return t * t * (3 - 2 * t), 6 * t * (1 - t) / (last - first)
