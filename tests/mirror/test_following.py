"""A twin follows robots that are not its own numbers: joints, base, clocks, gaps, and what is carried away."""

from dataclasses import replace

import numpy as np
import pytest
from real_robot import COMMANDS, JOINT_STATES, Run, real

from drake_twin.mirror.mirror import Mirror, follow

NOISE = Run().position_noise


class Followed:
    """Where the twin was after each measurement, beside the truth."""

    def __init__(self, robot, run, keep=lambda heard: True):
        self.robot, self.run = robot, run
        self.joints, self.base = [], []
        heard = [item for item in robot.run(run) if keep(item)]
        known = {item.topic: item.type for item in heard}
        self.mirror = Mirror(robot.scenario, known, learns=True, followed=self._note)
        follow(self.mirror, heard)
        truth = robot.truth
        times, positions = np.array([item[0] for item in self.joints]), np.array([item[1] for item in self.joints])
        real_positions = [np.interp(times, truth.times, column) for column in truth.positions.T]
        self.times, self.errors = times, positions - np.column_stack(real_positions)
        if self.base:
            at, places = np.array([item[0] for item in self.base]), np.array([item[1] for item in self.base])
            real_places = np.column_stack([np.interp(at, truth.base_times, column) for column in truth.base[:, :2].T])
            self.base_times, self.base_errors = at, np.linalg.norm(places - real_places, axis=1)
        self.mirror.close()

    def _note(self, innovation):
        state = self.mirror.twin.robot_state("robot_1", with_efforts=False)
        time = self.mirror.zero + innovation.time - self.run.least_delay  # s, of the true clock
        if innovation.watched.topic == JOINT_STATES:
            self.joints.append((time, state.positions))
        else:
            self.base.append((time, state.base_pose[:2]))


@pytest.fixture(params=["rover", "arm", pytest.param("mujoco_arm", marks=pytest.mark.slow)])
def robot(request):
    if request.param == "mujoco_arm":
        pytest.importorskip("mujoco")
    found = real(request.param)
    yield found
    found.close()


def test_joints_are_followed_within_three_times_the_sensors_noise(robot):
    found = Followed(robot, Run(seed=4, duration=30.0))
    after = found.times > 12.0  # the delay of commands is learned in the first 10 s
    errors = found.errors[after][:, :4]  # the fifth joint of the arm mimics the fourth, in the twin exactly
    rms = np.sqrt(np.mean(errors**2, axis=0))
    assert (rms < 2 * NOISE).all(), rms
    assert np.quantile(np.abs(errors), 0.95) < 3 * NOISE


@pytest.mark.parametrize("duration", [20.0, pytest.param(60.0, marks=pytest.mark.slow)])
def test_the_base_is_followed_within_two_centimeters(duration):
    robot = real("rover")
    found = Followed(robot, Run(seed=5, duration=duration))
    assert np.max(found.base_errors[found.base_times > 1.0]) < 0.02
    robot.close()


def test_after_a_gap_of_a_second_the_twin_is_back_at_once():
    robot = real("rover")
    run = Run(seed=6, duration=16.0)
    found = Followed(robot, run, keep=lambda heard: heard.topic == COMMANDS or not 12.0 <= heard.received < 13.0)
    after = (found.times > 13.5) & (found.times < 14.5)
    assert np.quantile(np.abs(found.errors[after]), 0.95) < 3 * NOISE
    assert np.max(found.base_errors[found.base_times > 13.5]) < 0.02
    assert found.mirror.catches >= 1
    robot.close()


@pytest.mark.parametrize(("offset", "drift"), [(0.2, 100e-6), (-30.0, -100e-6)])
def test_the_robots_clock_is_found_while_it_is_followed(offset, drift):
    robot = real("arm")
    run = replace(Run(seed=7, duration=20.0), clock_offset=offset, clock_drift=drift)
    found = Followed(robot, run)
    assert found.mirror.clocks["robot_1"].offset == pytest.approx(-offset - drift * 20.0 + run.least_delay, abs=2e-3)
    assert found.mirror.clocks["robot_1"].drift == pytest.approx(-drift, abs=30e-6)
    robot.close()


def test_messages_that_overtake_each_other_are_put_in_order():
    robot = real("arm")
    run = replace(Run(seed=8, duration=14.0), mean_delay=0.01)
    found = Followed(robot, run)
    assert found.mirror.arrivals[JOINT_STATES].late > 10
    assert (np.diff(found.times) > 0).all()
    assert len(found.times) > 0.98 * 50 * 14
    robot.close()
