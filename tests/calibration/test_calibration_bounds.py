"""How well robots' values are found; the noise of the logs is known, and their twins do not know the values."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum_logs import write_log
from robot_logs import (
    ARM,
    ARM_NOISE,
    JOINT_STATES,
    LINKS,
    LINKS_STATES,
    ROVER,
    ROVER_NOISE,
    arm,
    arm_items,
    driven,
    links,
    mujoco_log,
    noisy_states,
    rover,
    rover_items,
)

from drake_twin.calibration import Fitted, calibrate
from drake_twin.calibration.report import report, root_mean_squares
from drake_twin.messages.interface_types import make

pytestmark = pytest.mark.slow

ARM_FITTED = tuple(Fitted(path, 0.01, 1.5) if path.endswith("payload") else Fitted(path, 0.02, 2.0) for path in ARM)
IMU = "sensor_msgs/msg/Imu"


def errors_of(result, truth):
    """Each value's miss, in its standard errors."""
    return {path: (result.values[path] - value) / result.errors[path] for path, value in truth.items()}


@pytest.mark.parametrize("method", ["auto", "least-squares"])
@pytest.mark.parametrize("payload", [0.02, 1.2])
def test_payload_and_dampings_of_an_arm(tmp_path, payload, method):
    """Case a: within 3 standard errors, χ²/dof 0.9 to 1.1, at most 60 episodes."""
    log = write_log(tmp_path / "log", arm_items())
    scenario = replace(arm(), values={"robot_1.claw.payload": payload})
    result = calibrate(scenario, [log], ARM_FITTED, noise=ARM_NOISE, method=method)
    print(report(result))
    assert result.problems == ()
    assert max(map(abs, errors_of(result, ARM).values())) < 3
    assert 0.9 < result.chi_squared < 1.1
    assert result.episodes <= 60


@pytest.mark.parametrize("signs", [(-1, -1, -1), (1, 1, 1), (-1, 1, -1), (1, -1, 1)])
def test_friction_mass_and_damping_of_a_rover_that_slips(tmp_path, signs):
    """Case b: from 60 % off, friction and mass within 3 %, at most 700 episodes, χ²/dof at most 1.5."""
    log = write_log(tmp_path / "log", rover_items())
    fitted = [Fitted(path, 0.4 * value, 1.6 * value) for path, value in ROVER.items()]
    start = {path: (1 + 0.6 * sign) * value for (path, value), sign in zip(ROVER.items(), signs, strict=True)}
    result = calibrate(
        rover(),
        [log],
        fitted,
        start=start,
        noise=ROVER_NOISE,
        renamed={"/camera/pose": "/robot_1/ground_truth/odom"},
        left_out=["z", "roll", "pitch"],
    )
    print(report(result))
    assert result.problems == ()
    assert result.chi_squared <= 1.5
    assert result.episodes <= 700
    for path in ("friction", "robot_1.base_link.mass"):
        assert result.values[path] == pytest.approx(ROVER[path], rel=0.03)


def test_fifty_noises_of_an_arm(tmp_path):
    """Case c: the truth lies in the 95 % interval 43 times of 50 or more, for each value."""
    inside = np.zeros(len(ARM), dtype=int)
    for seed in range(50):
        log = write_log(tmp_path / str(seed), arm_items(1000 + seed))
        start = {"robot_1.claw.payload": 0.05}
        result = calibrate(arm(), [log], ARM_FITTED, noise=ARM_NOISE, method="least-squares", start=start)
        inside += np.abs([*errors_of(result, ARM).values()]) < 1.96
    print(dict(zip(ARM, inside.tolist(), strict=True)))
    assert inside.min() >= 43


def test_a_mass_that_cannot_be_known_is_named(tmp_path):
    """Case d: a rover that never slips, without efforts."""
    commands = [(0.2 * index, [3.0 * np.sin(index)] * 4) for index in range(1, 8)]
    received, items = driven(replace(rover(), values={"robot_1.base_link.mass": 14.0}), commands, 1.5)
    noise = {**ROVER_NOISE, "velocity": 5e-2}
    items += noisy_states(received[JOINT_STATES], noise, 0, without=("effort",))
    log = write_log(tmp_path / "log", items)
    fitted = [Fitted("robot_1.base_link.mass", 5.0, 30.0), Fitted("friction", 0.3, 1.2)]
    result = calibrate(rover(), [log], fitted, noise=noise)
    print(report(result))
    assert "robot_1.base_link.mass" in result.unknown
    assert any("robot_1.base_link.mass" in direction for direction in result.directions)
    assert "robot_1.base_link.mass" not in result.values
    assert "robot_1.base_link.mass" not in result.scenario.values
    assert "robot_1.base_link.mass  not known from these logs: the scenario's own value stays" in report(result)


def test_mujoco_as_the_real_robot(tmp_path):
    """Case e: the error of the trajectory falls by 5 or more, that of the second half by 3 or more."""
    pytest.importorskip("mujoco")
    log = mujoco_log(tmp_path / "log")
    fitted = [Fitted(path, 0.2, 5.0) if path.endswith("mass") else Fitted(path, 0.01, 2.0) for path in LINKS]
    result = calibrate(links(tmp_path), [log], fitted)
    print(report(result))
    for before, after in root_mean_squares(result).values():
        assert before > 5 * after
    assert np.sqrt(result.held_out[0]) > 3 * np.sqrt(result.held_out[1])
    assert {topic for topic, _ in root_mean_squares(result)} == {LINKS_STATES}
    for path, value in LINKS.items():  # the engines agree
        assert result.values[path] == pytest.approx(value, rel=0.05)


def test_a_log_with_gaps_another_clock_missing_joints_and_extra_topics(tmp_path):
    """Case f: the offset of 30 ms within 2 ms, and the values of the joints that are there."""
    items = [
        item for item in arm_items(joints=("joint_3", "joint_2")) if not 0.7 < item[2] < 1.0 or item[0] != JOINT_STATES
    ]
    items = [(topic, kind, time + 0.03 * (topic == JOINT_STATES), message) for topic, kind, time, message in items]
    items += [("/imu", IMU, 0.1 * index, make(IMU, {})) for index in range(20)]
    log = write_log(tmp_path / "log", sorted(items, key=lambda item: item[2]))
    truth = {path: value for path, value in ARM.items() if "joint_1" not in path}
    result = calibrate(arm(), [log], [item for item in ARM_FITTED if item.path in truth], noise=ARM_NOISE)
    print(report(result))
    ((_, delay, error),) = result.delays
    assert abs(delay - 0.03) < 2e-3
    assert error < 2e-3
    assert result.problems == ()
    assert max(map(abs, errors_of(result, truth).values())) < 3
    assert any("/imu is not used" in note for note in result.notes)
    assert any("joint_1.position" in note for note in result.notes)
