"""What may be varied: paths into a scenario, and how their values are written."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from conftest import rovers
from scipy import stats
from sweep_files import hinge_scenario

from drake_twin import Twin
from drake_twin.errors import InputError
from drake_twin.scenario import CENIC, Robot, Scenario
from drake_twin.sweeps.variation import Design, Variation, with_value


@pytest.fixture
def scenario(tmp_path):
    return hinge_scenario(tmp_path)


def test_a_path_sets_one_entry_of_the_scenario(scenario):
    def robot(path, value):
        return with_value(scenario, path, value).robots[0]

    assert with_value(scenario, "gravity", 3.7).world.gravity == (0, 0, -3.7)
    assert with_value(scenario, "ground_friction", 0.4).world.ground_friction == 0.4
    assert with_value(scenario, "time_step", 0.002).time_step == 0.002
    assert with_value(scenario, "friction", 0.4).values == {"friction": 0.4}
    assert with_value(scenario, "hinge.arm.mass", 2.0).values == {"hinge.arm.mass": 2.0}
    assert with_value(scenario, "hinge.payload", 2.0).values == {"hinge.payload": 2.0}
    assert robot("hinge.z", 0.5).xyz == (0, 0, 0.5)
    assert robot("hinge.pitch", 0.1).rpy == (0, 0.1, 0)
    assert robot("hinge.friction", 0.3).friction == 0.3
    assert robot("hinge.hinge.friction", 0.3).joint_friction == {"hinge": 0.3}
    assert robot("hinge.hinge.position", 0.3).initial_positions == {"hinge": 0.3}
    assert robot("hinge.args.size", "small").xacro_args == {"size": "small"}
    assert robot("hinge.args.length", 2.0).xacro_args == {"length": "2"}
    assert robot("hinge.velocity.command_timeout", 0.5).controller_parameters == {"velocity": {"command_timeout": 0.5}}


@pytest.mark.parametrize(
    ("path", "value", "changed"),
    [("hinge.velocity.command_timeout", 0.05, True), ("hinge.hinge.friction", 40.0, True), ("gravity", 0.0, False)],
)
def test_what_needs_a_build_is_built_by_a_reset_to_the_same_bits(scenario, path, value, changed):
    varied = with_value(scenario, path, value)
    twin, fresh = Twin(scenario), Twin(varied)
    first = twin.diagram
    twin.advance_to(0.5)
    plain = twin.robot_state("hinge").positions
    twin.reset(varied)
    assert twin.diagram is not first
    for each in (twin, fresh):
        each.advance_to(0.5)
    assert twin.state_sha256() == fresh.state_sha256()
    assert (twin.robot_state("hinge").positions != plain) is changed  # the axis is vertical: no gravity acts


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("friction=0.3:1.0:8", (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)),
        ("a.b.mass=1,2.5, 3e0", (1.0, 2.5, 3.0)),
        ("a.args.size=small,large", ("small", "large")),
        ("a.z=-1:1:3", (-1.0, 0.0, 1.0)),
    ],
)
def test_lists_and_ranges(text, values):
    parsed = Variation.parse(text).values
    assert parsed == values if isinstance(values[0], str) else parsed == pytest.approx(values)


@pytest.mark.parametrize(
    ("text", "distribution"),
    [
        ("x=uniform(0.2,0.9)", stats.uniform(0.2, 0.7)),
        ("x=normal(3,0.5)", stats.norm(3, 0.5)),
        ("x=loguniform(0.01,10)", stats.loguniform(0.01, 10)),
    ],
)
def test_samples_have_the_distribution_that_is_asked_for(text, distribution):
    values = Design((Variation.parse(text),), samples=256).values()["x"]
    assert stats.kstest(values, distribution.cdf).statistic < 0.02  # of Sobol's points; random ones have 0.08
    assert values == Design((Variation.parse(text),), samples=256).values()["x"]


def test_a_design_has_each_combination_once_with_its_number():
    design = Design(
        (Variation.parse("a=1,2"), Variation.parse("b=uniform(0,1)"), Variation.parse("c=x,y,z")), 4, (0, 1, 2)
    )
    episodes = list(design.episodes())
    assert len(episodes) == len(design) == 2 * 4 * 3 * 3
    assert [episode.number for episode in episodes] == list(range(72))
    assert {(*episode.values,) for episode in episodes} == {("a", "b", "c")}
    counts = Counter((*episode.values.values(), episode.seed) for episode in episodes)
    assert set(counts.values()) == {1}
    drawn = {episode.values["b"] for episode in episodes}
    assert sorted(np.floor(np.array(sorted(drawn)) * 4)) == [0, 1, 2, 3]


def test_an_episodes_scenario_has_its_values_and_its_seed(scenario):
    (_, episode) = Design((Variation.parse("hinge.payload=2"),), seeds=(0, 7)).episodes()
    assert episode.scenario(scenario) == replace(scenario, values={"hinge.payload": 2.0}, seed=7)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("friction", "it must read PATH=VALUES"),
        ("friction=", "it must read PATH=VALUES"),
        ("friction=0:1:1", "needs two values or more"),
        ("friction=0:1:1000000000", "a million values at most"),
        ("friction=unifrom(0,1)", "Did you mean 'uniform(a,b)'"),
        ("friction=uniform(1,0)", "the first number must be less"),
        ("friction=normal(1,0)", "standard deviation 0 is not above zero"),
        ("friction=loguniform(0,1)", "has no logarithm"),
        ("friction=1,,2", "a value is missing"),
        ("friction=1,nan", "not a finite number"),
        ("friction=0:1e999:3", "1e999 is not a finite number"),
        ("friction=uniform(0,1e999)", "1e999 is not a finite number"),
        ("friction=2,1,2.0", "the value 2 stands there twice"),
        ("friction=1:1:3", "the value 1 stands there twice"),
        ("a.args.size=small,small", "the value small stands there twice"),
    ],
)
def test_what_cannot_be_read_is_refused(text, message):
    with pytest.raises(InputError) as refused:
        Variation.parse(text)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("spec", "values"),
    [
        ("a.args.x=0.6,2", (0.6, 2.0)),  # numbers where the file reads the same text
        ("a.args.x=007,2", ("007", "2")),
        ("launch.x=1e3,1.0", ("1e3", "1.0")),
        ("launch.x=nan", ("nan",)),
        ("a.args.x=2,b", ("2", "b")),
        ("a.controller.mode=1,b", ("1", "b")),
        ("friction=1e-1,2.0", (0.1, 2.0)),
        ("friction=1_000", ("1_000",)),
    ],
)
def test_the_text_of_arguments_stays(spec, values):
    assert Variation.parse(spec).values == values


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("frictoin", 1.0, "Did you mean 'friction'"),
        ("hing.payload", 1.0, "nothing of this name to vary. Valid: friction, ground_friction, gravity"),
        ("hinge.payloda", 1.0, "Did you mean 'hinge.payload'"),
        ("hinge.arm.mass", "heavy", "'heavy' is not a number"),
        ("time_step", -1.0, "-1 s is not positive"),
        ("hinge.friction", -1.0, "-1 is below zero"),
        ("accuracy", 1e-4, "the engine discrete has none"),
    ],
)
def test_a_path_or_a_value_that_does_not_fit_is_refused(scenario, path, value, message):
    with pytest.raises(InputError) as refused:
        with_value(scenario, path, value)
    assert message in str(refused.value)


def test_a_path_given_twice_is_refused():
    with pytest.raises(InputError, match="--vary friction is given twice"):
        Design((Variation.parse("friction=1,2"), Variation.parse("friction=3,4")))


WHEELS = "/robot_1/forward_velocity_controller/commands"
BUILT = {
    "ground_friction": 0.4,
    "gravity": 3.7,
    "time_step": 0.002,
    "robot_1.x": 0.7,
    "robot_1.y": -0.4,
    "robot_1.z": 0.2,
    "robot_1.roll": 0.1,
    "robot_1.pitch": -0.1,
    "robot_1.yaw": 0.6,
    "robot_1.friction": 0.3,
    "robot_1.noise": 0.0,
    "robot_1.command_delay": 0.05,
    "robot_1.measurement_delay": 0.004,
    "robot_1.robot_1_front_left_wheel_joint.position": 0.3,
    "robot_1.robot_1_front_left_wheel_joint.friction": 0.5,
    "robot_1.forward_velocity_controller.command_timeout": 0.4,
}


BOX = """<robot name="box" xmlns:xacro="http://ros.org/xacro"><xacro:arg name="width" default="0.3"/>
<link name="box"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="$(arg width) 0.4 0.3"/></geometry></collision></link></robot>"""


@pytest.fixture(scope="module")
def driving():
    """A scenario of two rovers of which one drives, and a twin of it that all paths are set on, one after the other."""
    scenario = replace(
        rovers(2, 1.0).scenario(), commands=rovers(2).command(WHEELS, [9.0, 2.0, 9.0, 2.0]).scenario().commands
    )
    with Twin(scenario) as twin:
        yield scenario, twin


def assert_set_by_a_reset_is_built_with_it(twin, varied):
    """A twin that is reset to a scenario, and a new one of it, are equal to the bit after two seconds."""
    twin.reset(varied)
    with Twin(varied) as fresh:
        for one in (twin, fresh):
            one.advance_to(2.0)
        assert twin.state_sha256() == fresh.state_sha256()
        return twin.state_sha256()


@pytest.mark.parametrize("path", BUILT)
def test_every_path_that_needs_a_build_is_set_by_a_reset_to_the_same_bits(driving, path):
    scenario, twin = driving
    assert_set_by_a_reset_is_built_with_it(twin, with_value(scenario, path, BUILT[path]))


def test_an_accuracy_is_set_by_a_reset_to_the_same_bits(scenario):
    scenario = replace(scenario, engine=CENIC)
    with Twin(scenario) as twin:
        hashes = [
            assert_set_by_a_reset_is_built_with_it(twin, with_value(scenario, "accuracy", value))
            for value in (1e-2, 1e-5, 1e-2)
        ]
    assert hashes[0] == hashes[2] != hashes[1]


def test_a_xacro_argument_is_set_by_a_reset_to_the_same_bits(tmp_path):
    file = tmp_path / "box.xacro"
    file.write_text(BOX)
    scenario = Scenario((Robot("box", str(file), xyz=(0.0, 0.0, 1.0), rpy=(0.3, 0.1, 0.0)),))
    with Twin(scenario) as twin:
        hashes = [
            assert_set_by_a_reset_is_built_with_it(twin, with_value(scenario, "box.args.width", value))
            for value in (0.5, 0.7, 0.5)
        ]
    assert hashes[0] == hashes[2] != hashes[1]
