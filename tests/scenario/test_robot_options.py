"""A robot as a Python program gives it: lists, arrays, paths and numbers, or None where the default is meant."""

from pathlib import Path

import numpy as np
import pytest

from drake_twin.errors import InputError
from drake_twin.scenario import Robot
from drake_twin.scenario.robot_options import robot_of, takes_robot_options


def test_lists_arrays_paths_and_numbers_become_plain_data(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    given = {
        "xyz": np.array([1, 2, 3]),
        "xacro_args": {"wheels": 4, "arm": True},
        "controllers": [Path("c.yaml"), "package://p/d.yaml"],
        "active_controllers": ["drive"],
        "namespace": "fleet",
        "friction": 1,
        "joint_friction": {"elbow": "0.5"},
        "self_collision": False,
    }
    robot = robot_of("a", Path("a.urdf"), given)
    assert robot == Robot(
        "a",
        str(tmp_path / "a.urdf"),
        xyz=(1.0, 2.0, 3.0),
        xacro_args={"wheels": "4", "arm": "true"},
        controllers=(str(tmp_path / "c.yaml"), "package://p/d.yaml"),
        active_controllers=("drive",),
        namespace="fleet",
        friction=1.0,
        joint_friction={"elbow": 0.5},
        self_collision=False,
    )
    assert {type(item) for item in robot.xyz} == {type(robot.friction)} == {float}


def test_one_name_is_a_list_of_one():
    assert robot_of("a", "/a.urdf", {"controllers": "/c.yaml"}).controllers == ("/c.yaml",)


def test_none_is_the_default():
    given = {"friction": None, "xacro_args": None, "xyz": None, "namespace": None}
    assert robot_of("a", "/a.urdf", given) == Robot("a", "/a.urdf")


@pytest.mark.parametrize(
    ("option", "value", "what"),
    [
        ("xyz", [1, 2], "is not three numbers"),
        ("xyz", "123", "is not three numbers"),
        ("friction", "high", "is not a number"),
        ("controllers", 3, "is not a list of names"),
        ("joint_friction", 0.5, "is not a mapping"),
    ],
)
def test_a_value_that_cannot_be_used_is_named_with_its_robot(option, value, what):
    with pytest.raises(InputError, match=f"^{option} of robot 'a': .*{what}"):
        robot_of("a", "/a.urdf", {option: value})


def test_a_method_of_robot_options_has_their_names_and_defaults():
    @takes_robot_options
    def make(name, **options):
        return name, options

    assert make("a", friction=0.5) == ("a", {"friction": 0.5})
    assert {"xyz=(0.0, 0.0, 0.0)", "noise=1.0"} <= {
        f"{item.name}={item.default}" for item in make.__signature__.parameters.values()
    }
    with pytest.raises(TypeError, match="fricton"):
        make("a", fricton=0.5)
