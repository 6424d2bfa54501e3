"""`drake_twin.calibration.calibrate` on logs of a pendulum that SciPy has moved."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum_logs import (
    DAMPING,
    IMU,
    MASS,
    NOISE,
    STATE_TOPIC,
    TOPIC,
    messages,
    pendulum,
    write_log,
)
from rosbags.rosbag2 import StoragePlugin

from drake_twin import Twin
from drake_twin.calibration import Fitted, calibrate
from drake_twin.calibration.fit import StoppedError
from drake_twin.calibration.report import report, root_mean_squares
from drake_twin.errors import InputError
from drake_twin.messages.interface_types import make
from drake_twin.scenario import Command

ARM, HINGE = "pendulum.arm.mass", "pendulum.hinge.damping"
TRUTH = {ARM: MASS, HINGE: DAMPING}
FITTED = (Fitted(ARM, 0.5, 5.0), Fitted(HINGE, 0.02, 2.0))


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "start", [{}, pytest.param({ARM: 0.6, HINGE: 1.5}, marks=SLOW), pytest.param({ARM: 4.5, HINGE: 0.03}, marks=SLOW)]
)
def test_mass_and_damping_of_a_log_are_found(tmp_path, start):
    log = write_log(tmp_path / "log", messages())
    result = calibrate(pendulum(tmp_path), [log], FITTED, start=start)
    assert result.problems == ()
    for path, value in TRUTH.items():
        assert abs(result.values[path] - value) < 3 * result.errors[path]
        assert result.errors[path] < 0.05 * value
    assert 0.7 < result.chi_squared < 1.4  # 100 numbers, and the noise is estimated, too
    assert result.chi_squared_before > 100
    assert result.episodes <= 60
    assert result.scenario.values == result.values
    ((_, delay, error),) = result.delays
    assert abs(delay) < 3 * error < 3e-3
    before, after = result.held_out
    assert after < 1.5 < 100 < before


def test_noise_is_estimated_without_the_jumps_of_the_motion(tmp_path):
    """Three of five third differences hold a step of the torque: they alone would give 1.4 times the noise."""
    log = write_log(tmp_path / "log", messages(duration=2.0))
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    sigmas = {curve.name: curve.sigma for curve in result.curves}
    assert sigmas == pytest.approx({f"hinge.{kind}": value for kind, value in NOISE.items()}, rel=0.25)


def test_the_errors_are_those_of_the_measurements(tmp_path):
    """Logs of other noise: their values scatter by the errors that each of them gives."""
    scenario = pendulum(tmp_path)
    logs = [write_log(tmp_path / str(seed), messages(seed)) for seed in range(2)]
    found = [calibrate(scenario, [log], FITTED, noise=NOISE, method="least-squares") for log in logs]
    misses = np.array([[(item.values[path] - TRUTH[path]) / item.errors[path] for path in TRUTH] for item in found])
    assert 0.2 < np.sqrt(np.mean(misses**2)) < 2.0


def test_several_logs_tell_more(tmp_path):
    logs = [write_log(tmp_path / str(seed), messages(seed)) for seed in range(2)]
    one, two = (
        calibrate(pendulum(tmp_path), own, FITTED, noise=NOISE, method="least-squares") for own in (logs[:1], logs)
    )
    assert two.errors[ARM] == pytest.approx(one.errors[ARM] / 2**0.5, rel=0.1)
    assert len(two.delays) == 2


def test_a_clock_that_is_ahead_is_found(tmp_path):
    log = write_log(tmp_path / "log", messages(late=0.03))
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    assert result.delays[0][1] == pytest.approx(0.03, abs=2e-3)
    assert abs(result.values[ARM] - MASS) < 3 * result.errors[ARM]


def test_a_clock_of_another_day_is_moved(tmp_path):
    log = write_log(tmp_path / "log", messages(late=-1e6))
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    assert abs(result.values[ARM] - MASS) < 3 * result.errors[ARM]
    assert any("stamps are of another clock, 1000000.000 s behind" in note for note in result.notes)


def test_gaps_extra_topics_and_joints_do_no_harm(tmp_path):
    kept = [item for item in messages() if item[0] == TOPIC or not (0.3 < item[2] < 0.5 or 0.7 < item[2] < 0.75)]
    imu = make(IMU, {})
    more = [("/imu", IMU, item[2], imu) for item in kept] + [("/torque", "their_msgs/msg/Torque", 0.5, b"\0" * 12)]
    for _, _, _, message in kept:
        if hasattr(message, "position"):
            message.name = ["hinge", "gripper"]
            message.position = np.append(message.position, 0.5)
    log = write_log(tmp_path / "log", sorted(kept + more, key=lambda item: item[2]), StoragePlugin.SQLITE3)
    result = calibrate(pendulum(tmp_path), [log], FITTED)
    assert abs(result.values[ARM] - MASS) < 3 * result.errors[ARM]
    assert 0.6 < result.chi_squared < 1.4
    notes = " ".join(result.notes)
    assert "/imu is not used" in notes
    assert "/torque is not used" in notes
    assert f"{STATE_TOPIC}: not in the twin: gripper.position" in notes
    assert f"{STATE_TOPIC}: not measured: hinge.effort" in notes


def test_a_twin_that_cannot_move_so_is_a_problem(tmp_path):
    log = write_log(tmp_path / "log", messages(friction=0.3))
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    assert result.chi_squared > 1.5
    assert any("χ²/dof is" in problem for problem in result.problems)


def test_a_value_that_the_log_does_not_tell_is_named(tmp_path):
    """The hinge turns about y, so that nothing depends on the moment of inertia about x."""
    log = write_log(tmp_path / "log", messages())
    scenario = pendulum(tmp_path)
    fitted = (*FITTED, Fitted("pendulum.arm.ixx", 0.01, 0.035))
    result = calibrate(scenario, [log], fitted)
    assert result.unknown == ("pendulum.arm.ixx",)
    assert result.directions == (("pendulum.arm.ixx",),)
    assert result.values.keys() == TRUTH.keys()
    assert "pendulum.arm.ixx" not in result.scenario.values
    assert abs(result.values[ARM] - MASS) < 3 * result.errors[ARM]
    assert "pendulum.arm.ixx        not known from these logs" in report(result)
    assert result.problems == ()


def test_values_that_act_alike_are_not_told_apart(tmp_path):
    """A rotor's inertia adds to that of the arm about the same axis."""
    log = write_log(tmp_path / "log", messages())
    fitted = (Fitted("pendulum.hinge.rotor_inertia", 1e-3, 0.2), Fitted("pendulum.arm.inertia", 0.3, 5.0), *FITTED)
    result = calibrate(pendulum(tmp_path), [log], fitted, method="least-squares")
    (direction,) = result.directions
    assert set(direction) == {"pendulum.hinge.rotor_inertia", "pendulum.arm.inertia"}
    assert {*result.unknown} <= {*direction}
    assert "the logs do not tell apart: " in report(result)


