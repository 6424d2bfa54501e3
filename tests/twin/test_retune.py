"""Servo gains that follow the varied robot: those of a twin that is built from an edited file."""

import re
from dataclasses import replace

import pytest
from two_hinges import ROBOT, efforts, hinges, trajectories, velocities

from drake_twin import Twin, replay
from drake_twin.scenario import CENIC, DISCRETE
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.recording import Recording
from drake_twin.twin.varied_parameters import needs_build

# No digit of a product is lost with them, on either way.
VALUES = {
    "r.left_link.mass": 4.0,
    "r.left_link.izz": 0.125,
    "r.left_link.ixx": 0.875,
    "r.left.damping": 2.0,
    "r.right_link.mass": 8.0,
    "r.right_link.izz": 0.25,
}
LIMITS = '<limit effort="50.0" velocity="20"/>'
OFFSET = '<inertial><origin xyz="0 0.5 0"/>'


def edited(text):
    """The robot's file with the values in it."""
    base, left, right = re.split('(?=<link name="(?:left|right)_link">)', text)
    right, joints = right.split("</link>", 1)
    left = left.replace('mass value="1"', 'mass value="4"').replace('izz="0.5"', 'izz="0.125"')
    left = left.replace('ixx="1"', 'ixx="0.875"')
    right = right.replace('mass value="1"', 'mass value="8"').replace('izz="0.5"', 'izz="0.25"')
    joints = joints.replace(LIMITS, LIMITS + '<dynamics damping="2.0"/>', 1)
    return f"{base}{left}{right}</link>{joints}"


CONTROLLERS = {
    "trajectories": {"arm": trajectories("left", "right")},
    "velocities": {"arm": velocities("left", "right")},
    "efforts": {"arm": efforts("left")},
}


def scenario_of(folder, kind, **options):
    builder = hinges(folder, CONTROLLERS[kind], **options)
    if kind == "trajectories":
        point = {"positions": [0.7, -0.4], "time_from_start": {"sec": 0, "nanosec": 300_000_000}}
        return builder.command(
            "/r/arm/joint_trajectory", {"joint_names": ["left", "right"], "points": [point]}
        ).scenario()
    return builder.command("/r/arm/commands", [3.0, -1.0] if kind == "velocities" else [0.5]).scenario()


def gains(twin):
    actuators = [twin.plant.get_joint_actuator(index) for index in twin.plant.GetJointActuatorIndices()]
    return [(item.get_controller_gains().p, item.get_controller_gains().d) for item in actuators]


def motion(twin, seconds=2.0):
    found = []
    for step in range(1, 21):
        twin.advance_to(step * seconds / 20)
        state = twin.robot_state("r")
        found.append((state.positions, state.velocities, state.efforts))
    return found


@pytest.mark.parametrize("kind", CONTROLLERS)
@pytest.mark.parametrize("gravity", [False, True])
def test_a_retuned_twin_is_one_of_the_edited_file_to_the_bit(tmp_path, kind, gravity):
    scenario = scenario_of(tmp_path, kind)
    file = tmp_path / "hinges.urdf"
    if gravity:  # it turns the links about their joints
        file.write_text(ROBOT.replace('axis xyz="0 0 1"', 'axis xyz="1 0 0"').replace("<inertial>", OFFSET))
    varied = replace(scenario, values=VALUES, retune=True)
    twin, nominal, stiff = Twin(varied), Twin(scenario), Twin(replace(varied, retune=False))
    retuned = gains(twin)
    assert gains(stiff) == gains(nominal) != retuned
    moved = motion(twin)
    file.write_text(edited(file.read_text()))
    of_file = Twin(scenario)
    assert gains(of_file) == retuned
    assert motion(of_file) == moved
    assert motion(nominal) != moved


@pytest.mark.parametrize("engine", [DISCRETE, CENIC])
def test_set_on_a_built_twin_is_the_same_to_the_bit_as_built_with_it(tmp_path, engine):
    scenario = scenario_of(tmp_path, "velocities", engine=engine)
    plain, varied = replace(scenario, values=VALUES), replace(scenario, values=VALUES, retune=True)
    twin, hashes = Twin(plain), []
    for each in (plain, varied, replace(varied, values={"r.left_link.mass": 8.0}), plain, varied):
        twin.reset(each)
        fresh = Twin(each)
        assert gains(twin) == gains(fresh)
        for one in (twin, fresh):
            one.advance_to(2.0)
        assert twin.state_sha256() == fresh.state_sha256()
        hashes.append(twin.state_sha256())
    assert hashes[0] == hashes[3] != hashes[1] == hashes[4]


def test_yaml_rebuilds_restore_and_replay_keep_it(tmp_path):
    varied = replace(scenario_of(tmp_path, "velocities"), values=VALUES, retune=True)
    assert ScenarioFile(scenario_to_yaml(varied), "x.yaml").scenario == varied
    twin = Twin(replace(varied, retune=False))
    twin.recorder.begin()
    twin.reset(varied)
    start = gains(twin)
    twin.advance_to(0.2)
    tuned = gains(twin)
    snapshot = twin.snapshot()
    twin.entities.spawn(replace(varied.robots[0], name="s", xyz=(9.0, 0.0, 0.0)))
    assert gains(twin)[: len(tuned)] == tuned
    twin.entities.delete("s")
    assert gains(twin) == tuned
    twin.reset()
    assert gains(twin) == start
    twin.advance_to(1.0)
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    other = Twin(replace(varied, retune=False))
    other.restore(snapshot)
    assert gains(other) == tuned


def test_only_values_of_robots_need_a_build_and_only_where_they_retune(tmp_path):
    scenario = scenario_of(tmp_path, "velocities")
    with Twin(scenario) as twin:
        plans = twin.built.plans
    tuned = replace(scenario, retune=True, values={"friction": 0.5})
    for values, wanted in (({"friction": 0.7}, False), ({"friction": 0.5, "r.payload": 1.0}, True)):
        assert needs_build(tuned, replace(tuned, values=values), plans) is wanted
        stiff = replace(tuned, retune=False)
        assert needs_build(stiff, replace(stiff, values=values), plans) is False
