"""The longest step with which a scenario moves as with a short one: what falls is g t h ÷ 2 too low with a step h."""

from dataclasses import replace

import pytest
from program_runs import run

from drake_twin import Command, Scenario, TwinBuilder
from drake_twin.builder.demo import demo_scenario
from drake_twin.builder.longest_step import longest_step
from drake_twin.errors import InputError

BALL = """<robot name="ball"><link name="ball"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
GRAVITY = 9.81  # m/s²
AFTER = 0.6  # s of falling


def falls(folder) -> Scenario:
    file = folder / "ball.urdf"
    file.write_text(BALL)
    return TwinBuilder().robot("ball", str(file), xyz=(0, 0, 100)).scenario()


def lower(step):
    """How much lower than with 1 ms what falls is: Drake's velocity of a step's end holds for all of it."""
    return GRAVITY * AFTER * (step - 0.001) / 2


@pytest.mark.parametrize("step", [0.01, 0.005, 0.004, 0.002])
def test_the_longest_step_within_the_error_is_found(tmp_path, step):
    found = longest_step(falls(tmp_path), error=1.001 * lower(step), duration=AFTER)
    assert found.time_step == step
    assert found.trials[-1].error == pytest.approx(lower(step), rel=1e-6)
    assert all(trial.gain is None and trial.error > found.error for trial in found.trials[:-1])
    assert found.trials[-1].where == "ball_z"


def test_the_short_step_stays_where_no_longer_one_is_near(tmp_path):
    found = longest_step(falls(tmp_path), error=0.999 * lower(0.002), duration=AFTER)
    assert found.time_step == 0.001
    assert "no longer one stays within" in str(found)
    assert "ball_z differs by 0.0029" in str(found)


def test_a_step_with_which_a_scenario_does_not_run_is_passed_over():
    builder = TwinBuilder().robot("r", "package://rover_description/urdf/rover.urdf.xacro", xyz=(0, 0, 0.13))
    command = Command("/r/forward_velocity_controller/commands", (1.0,) * 4, 0.0, 0.004)
    found = longest_step(replace(builder.scenario(), commands=(command,)), error=10.0, duration=0.02)
    assert (found.time_step, [trial.error for trial in found.trials[:2]]) == (0.004, [None, None])


@pytest.mark.parametrize(("robot", "step"), [("rover", 0.002), ("arduinobot", 0.01)])
def test_the_demos_have_the_steps_that_the_docs_say(robot, step):
    assert longest_step(demo_scenario(robot, 2)).time_step == step


def test_an_engine_with_error_control_is_refused(tmp_path):
    builder = TwinBuilder(engine="cenic", time_step=0.01)
    builder.robot("ball", str(tmp_path / "ball.urdf"))
    with pytest.raises(InputError, match="the engine cenic finds its steps itself"):
        longest_step(builder.scenario())


def test_a_run_says_its_step_and_its_gain():
    result = run("--robots", 1, "--robot", "arduinobot", "--headless", "--duration", 0.1, "--time-step", "auto:0.5")
    assert result.returncode == 0
    assert result.stderr.startswith("time step 0.01 s: within 0.5 m or rad of 0.001 s in the first 0.1 s, at most ")
    assert "of the processor time" in result.stderr


@pytest.mark.parametrize("wrong", ["auto:", "auto:x", "fast", "auto:-1"])
def test_other_words_are_refused(wrong):
    result = run("--robots", 1, "--headless", "--duration", 0.1, "--time-step", wrong)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1


def test_a_saved_run_keeps_its_step(tmp_path):
    result = run("--load-state", tmp_path / "state.json", "--headless", "--time-step", "auto")
    assert result.returncode == 2
    assert "a saved run has its own step" in result.stderr
