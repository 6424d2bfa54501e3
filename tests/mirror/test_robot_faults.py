"""Faults of robots that are not the twin's own numbers are found, told apart, and healthy robots are left alone.

A few of them run each time; ``python -m pytest -m slow tests/mirror/test_robot_faults.py`` runs twelve kinds, three
robots and ten seeds, and an hour of each healthy robot.
"""

from functools import cache

import pytest
from real_robot import RealRobot, Run, real
from robot_faults import FAULTS

from drake_twin.mirror.mirror import Mirror, follow
from drake_twin.mirror.profile import Profile
from drake_twin.mirror.robot_watch import Alarm

AT, END = 5.0, 8.5  # s: when a fault begins, and when its run ends
WITHIN = 2.0  # s
SEEDS = {"delay": 1}  # with this one a command changes soon after the fault begins


@cache
def robot(name: str) -> RealRobot:
    if name == "mujoco_arm":
        pytest.importorskip("mujoco")
    return real(name)


def mirrored(name: str, run: Run, profile: Profile | None = None) -> Mirror:
    """A mirror that has followed a run; without a profile it has learned from it."""
    heard = robot(name).run(run)
    known = {item.topic: item.type for item in heard}
    mirror = Mirror(robot(name).scenario, known, profile=profile, learns=profile is None)
    follow(mirror, heard)
    mirror.proceed(run.duration)
    return mirror


@cache
def profile(name: str, duration: float) -> Profile:
    mirror = mirrored(name, Run(seed=1000, duration=duration))
    learned = mirror.learned()
    mirror.close()
    return learned


def alarms(name: str, run: Run, learned: Profile) -> list[Alarm]:
    mirror = mirrored(name, run, learned)
    found = list(mirror.alarms)
    mirror.close()
    return found


def outcome(name: str, fault: str, seed: int, learned: Profile) -> tuple[bool, bool]:
    """Whether a fault is found in time, and whether its kind and its joint are right."""
    run = Run(seed=seed, duration=END, fault=fault, at=AT)
    found = [item for item in alarms(name, run, learned) if item.raised >= AT - 0.05]
    truth = robot(name).truth
    assert truth is not None
    if not found or found[0].raised > AT + WITHIN:
        return False, False
    first = found[0]
    return True, first.kind == fault and (truth.joint is None or not first.parts or truth.joint in first.parts)


@pytest.mark.parametrize("fault", FAULTS["arm"])
def test_a_fault_of_an_arm_is_found_and_told_apart(fault):
    assert outcome("arm", fault, SEEDS.get(fault, 0), profile("arm", 120.0)) == (True, True)


@pytest.mark.parametrize("fault", ["friction_risen", "collision", "payload_changed"])
@pytest.mark.thorough
def test_a_fault_of_an_arm_that_mujoco_moves_is_found_and_told_apart(fault):
    assert outcome("mujoco_arm", fault, 0, profile("mujoco_arm", 120.0)) == (True, True)


@pytest.mark.parametrize("fault", ["joint_stuck", "wheel_slip", "carried", "encoder_frozen"])
@pytest.mark.thorough
def test_a_fault_of_a_rover_is_found_and_told_apart(fault):
    assert outcome("rover", fault, 1, profile("rover", 120.0)) == (True, True)


@pytest.mark.parametrize("name", ["arm", pytest.param("rover", marks=pytest.mark.thorough)])
def test_a_healthy_robot_raises_no_alarm(name):
    assert alarms(name, Run(seed=77, duration=40.0), profile(name, 120.0)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rover", "arm", "mujoco_arm"])
def test_of_twelve_faults_and_ten_seeds_most_are_found_and_told_apart(name):
    learned = profile(name, 600.0)
    outcomes = [outcome(name, fault, seed, learned) for fault in FAULTS[robot(name).kind] for seed in range(10)]
    found, right = (sum(item[index] for item in outcomes) / len(outcomes) for index in (0, 1))
    print(f"{name}: {found:.3f} found within {WITHIN:g} s, {right:.3f} told apart, of {len(outcomes)}")
    assert found >= 0.95
    assert right >= 0.80


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rover", "arm", "mujoco_arm"])
def test_an_hour_of_a_healthy_robot_has_one_false_alarm_at_most(name):
    learned = profile(name, 600.0)
    found = [item for index in range(30) for item in alarms(name, Run(seed=5000 + index, duration=120.0), learned)]
    print(f"{name}: {len(found)} false alarms in an hour")
    assert len(found) <= 1, found
