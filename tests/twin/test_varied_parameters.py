"""Values of a scenario that are set in the context of a built twin: the same as a build with them, to the bit."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from conftest import ROVER, rovers

from drake_twin import Twin, TwinBuilder, replay
from drake_twin.errors import InputError
from drake_twin.scenario import Robot, Scenario, ScenarioError, World
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.recording import Recording
from drake_twin.twin.snapshot import Snapshot

WHEELS = "/robot_1/forward_velocity_controller/commands"
WHEEL = "robot_1.front_left_wheel_joint"
VALUES = {
    "friction": 0.05,
    "robot_1.base_link.mass": 9.0,
    "robot_1.base_link.inertia": 1.7,
    "robot_1.base_link.izz": 0.42,
    "robot_1.payload": 1.5,
    "robot_1.front_left_wheel.payload": 0.3,
    f"{WHEEL}.damping": 0.4,
    f"{WHEEL}.rotor_inertia": 0.002,
    f"{WHEEL}.gear_ratio": 3.0,
}


def driven(scenario):
    """A twin that spins its wheels and steers, from rest."""
    return replace(scenario, commands=rovers(2).command(WHEELS, [9.0, 2.0, 9.0, 2.0]).scenario().commands)


@pytest.fixture(scope="module")
def scenario():
    return driven(rovers(2, 1.0).scenario())


def after(twin, seconds=2.0):
    twin.advance_to(twin.time + seconds)
    return twin.state_sha256()


@pytest.mark.parametrize("name", VALUES)
def test_set_on_a_built_twin_is_the_same_to_the_bit_as_built_with_it(scenario, name):
    varied = replace(scenario, values={name: VALUES[name]})
    twin = Twin(replace(scenario, values={name: 0.7}) if name == "friction" else scenario)
    diagram = twin.diagram
    twin.advance_to(0.3)
    plain = Twin(scenario)
    twin.reset(varied)
    assert twin.diagram is diagram, "it was built again"
    assert twin.scenario == varied
    assert after(twin) == after(Twin(varied)) != after(plain)


def test_all_at_once_and_after_a_build_for_another_reason(scenario):
    varied = replace(scenario, values=VALUES)
    other = replace(varied, time_step=0.002, values={"friction": 0.9}, world=World(gravity=(0.0, 0.0, -3.0)))
    twin = Twin(other)
    twin.advance_to(0.2)
    twin.reset(varied)
    assert after(twin) == after(Twin(varied))
    twin.reset(other)
    assert after(twin) == after(Twin(other))


def test_yaml_holds_them_and_a_reset_returns_to_them(scenario):
    varied = replace(scenario, values=VALUES)
    assert ScenarioFile(scenario_to_yaml(varied), "x.yaml").scenario == varied
    twin = Twin(varied)
    first = after(twin)
    twin.entities.set_values({"friction": 0.6, "robot_1.payload": 4.0})
    assert after(twin) != first
    twin.reset()
    assert after(twin) == first


def test_a_change_while_it_runs_is_kept_by_snapshot_restore_spawn_and_replay(scenario, tmp_path):
    twin = Twin(replace(scenario, values={"friction": 1.0}))
    twin.recorder.begin()
    twin.advance_to(0.2)
    twin.entities.set_values({"friction": 0.03, "robot_1.base_link.mass": 20.0, f"{WHEEL}.damping": 2.0})
    snapshot = twin.snapshot()
    assert Snapshot(**vars(snapshot)).parameters == snapshot.parameters != {}
    changed = after(twin, 0.5)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == changed

    def mass_and_friction(twin):
        body = twin.plant.GetBodyByName("robot_1_base_link", twin.plant.GetModelInstanceByName("robot_1"))
        shapes = {name: values for name, values in twin.snapshot().parameters.items() if name.startswith("shape")}
        return body.get_mass(twin.plant.GetMyContextFromRoot(twin.context)), list(shapes.values())

    kept = mass_and_friction(twin)
    assert kept[0] == 20.0
    twin.restore(snapshot)
    assert mass_and_friction(twin) == kept
    assert after(twin, 0.5) == changed
    twin.entities.spawn(Robot("third", ROVER, xyz=(5, 5, 0.13)))
    assert mass_and_friction(twin) == kept
    twin.entities.delete("third")
    twin.clock.set_time_step(0.002)
    assert mass_and_friction(twin) == kept
    twin.reset()
    assert mass_and_friction(twin)[0] != 20.0


def test_a_robot_that_is_spawned_slips_on_the_varied_ground_as_the_others(scenario):
    twin = Twin(replace(rovers(1).scenario(), values={"friction": 0.02}))
    twin.entities.spawn(Robot("robot_2", ROVER, xyz=(0, 3, 0.13)))
    for robot in twin.robots:
        twin.publish(f"/{robot}/forward_velocity_controller/commands", [10.0] * 4)
    twin.advance_to(1.0)
    one, two = (twin.entities.state(robot).position[0] for robot in twin.robots)
    assert two == pytest.approx(one, rel=1e-3)
    assert one == pytest.approx(0.5 * 0.02 * 9.81, rel=0.1)


def test_a_deleted_robot_takes_its_values_with_it(scenario):
    twin = Twin(replace(scenario, values={"friction": 0.5, "robot_2.payload": 1.0}))
    twin.entities.delete("robot_2")
    assert twin.scenario.values == {"friction": 0.5}


BOX = """<robot name="box"><link name="box"><inertial><mass value="3"/>
<inertia ixx="0.02" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision></link></robot>"""


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.35, 0.6, 0.9])
def test_a_box_slides_as_far_as_its_speed_and_the_friction_say(tmp_path, friction):
    (tmp_path / "box.urdf").write_text(BOX)
    scenario = TwinBuilder().robot("box", tmp_path / "box.urdf", xyz=(0, 0, 0.05)).scenario()
    twin = Twin(replace(scenario, values={"friction": 1.0}))
    twin.reset(replace(scenario, values={"friction": friction}))
    twin.advance_to(0.1)
    start, speed = twin.entities.state("box").position[0], 1.5
    twin.entities.set_state("box", linear=(speed, 0, 0))
    twin.advance_to(0.1 + 1.3 * speed / (friction * 9.81))
    assert twin.entities.state("box").position[0] - start == pytest.approx(speed**2 / (2 * friction * 9.81), rel=0.03)


PENDULUM = """<robot name="p"><link name="world"/><link name="arm">
<inertial><origin xyz="0 0 -0.5"/><mass value="{mass}"/>
<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>
<dynamics damping="{damping}"/></joint></robot>"""


SLOW = pytest.mark.slow


@pytest.mark.parametrize("mass", [0.3, *(pytest.param(mass, marks=SLOW) for mass in (0.8, 1.0, 2.0)), 7.0])
@pytest.mark.parametrize("damping", [pytest.param(0.0, marks=SLOW), 0.05])
def test_a_pendulum_swings_with_the_period_and_decay_of_its_mass_and_damping(tmp_path, mass, damping):
    (tmp_path / "p.urdf").write_text(PENDULUM.format(mass=1.0, damping=0.3))
    scenario = TwinBuilder(time_step=1e-5).robot("p", tmp_path / "p.urdf", initial_positions={"j": 1e-3}).scenario()
    twin = Twin(scenario)
    twin.reset(replace(scenario, values={"p.arm.mass": mass, "p.j.damping": damping}))
    inertia = 0.02 + mass * 0.25
    decay = damping / (2 * inertia)
    frequency = sqrt(mass * 9.81 * 0.5 / inertia - decay**2)
    period = 2 * pi / frequency
    twin.advance_to(period)
    state = twin.robot_state("p")
    reached = 1e-3 * np.exp(-decay * period)
    assert state.positions[0] == pytest.approx(reached, rel=1e-4)
    late = -state.velocities[0] / (reached * (frequency**2 + decay**2))  # how far the turning point is away (s)
    assert late == pytest.approx(0, abs=1e-4 * period)


def test_a_link_without_mass_takes_a_payload_or_a_mass(tmp_path):
    frame = '<link name="tool"/><joint name="f" type="fixed"><parent link="arm"/><child link="tool"/>'
    frame += '<origin xyz="0 0 -1"/></joint></robot>'
    (tmp_path / "p.urdf").write_text(PENDULUM.format(mass=1.0, damping=0.0).replace("</robot>", frame))
    scenario = TwinBuilder().robot("p", tmp_path / "p.urdf").scenario()
    nominal = 0.02 + 0.25
    for values, moment in (
        ({"p.tool.payload": 2.0}, nominal + 2.0),
        ({"p.tool.payload": 0.0}, nominal),
        ({"p.tool.mass": 3.0}, nominal + 3.0),
        ({"p.tool.mass": 3.0, "p.tool.payload": 1.0}, nominal + 4.0),
    ):
        twin = Twin(replace(scenario, values=values))
        mass_matrix = twin.plant.CalcMassMatrix(twin.plant.GetMyContextFromRoot(twin.context))
        assert mass_matrix[0, 0] == pytest.approx(moment, rel=1e-12), values


def test_the_mass_matrix_is_pinocchios_of_the_varied_file(tmp_path):
    pinocchio = pytest.importorskip("pinocchio")
    (tmp_path / "p.urdf").write_text(PENDULUM.format(mass=1.0, damping=0.0))
    scenario = TwinBuilder().robot("p", tmp_path / "p.urdf").scenario()
    for mass in (0.25, 1.0, 3.7):
        twin = Twin(replace(scenario, values={"p.arm.mass": mass}))
        model = pinocchio.buildModelFromXML(PENDULUM.format(mass=mass, damping=0.0))
        mine = twin.plant.CalcMassMatrix(twin.plant.GetMyContextFromRoot(twin.context))
        theirs = pinocchio.crba(model, model.createData(), pinocchio.neutral(model))
        assert mine[0, 0] == pytest.approx(theirs[0, 0], rel=1e-12)


def test_a_robots_friction_and_that_of_a_joint_and_a_controllers_parameter_are_the_scenarios(tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    box = Robot("box", str(tmp_path / "box.urdf"), xyz=(0, 0, 0.05), friction=0.25)
    twin = Twin(Scenario((box,)))
    twin.advance_to(0.1)
    twin.entities.set_state("box", linear=(1.0, 0, 0))
    twin.advance_to(1.5)
    assert twin.entities.state("box").position[0] == pytest.approx(1 / (2 * 0.25 * 9.81), rel=0.03)
    (tmp_path / "p.urdf").write_text(PENDULUM.format(mass=1.0, damping=0.0))
    held = Robot("p", str(tmp_path / "p.urdf"), initial_positions={"j": 0.1}, joint_friction={"j": 3.0})
    twin = Twin(Scenario((held,)))
    twin.advance_to(1.0)
    assert twin.robot_state("p").positions[0] == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"frictoin": 1.0}, "unknown value 'frictoin'. Did you mean 'friction'"),
        ({"friction": -0.1}, "friction is -0.1: it must be zero or above"),
        ({"robot_1.base_link.mass": 0.0}, "robot_1.base_link.mass is 0: it must be above zero"),
        ({"robot_1.base_lnk.mass": 1.0}, "has no link 'base_lnk'. Did you mean 'robot_1_base_link'"),
        ({"robot_1.base_link.mas": 1.0}, "unknown value 'robot_1.base_link.mas'. Did you mean"),
        ({"robot_1.wheel.damping": 1.0}, "has no movable joint 'wheel'. Valid: robot_1_front_left_wheel_joint"),
        ({"robot_1.wheel.gear_ratio": 1.0}, "has no driven joint 'wheel'. Valid: robot_1_front_left_wheel_joint"),
        ({"robot_1.base_link.izz": 50.0}, "the largest principal moment must not exceed the sum of the others"),
        ({"robot_1.payload": 1.0, "robot_1.base_link.payload": 1.0}, "the payload of base_link is given twice"),
        ({"robot_3.payload": 1.0}, "unknown value 'robot_3.payload'. Did you mean 'robot_2.…'"),
    ],
)
def test_a_value_that_is_unknown_or_not_physical_is_refused_and_changes_nothing(scenario, values, text):
    with pytest.raises(ScenarioError) as refused:
        Twin(replace(scenario, values=values))
    assert text in str(refused.value)
    twin = Twin(scenario)
    before = twin.state_sha256()
    for call in (twin.reset, lambda varied: twin.entities.set_values(varied.values)):
        with pytest.raises(InputError):
            call(replace(scenario, values=values))
        assert (twin.state_sha256(), twin.scenario) == (before, scenario)
