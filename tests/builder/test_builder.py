import inspect
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from conftest import ROVER

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import Command, Robot, Scenario, StaticTransform, World


def test_the_builder_and_plain_data_are_the_same_scenario(tmp_path):
    built = (
        TwinBuilder(time_step=0.002, contact_approximation="similar", world=World(ground=False))
        .package_path(tmp_path)
        .robot("a", ROVER, xyz=(0, 0, 1), xacro_args={"n": 4, "sim": True}, controllers="package://p/c.yaml")
        .static_transform("world", "odom", xyz=(1, 0, 0))
        .command("/a/x/commands", [1, 2], time=1, period=2)
        .scenario()
    )
    assert built == Scenario(
        robots=(
            Robot("a", ROVER, xacro_args={"n": "4", "sim": "true"}, xyz=(0, 0, 1), controllers=("package://p/c.yaml",)),
        ),
        time_step=0.002,
        contact_approximation="similar",
        world=World(ground=False),
        package_paths=(str(tmp_path),),
        static_transforms=(StaticTransform("world", "odom", xyz=(1, 0, 0)),),
        commands=(Command("/a/x/commands", (1, 2), time=1, period=2),),
    )


def test_relative_files_are_relative_to_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (robot,) = TwinBuilder().robot("a", "a.urdf", controllers=["c.yaml"]).scenario().robots
    assert (robot.model, robot.controllers) == (str(tmp_path / "a.urdf"), (str(tmp_path / "c.yaml"),))


def test_the_example_of_the_documentation_runs():
    twin = (
        TwinBuilder(time_step=0.001)
        .robot("robot_1", ROVER, xyz=(0, 0, 0.2), rpy=(0, 0, 0))
        .robot("robot_2", ROVER, xyz=(0, 2, 0.2))
        .static_transform("world", "robot_1_odom")
        .build()
    )
    twin.publish("/robot_1/forward_velocity_controller/commands", [2, 2, 2, 2])
    twin.advance_to(1.0)
    assert twin.joint_states("robot_1").velocity == pytest.approx([2] * 4, rel=0.005)
    assert twin.latest("/tf_static").transforms[0].child_frame_id == "robot_1_odom"


def test_one_parameters_file_serves_robots_of_any_name():
    from drake_twin.description.package_index import share_folder

    file = share_folder("models") / "rover_description" / "config" / "rover_controllers.yaml"
    twin = TwinBuilder().robot("a", ROVER, xyz=(0, 0, 0.13), controllers=file).build()
    (topic,) = twin.built.commanded
    assert topic == "/a/forward_velocity_controller/commands"
    assert next(iter(twin.graph.command_limits(topic))).joint == "a_front_left_wheel_joint"


@pytest.mark.parametrize("xyz", [(1, 2), "abc", (1, 2, "x"), 5])
def test_a_place_that_is_not_three_numbers_is_refused(xyz):
    with pytest.raises(InputError, match=r"xyz of robot 'a': .* is not three numbers"):
        TwinBuilder().robot("a", ROVER, xyz=xyz)


OTHERS = {  # a value for each field of `Robot` that is not its default, as a program may give it, and in the scenario
    "xacro_args": ({"n": 4, "sim": True}, {"n": "4", "sim": "true"}),
    "xyz": (np.array([1, 2, 3]), (1.0, 2.0, 3.0)),
    "rpy": ([0, 0, 1], (0.0, 0.0, 1.0)),
    "namespace": ("fleet/a", "fleet/a"),
    "frame_prefix": ("a_", "a_"),
    "controllers": (Path("/c.yaml"), ("/c.yaml",)),
    "active_controllers": (["one"], ("one",)),
    "inactive_controllers": ("two", ("two",)),
    "initial_positions": ({"j": 1}, {"j": 1.0}),
    "self_collision": (False, False),
    "collision": ("decomposition", "decomposition"),
    "contact": ("point", "point"),
    "remappings": ({"/a": "/b"}, {"/a": "/b"}),
    "stamped_topics": (["cmd_vel"], ("cmd_vel",)),
    "without_repairs": ({"inertia"}, ("inertia",)),
    "added_controllers": ({"c": {"type": "my/C"}}, {"c": {"type": "my/C"}}),
    "unconfigured_controllers": (["three"], ("three",)),
    "bridged": ({"/gz": "/ros"}, {"/gz": "/ros"}),
    "controller_parameters": ({"one": {"gains.j.p": 2.0}}, {"one": {"gains.j.p": 2.0}}),
    "friction": (1, 1.0),
    "joint_friction": ({"j": np.float64(0.5)}, {"j": 0.5}),
    "command_delay": (0.01, 0.01),
    "measurement_delay": (0.02, 0.02),
    "noise": (0, 0.0),
    "publish_frequency": (50, 50.0),
}


