from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from drake_twin.errors import InputError
from drake_twin.scenario import (
    Command,
    Push,
    Robot,
    Scenario,
    ScenarioError,
    StaticTransform,
    World,
    name_in_twin,
)
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

FULL = Scenario(
    robots=(
        Robot(
            "a",
            "package://p/a.urdf.xacro",
            xacro_args={"wheels": "4", "arm": "true"},
            xyz=(1.0, 2.0, 0.5),
            rpy=(0.0, 0.0, 1e-7),
            namespace="/fleet/a",
            frame_prefix="a_",
            controllers=("package://p/a.yaml",),
            active_controllers=("drive",),
            initial_positions={"elbow": 0.25},
            self_collision=True,
        ),
        Robot("b", "/abs/b.urdf", active_controllers=()),
    ),
    time_step=0.002,
    contact_approximation="sap",
    world=World(gravity=(0.0, 0.0, -1.62), ground_friction=0.3, wind=(3.0, -1.0, 0.0)),
    package_paths=("/packages",),
    static_transforms=(StaticTransform("world", "a_odom", xyz=(0.0, 0.0, 1.0)),),
    commands=(Command("/fleet/a/drive/commands", (1.0, 2.0), time=0.5, period=2.0),),
)


def refused(text, match, file="twin.yaml"):
    with pytest.raises(InputError, match=match) as error:
        ScenarioFile(text, file)
    return str(error.value)


def test_a_scenario_survives_being_saved_and_read():
    assert ScenarioFile(scenario_to_yaml(FULL), "twin.yaml").scenario == FULL


def test_defaults_are_left_out_of_the_yaml():
    text = scenario_to_yaml(Scenario(robots=(Robot("a", "package://p/a.urdf"),)))
    assert text == "version: 1\nrobots:\n  - name: a\n    model: package://p/a.urdf\n"


def test_file_names_in_a_scenario_are_relative_to_it(tmp_path):
    file = tmp_path / "twin.yaml"
    file.write_text("package_paths: [ws]\nrobots:\n  - {name: a, model: a.urdf, controllers: [c.yaml]}\n")
    scenario = ScenarioFile.read(file).scenario
    assert scenario.robots[0].model == str(tmp_path / "a.urdf")
    assert scenario.robots[0].controllers == (str(tmp_path / "c.yaml"),)
    assert scenario.package_paths == (str(tmp_path / "ws"),)


def test_a_world_file_is_relative_to_the_scenario_and_survives_the_way_through_yaml(tmp_path):
    text = "robots: [{name: a, model: /a.urdf}]\nworld: {file: worlds/w.sdf, ground_friction: 0.5}"
    scenario = ScenarioFile(text, tmp_path / "twin.yaml").scenario
    assert scenario.world == World(file=str(tmp_path / "worlds" / "w.sdf"), ground_friction=0.5)
    assert ScenarioFile(scenario_to_yaml(scenario), tmp_path / "other.yaml").scenario == scenario


def test_numbers_that_yaml_takes_for_text_are_numbers():
    scenario = ScenarioFile("time_step: 1e-3\nrobots: [{name: a, model: a.urdf}]", "twin.yaml").scenario
    assert scenario.time_step == 0.001


def test_xacro_arguments_are_text_whatever_yaml_takes_them_for():
    text = "robots: [{name: a, model: /a.urdf, xacro_args: {n: 4, sim: true, name: x}}]"
    assert ScenarioFile(text, "twin.yaml").scenario.robots[0].xacro_args == {"n": "4", "sim": "true", "name": "x"}


def test_a_missing_file_is_named():
    with pytest.raises(InputError, match=r"nowhere\.yaml: the scenario cannot be read"):
        ScenarioFile.read(Path("nowhere.yaml"))


def test_an_unknown_entry_is_named_with_its_line_and_the_closest_valid_one():
    refused(
        "robots:\n  - name: a\n    model: a.urdf\n    xzy: [0, 0, 0]\n",
        r"^twin\.yaml:4: robots\.0\.xzy: unknown entry\. Did you mean 'xyz'\? Valid: name, model, ",
    )


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("robots: []", r"twin\.yaml:1: robots: a twin needs at least one robot"),
        ("robots:\n- {name: a}", r"twin\.yaml:2: robots\.0: the entry 'model' is missing"),
        ("robots:\n- {name: a, model: m, xyz: [1, 2]}", r":2: robots\.0\.xyz: \[1, 2\] has 2 elements, but 3"),
        ("robots:\n- {name: a, model: m, xyz: [1, 2, x]}", r":2: robots\.0\.xyz\.2: 'x' is not a finite number"),
        ("robots:\n- {name: a, model: m, xyz: [1, 2, .nan]}", r"xyz\.2: nan is not a finite number"),
        ("robots:\n- {name: a, model: m, self_collision: maybe}", r"'maybe' is neither true nor false"),
        ("robots:\n- {name: a, model: [m]}", r"robots\.0\.model: \['m'\] is not text"),
        ("robots: a", r"twin\.yaml:1: robots: 'a' is not a list"),
        ("- a", r"twin\.yaml:1: \['a'\] is not a mapping"),
        ("", r"twin\.yaml: the file is empty: a scenario is needed"),
        ("robots: [{name: a, model: m}]\ntime_step: -0.001", r":2: time_step: -0\.001 s is not positive"),
        ("robots: [{name: a, model: m}]\ntime_step: 0", r":2: time_step: 0 s is not positive"),
        (
            "robots: [{name: a, model: m}]\ncontact_approximation: tamsi",
            r"unknown value 'tamsi': valid are lagged",
        ),
        ("robots:\n- {name: a, model: m}\n- {name: a, model: m}", r":3: robots\.1\.name: two robots are named 'a'"),
        ("robots: [{name: 'a b', model: m}]", r"'a b' is not a name"),
        ("robots: [{name: world, model: m}]", r"'world' is the name of another part of the twin"),
        (
            "robots: [{name: a, model: m}]\nstatic_transforms:\n- {parent: w, child: c}\n- {parent: v, child: c}",
            r":4: static_transforms\.1\.child: frame 'c' would have two parents",
        ),
        ("robots: [{name: a, model: m}]\ncommands: [{topic: t, data: [1], time: -1}]", r"is before the start"),
        ("robots: [{name: a, model: m}]\ncommands: [{topic: t, data: [1], period: 0}]", r"0 s is not a period"),
        ("robots: [", r"twin\.yaml:\d: this is not valid YAML"),
    ],
)
def test_a_value_that_cannot_be_used_is_named_with_file_and_line(text, match):
    refused(text, match)