def test_a_recording_is_a_log(tmp_path):
    scenario = pendulum(tmp_path, values=TRUTH, commands=(Command(TOPIC, (1.0,), time=0.1, period=0.7),))
    with Twin(scenario) as twin:
        twin.recorder.begin()
        twin.advance_to(0.5)
        twin.publish(TOPIC, [-1.5])
        twin.advance_to(1.5)
        recording = twin.recorder.recording()
    recording.save(tmp_path / "run.json")
    result = calibrate(pendulum(tmp_path), [tmp_path / "run.json"], FITTED, method="least-squares")
    assert result.values == pytest.approx(TRUTH, rel=1e-3)
    assert result.problems == ()
    with pytest.raises(InputError, match="3 episodes are too few to fit 2 values"):
        calibrate(pendulum(tmp_path), [recording], FITTED, most_episodes=3)


def test_a_search_that_is_stopped_tells_the_best_values(tmp_path):
    log = write_log(tmp_path / "log", messages())
    with pytest.raises(StoppedError, match="stopped after 1 episodes") as stopped:
        calibrate(pendulum(tmp_path), [log], FITTED, stopped=[2])
    assert stopped.value.best == {}


@SLOW
def test_evolution_finds_it_too(tmp_path):
    log = write_log(tmp_path / "log", messages())
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="evolution", most_episodes=110)
    assert abs(result.values[ARM] - MASS) < 3 * result.errors[ARM]
    assert result.episodes <= 110


def test_errors_are_told_in_their_units(tmp_path):
    log = write_log(tmp_path / "log", messages())
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    before, after = root_mean_squares(result)[STATE_TOPIC, "position"]
    assert before > 10 * after
    assert after == pytest.approx(NOISE["position"], rel=0.3)


@pytest.mark.parametrize(
    "method", ["auto", pytest.param("least-squares", marks=SLOW), pytest.param("sobol", marks=SLOW)]
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_the_only_value_is_not_known_where_it_has_no_effect_at_all(tmp_path, method):
    log = write_log(tmp_path / "log", messages())
    result = calibrate(pendulum(tmp_path), [log], [Fitted("pendulum.arm.ixx", 0.01, 0.035)], method=method)
    assert result.unknown == ("pendulum.arm.ixx",)
    assert result.problems


def test_a_delay_that_the_log_does_not_tell_is_said(tmp_path):
    log = write_log(tmp_path / "log", messages())
    result = calibrate(pendulum(tmp_path), [log], FITTED, method="least-squares")
    assert f"{STATE_TOPIC} is " in report(result)
    unknown = replace(result, delays=((STATE_TOPIC, -0.09, 2e6),))
    assert f"how late {STATE_TOPIC} is cannot be known" in report(unknown)