def test_the_builder_takes_what_a_robot_has():
    """By the names and defaults of its fields."""
    assert list(OTHERS) == [item.name for item in fields(Robot)][2:]
    given = {name: value for name, (value, _) in OTHERS.items()}
    (robot,) = TwinBuilder().robot("a", ROVER, **given).scenario().robots
    assert robot == Robot("a", ROVER, **{name: value for name, (_, value) in OTHERS.items()})
    named = inspect.signature(TwinBuilder().robot).parameters
    assert list(named) == [item.name for item in fields(Robot)]
    assert {name: type(named[name].default) for name in ("xyz", "controllers", "noise", "friction")} == {
        "xyz": tuple,
        "controllers": tuple,
        "noise": float,
        "friction": type(None),
    }


@pytest.mark.parametrize(
    ("option", "value", "wanted"),
    [
        ("friction", "rough", "is not a number"),
        ("remappings", "/a:=/b", "is not a mapping"),
        ("active_controllers", 5, "is not a list of names"),
        ("xyz", "123", "is not three numbers"),
    ],
)
def test_an_option_of_another_kind_is_refused(option, value, wanted):
    with pytest.raises(InputError, match=rf"{option} of robot 'a': .* {wanted}"):
        TwinBuilder().robot("a", ROVER, **{option: value})


def test_no_value_is_the_default():
    (robot,) = TwinBuilder().robot("a", ROVER, **dict.fromkeys(OTHERS)).scenario().robots
    assert robot == Robot("a", ROVER)


def test_an_option_that_a_robot_lacks_is_a_wrong_call():
    with pytest.raises(TypeError, match="unexpected keyword argument 'colour'"):
        TwinBuilder().robot("a", ROVER, colour="red")


def test_a_command_is_numbers_or_the_fields_of_any_message():
    twist = {"linear": {"x": 1.0}}
    (command,) = TwinBuilder().robot("a", ROVER).command("/a/cmd_vel", twist).scenario().commands
    assert command.data == twist
    with pytest.raises(InputError, match=r"'fast' for /a/cmd_vel is neither numbers nor the fields of a message"):
        TwinBuilder().command("/a/cmd_vel", "fast")


def test_topics_are_remapped():
    commands = "/a/forward_velocity_controller/commands"
    twin = TwinBuilder().robot("a", ROVER, remappings={commands: "/a/wheels"}).build()
    assert "/a/wheels" in twin.graph.topics()
    assert commands not in twin.graph.topics()


@pytest.mark.parametrize(
    ("given", "active", "expected", "inactive"),
    [
        (None, True, None, ()),
        (["x"], True, ("x", "c"), ()),
        (["x"], False, ("x",), ("c",)),
        (None, False, None, ("c",)),
    ],
)
def test_a_controller_is_added_to_its_robot_active_or_not(given, active, expected, inactive):
    builder = TwinBuilder().robot("other", ROVER).robot("a", ROVER, active_controllers=given)
    other, robot = builder.controller("a", "c", "my/Kind", {"gain": 2}, active=active).scenario().robots
    assert dict(robot.added_controllers) == {"c": {"type": "my/Kind", "gain": 2}}
    assert (robot.active_controllers, robot.inactive_controllers) == (expected, inactive)
    assert other == Robot("other", ROVER)


def test_a_controller_of_an_unknown_robot_is_refused_with_those_there_are():
    with pytest.raises(InputError, match=r"unknown robot 'b'.*Valid: a"):
        TwinBuilder().robot("a", ROVER).controller("b", "c", "my/Kind")