def test_a_scenario_made_in_python_is_checked_as_well():
    with pytest.raises(ScenarioError, match="two robots are named 'a'"):
        Scenario(robots=(Robot("a", "m"), Robot("a", "m")))


A = (Robot("a", "/a.urdf"),)


def test_what_a_scenario_leaves_out_is_as_its_documentation_says():
    text = "robots: [{name: a, model: /a.urdf}]\nstatic_transforms: [{parent: world, child: odom}]"
    found = ScenarioFile(text, "twin.yaml").scenario
    assert (found.time_step, found.engine, found.accuracy, found.seed) == (1e-3, "discrete", 1e-3, 0)
    assert (found.sensor_noise, found.retune, found.world) == (True, False, World())
    (robot,), (frame,) = found.robots, found.static_transforms
    assert (robot.command_delay, robot.measurement_delay, robot.noise) == (0.0, 0.0, 1.0)
    assert robot.xyz == robot.rpy == frame.xyz == frame.rpy == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("values", "valid"),
    [
        ({"time_step": 1e-6}, True),
        ({"time_step": 0.9e-6}, False),
        ({"time_step": 0.1}, True),
        ({"time_step": 0.11}, False),
        ({"accuracy": 1e-9}, True),
        ({"accuracy": 0.9e-9}, False),
        ({"accuracy": 1.0}, True),
        ({"accuracy": 1.1}, False),
        ({"seed": 0}, True),
        ({"seed": -1}, False),
        ({"world": World(ground_friction=0.0)}, True),
        ({"world": World(ground_friction=-0.1)}, False),
        ({"world": World(contact="glue")}, False),
        ({"world": World(wind=(-5.0, 0.0, 1.0))}, True),
        ({"world": World(wind=(1e300, 0.0, 0.0))}, False),
        ({"robots": (Robot("a", "m", friction=0.0),)}, True),
        ({"robots": (Robot("a", "m", friction=-0.1),)}, False),
        ({"robots": (Robot("a", "m", joint_friction={"j": -0.1}),)}, False),
        ({"robots": (Robot("a", "m", noise=-0.1),)}, False),
        ({"robots": (Robot("a", "m", command_delay=1.0),)}, True),
        ({"robots": (Robot("a", "m", command_delay=1.1),)}, False),
        ({"robots": (Robot("a", "m", measurement_delay=-0.1),)}, False),
        ({"pushes": (Push("a", 0.0, force=(1.0, 0.0, 0.0)),)}, True),
        ({"pushes": (Push("a", 1e9, strength=1.0, duration=0.0),)}, True),
        ({"pushes": (Push("", 0.0, strength=1.0),)}, False),
        ({"pushes": (Push("a", -0.1, strength=1.0),)}, False),
        ({"pushes": (Push("a", 0.0, strength=1.0, duration=-0.1),)}, False),
        ({"pushes": (Push("a", 0.0, strength=0.0),)}, False),
        ({"pushes": (Push("a", 0.0),)}, False),
        ({"pushes": (Push("a", 0.0, force=(1.0, 0.0, 0.0), strength=1.0),)}, False),
    ],
)
def test_a_value_is_valid_up_to_its_bounds_and_not_beyond(values, valid):
    with nullcontext() if valid else pytest.raises(ScenarioError, match=f"^{next(iter(values))}"):
        Scenario(**{"robots": A} | values)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("r1", "r1"), ("r 1/b", "r_1_b"), ("a-b_c", "a-b_c"), ("world", "world_robot"), ("", "robot")],
)
def test_a_name_that_the_twin_cannot_take_is_made_one_that_it_can(name, expected):
    assert name_in_twin(name) == expected
    assert Scenario((Robot(expected, "m"),)).robots[0].name == expected


def test_letters_of_any_language_are_written_as_they_are():
    text = scenario_to_yaml(Scenario((Robot("a", "/räuber.urdf"),)))
    assert "model: /räuber.urdf\n" in text
    assert ScenarioFile(text, "twin.yaml").scenario.robots[0].model == "/räuber.urdf"


def test_a_number_of_numpy_is_written_as_a_plain_one():
    assert "time: 0.25\n" in scenario_to_yaml(Scenario(A, commands=(Command("/t", (1.0,), time=np.float64(0.25)),)))
