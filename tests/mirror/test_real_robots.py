"""The robots that the mirror's tests hear send what they say, and each of their faults is in it."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from real_robot import COMMANDS, JOINT_STATES, PLACE, RealRobot, Run, real
from robot_faults import EVERY_ROBOT, FAULTS, fault_of

from drake_twin.messages.text import plain_data
from drake_twin.mirror.heard import Heard

AT, SHORT = 1.5, 3.6  # s: when a fault begins, and how long a run lasts
NAMES = ("rover", "arm", "mujoco_arm")


@cache
def robot(name: str) -> RealRobot:
    if name == "mujoco_arm":
        pytest.importorskip("mujoco")
    return real(name)


class States(NamedTuple):
    """Joint states in the order of their stamps: arrays of shape (N,) and (N, J)."""

    received: np.ndarray
    stamps: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray


def states(heard: list[Heard]) -> States:
    own = sorted((item for item in heard if item.topic == JOINT_STATES), key=lambda item: item.stamp)
    numbers = ([getattr(item.message, kind) for item in own] for kind in ("position", "velocity", "effort"))
    times = [item.received for item in own], [item.stamp for item in own]
    return States(*map(np.array, times), *map(np.array, numbers))


def odometry(heard: list[Heard]) -> list[Any]:
    return [item.message for item in sorted(heard, key=lambda item: item.received) if item.topic == PLACE]


@pytest.mark.parametrize("name", NAMES)
def test_it_sends_at_its_rates_with_its_own_clock_and_the_network_is_late(name):
    one = robot(name)
    heard = one.run(Run(seed=1, duration=SHORT, clock_offset=0.3, clock_drift=2e-3))
    assert [item.received for item in heard] == sorted(item.received for item in heard)
    own, truth = states(heard), one.truth
    assert len(own.stamps) == round(SHORT * 50)
    assert np.allclose(np.diff(truth.times), 0.02)
    drift, offset = np.polyfit(truth.times, own.stamps, 1)
    assert (drift, offset) == (pytest.approx(1 + 2e-3, abs=1e-6), pytest.approx(0.3, abs=1e-6))
    late = own.received - truth.times
    assert late.min() >= 1e-3
    assert late.mean() == pytest.approx(3e-3, rel=0.3)
    if name == "rover":
        assert len(odometry(heard)) == pytest.approx(SHORT * 20, abs=1)
    commands = [item for item in heard if item.topic == COMMANDS]
    assert [len(plain_data(item.message)["data"]) for item in commands] == [4] * len(truth.commands)


def test_messages_overtake_each_other_and_are_lost_where_the_network_is_bad():
    heard = robot("arm").run(Run(duration=SHORT, mean_delay=0.03, loss=0.2))
    stamps = [item.stamp for item in heard if item.topic == JOINT_STATES]
    assert stamps != sorted(stamps)
    assert len(stamps) == pytest.approx(0.8 * SHORT * 50, abs=25)


@pytest.mark.parametrize("name", NAMES)
def test_its_noise_is_as_large_as_it_says(name):
    one = robot(name)
    heard = one.run(Run(seed=2, duration=SHORT))
    own, truth, sizes = states(heard), one.truth, one.body.effort_sizes
    assert np.std(own.position - truth.positions) == pytest.approx(1e-3, rel=0.1)
    assert np.std(own.velocity - truth.velocities) == pytest.approx(5e-3, rel=0.1)
    assert np.nanstd((own.effort - truth.efforts)[:, :4] / sizes[:4]) == pytest.approx(0.02, rel=0.1)
    assert np.all(np.sqrt(np.mean(truth.efforts[:, :4] ** 2, axis=0)) < 4 * sizes[:4])
    if name == "rover":
        places = np.array([[item.pose.pose.position.x, item.pose.pose.position.y] for item in odometry(heard)])
        assert np.std(places - truth.base[:, :2]) == pytest.approx(5e-3, rel=0.25)
        turns = [item.pose.pose.orientation for item in odometry(heard)]
        yaw = np.array([2 * np.arctan2(item.z, item.w) for item in turns])
        assert np.std(np.angle(np.exp(1j * (yaw - truth.base[:, 3])))) == pytest.approx(5e-3, rel=0.25)


@pytest.mark.parametrize("name", NAMES)
def test_it_does_what_it_is_told_a_little_later(name):
    one = robot(name)
    wanted = [0.4, 0.3, -0.3, 0.2] if name != "rover" else [5.0, 4.0, 5.0, 4.0]
    one.run(Run(duration=1.0, commanded=[(0.5, wanted)], command_delay=0.1))
    times, velocities = one.truth.times, one.truth.velocities[:, :4]
    assert np.abs(velocities[(times > 0.2) & (times <= 0.6)]).max() < 0.02
    assert velocities[times > 0.8].mean(axis=0) == pytest.approx(wanted, rel=0.05)


@pytest.mark.parametrize("name", NAMES)
def test_a_run_is_repeatable_and_another_seed_moves_it_otherwise(name):
    one = robot(name)
    first, again, other = (states(one.run(Run(seed=seed, duration=1.5))) for seed in (3, 3, 4))
    assert all(np.array_equal(mine, its, equal_nan=True) for mine, its in zip(first, again, strict=True))
    assert np.abs(first.velocity - other.velocity).max() > 0.3
    one.run(Run(seed=3, duration=0.1, elsewhere=True))
    start = one.truth.base[0] if name == "rover" else one.truth.positions[0]
    assert np.abs(start).max() > 0.1
    one.run(Run(duration=0.1))
    assert np.abs(one.truth.positions[0]).max() < 0.01


def test_each_robot_has_twelve_faults_and_no_others():
    assert {kind: len(set(faults)) for kind, faults in FAULTS.items()} == {"rover": 12, "arm": 12}
    with pytest.raises(ValueError, match="carried"):
        fault_of("arm", "carried", 1.0, None, 0, 4)
    joints = {fault_of("arm", "joint_stuck", 1.0, None, seed, 4).joint for seed in range(20)}
    assert joints == {0, 1, 2, 3}


class Case(NamedTuple):
    """A faulty run beside the healthy one of the same seed, from the fault on."""

    robot: RealRobot
    heard: list[Heard]
    healthy: States
    faulty: States
    joint: int | None
    size: float
    times: np.ndarray

    def difference(self, kind: str) -> np.ndarray:
        return getattr(self.faulty, kind) - getattr(self.healthy, kind)


@cache
def healthy_states(name: str, seed: int) -> States:
    return states(robot(name).run(Run(seed=seed, duration=SHORT)))


def case(name: str, kind: str, seed: int) -> Case:
    one, healthy = robot(name), healthy_states(name, seed)
    heard = one.run(Run(seed=seed, duration=SHORT, fault=kind, at=AT))
    faulty, truth = states(heard), one.truth
    before = truth.times < AT - 1e-9
    assert np.array_equal(faulty.position[: before.sum()], healthy.position[before])
    if kind == "connection_lost":
        return Case(one, heard, healthy, faulty, None, 1.0, truth.times)
    joint = None if truth.joint is None else one.body.joints.index(truth.joint)
    after = [States(*(array[~before] for array in own)) for own in (healthy, faulty)]
    return Case(one, heard, *after, joint, truth.fault.size, truth.times[~before])


def _friction_risen(run: Case) -> None:
    moves = np.abs(run.healthy.velocity[:, run.joint]) > 0.1
    which = slice(4) if run.robot.kind == "rover" else [run.joint]  # the ground shares it among the wheels
    along = np.sign(run.healthy.velocity[moves, run.joint]) * run.difference("effort")[moves][:, which].sum(axis=1)
    assert np.median(along) == pytest.approx(run.size, rel=0.25)


def _joint_stuck(run: Case) -> None:
    assert np.ptp(run.faulty.position[5:, run.joint]) < 0.01
    assert np.ptp(run.healthy.position[:, run.joint]) > 0.1
    assert np.nanmax(np.abs(run.faulty.effort[:, run.joint])) > 4 * run.robot.body.effort_sizes[run.joint]


def _encoder_offset(run: Case) -> None:
    assert run.difference("position")[:, run.joint] == pytest.approx(run.size)
    assert np.all(run.difference("velocity") == 0.0)


def _encoder_frozen(run: Case) -> None:
    others = np.arange(len(run.robot.body.joints)) != run.joint
    for numbers in (run.faulty.position, run.faulty.velocity):
        assert len(set(numbers[:, run.joint])) == 1
        assert len(set(numbers[:, np.flatnonzero(others)[0]])) == len(numbers)
    assert np.all(run.difference("position")[:, others] == 0.0)
    assert np.array_equal(run.difference("effort"), run.healthy.effort * 0.0, equal_nan=True)


def _noise_risen(run: Case) -> None:
    joint = 0 if run.joint is None else run.joint
    truth = run.robot.truth
    left = run.faulty.position - truth.positions[-len(run.times) :]
    assert np.std(left[:, joint]) == pytest.approx(5e-3, rel=0.25)
    assert np.std((run.faulty.velocity - truth.velocities[-len(run.times) :])[:, joint]) == pytest.approx(
        0.025, rel=0.25
    )


def _delay(run: Case) -> None:
    sent = run.robot.truth.commands
    at = np.array([time for time, _ in sent])

    def left(late: float) -> float:
        """What a delay leaves of the difference between the velocities and those commanded."""
        which = np.maximum(np.searchsorted(at, run.times - late, side="right") - 1, 0)
        wanted = np.array([sent[index][1] for index in which])
        return float(np.mean((run.faulty.velocity[:, :4] - wanted)[run.times > AT + 0.3] ** 2))

    lates = np.arange(0.0, 0.3, 0.01)
    servo = 0.0 if run.robot is robot("arm") or run.robot is robot("rover") else 0.03  # how late it is itself
    assert lates[np.argmin([left(late) for late in lates])] == pytest.approx(0.02 + 0.15 + servo, abs=0.02)


def _motor_weak(run: Case) -> None:
    healthy, faulty = run.healthy.velocity[10:, run.joint], run.faulty.velocity[10:, run.joint]
    assert np.dot(healthy, faulty) / np.dot(healthy, healthy) == pytest.approx(0.6, abs=0.06)


def _collision(run: Case) -> None:
    during = run.times < run.robot.truth.fault.until
    largest = np.nanmax(np.abs(run.difference("effort")[:, :4]), axis=1)
    assert np.median(largest[during][3:]) > 0.5 * run.robot.body.effort_sizes[:4].max()
    if run.robot.kind == "arm":
        assert np.median(largest[~during][-20:]) < 0.3 * np.median(largest[during][3:])


def _emergency_stop(run: Case) -> None:
    assert np.abs(run.faulty.velocity[15:]).max() < 0.03
    assert np.abs(run.healthy.velocity[15:]).max() > 0.3


def _connection_lost(run: Case) -> None:
    last = {
        topic: max(item.received for item in run.heard if item.topic == topic) for topic in (JOINT_STATES, COMMANDS)
    }
    assert last[JOINT_STATES] == pytest.approx(AT, abs=0.03)
    assert last[COMMANDS] > SHORT - 0.6
    assert max(item.received for item in run.heard if item.topic != COMMANDS) < AT + 0.03


def _payload_changed(run: Case) -> None:
    lever = 0.246 * np.cos(run.healthy.position[:, 1] + run.healthy.position[:, 2])  # m, of the claw about joint_3
    effort = run.difference("effort")[:, 2]
    assert np.median(-effort / lever / 9.81) == pytest.approx(run.size, rel=0.1)


def _effort_offset(run: Case) -> None:
    assert run.difference("effort")[:, run.joint] == pytest.approx(run.size)
    assert np.all(run.difference("position") == 0.0)


def _ways(run: Case) -> tuple[float, float, float]:
    """The way (m) along and across the chassis, and the one that the wheels would have gone."""
    truth = run.robot.truth
    ahead = truth.base_times > AT - 0.03
    x, y, _, yaw = truth.base[ahead].T
    steps, middle = np.diff([x, y]), (yaw[1:] + yaw[:-1]) / 2
    along = steps[0] * np.cos(middle) + steps[1] * np.sin(middle)
    across = steps[1] * np.cos(middle) - steps[0] * np.sin(middle)
    wheels = 0.1 * np.mean(truth.velocities[truth.times > AT], axis=1) * 0.02
    return np.sum(np.abs(along)), float(np.sum(across)), float(np.sum(np.abs(wheels)))


def _wheel_slip(run: Case) -> None:
    efforts = [np.sqrt(np.mean(own.effort**2)) for own in (run.faulty, run.healthy)]
    assert efforts[0] < 0.5 * efforts[1]
    along, _, wheels = _ways(run)
    assert along < 0.9 * wheels


def _carried(run: Case) -> None:
    assert abs(_ways(run)[1]) > 0.4
    assert run.robot.truth.base[:, 2].max() == pytest.approx(0.13 + 0.15, abs=0.02)


CHECKS = {
    kind: globals()[f"_{kind}"] for kind in (*EVERY_ROBOT, "payload_changed", "effort_offset", "wheel_slip", "carried")
}


@pytest.mark.parametrize(
    ("name", "kind"), [(name, kind) for name in NAMES for kind in FAULTS["rover" if name == "rover" else "arm"]]
)
def test_a_fault_is_in_what_is_heard(name, kind):
    CHECKS[kind](case(name, kind, seed=7))
