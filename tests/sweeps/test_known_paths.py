"""Paths that name no controller or parameter, and the close ones that a user is shown."""

import pytest
from conftest import rovers
from two_hinges import hinges, trajectories, velocities

from drake_twin.errors import InputError
from drake_twin.sweeps.known_paths import check_paths
from drake_twin.sweeps.variation import with_value


@pytest.fixture
def scenario(tmp_path):
    controllers = {"arm": trajectories("left", "right"), "speed": velocities("left", command_timeout=0.5)}
    return hinges(tmp_path, controllers, ("r", "s"), active=("arm",)).scenario()


def check(scenario, *paths, value=1.0):
    varied = scenario
    for path in paths:
        varied = with_value(varied, path, value)
    check_paths(varied, scenario, paths)


@pytest.mark.parametrize(
    "path",
    [
        "r.arm.gains.left.p",
        "s.arm.gains.right.ff_velocity_scale",
        "r.arm.constraints.left.goal",
        "r.arm.constraints.goal_time",
        "r.speed.command_timeout",
        "r.left.damping",
        "r.left.position",
        "friction",
    ],
)
def test_what_a_file_has_is_accepted(scenario, path):
    check(scenario, path)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (
            "s.right_link.mas",
            "s.right_link.mas: robot 's' has no controller 'right_link', and its parts no such value.",
        ),
        ("s.right_link.mas", "Did you mean 's.right_link.mass'"),
        ("r.left.dampin", "Did you mean 'r.left.damping'"),
        ("r.left.gear_ration", "Did you mean 'r.left.gear_ratio'"),
        ("r.speeed.command_timeout", "Did you mean 'r.speed.command_timeout'"),
        ("r.speed.timeout", "controller 'speed' has no parameter 'timeout'. Did you mean 'r.speed.command_timeout'"),
        ("r.arm.gains.left.pp", "has no parameter 'gains.left.pp'"),
        ("r.zzz.q", "has no controller 'zzz'"),
    ],
)
def test_what_no_file_has_is_refused_with_the_close_names(scenario, path, message):
    with pytest.raises(InputError) as refused:
        check(scenario, "r.arm.gains.left.p", path)
    assert message in str(refused.value)


def test_an_argument_that_a_robots_file_lacks_is_refused():
    base = rovers(1).scenario()
    check(base, "robot_1.args.robot_name", value="rover")
    with pytest.raises(InputError) as refused:
        check(base, "robot_1.args.controler", value="rover")
    message = "the robot's file has no such argument. Did you mean 'robot_1.args.controllers'? Valid: robot_1.args."
    assert message in str(refused.value)


def test_close_names_leave_the_robots_name_out_only_where_that_is_allowed():
    base = rovers(1).scenario()
    for path, close in (
        ("robot_1.base_link.mas", "robot_1.base_link.mass"),
        ("robot_1.front_left_wheel_joint.positon", "robot_1.robot_1_front_left_wheel_joint.position"),
    ):
        with pytest.raises(InputError) as refused:
            check(base, path)
        assert close in refused.value.valid
        if close.endswith("mass"):
            check(base, close)
