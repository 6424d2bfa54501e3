"""Pushes of a scenario: forces on links at their times, kept by files, snapshots, recordings and the hash."""

from dataclasses import replace
from math import atan2, hypot

import numpy as np
import pytest
from conftest import ROVER, rovers
from scipy import stats
from world_with_crate import rover_and_crate

from drake_twin import Twin, replay
from drake_twin.errors import RunError
from drake_twin.scenario import Push, Robot, Scenario, ScenarioError, World
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.recording import Recording
from drake_twin.twin.snapshot import Snapshot

BOX = """<robot name="box"><link name="box_body"><inertial><origin xyz="0.3 0.2 -0.1"/><mass value="3"/>
<inertia ixx="0.02" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@pytest.fixture
def free(tmp_path):
    """A box of 3 kg that nothing holds."""
    (tmp_path / "box.urdf").write_text(BOX)
    return Scenario((Robot("box", str(tmp_path / "box.urdf")),), world=World(gravity=(0.0, 0.0, 0.0), ground=False))


@pytest.mark.parametrize("time_step", [0.001, 0.004, 0.01])
@pytest.mark.parametrize("duration", [0.0, 0.1, 0.2])
def test_the_change_of_speed_is_impulse_over_mass(free, time_step, duration):
    push = Push("box", 0.2, force=(20.0, -7.0, 5.0), duration=duration)
    twin = Twin(replace(free, time_step=time_step, pushes=(push,)))
    twin.advance_to(0.2)
    assert twin.entities.state("box").linear == (0.0, 0.0, 0.0)
    twin.advance_to(1.0)
    expected = np.array(push.force) * max(duration, time_step) / 3.0
    assert twin.entities.state("box").linear == pytest.approx(tuple(expected), rel=1e-9)
    assert twin.entities.state("box").angular == pytest.approx((0, 0, 0), abs=1e-12)


def test_a_push_beside_the_center_of_mass_turns_the_box(free):
    push = Push("box", 0.0, force=(0.0, 3.0, 0.0), duration=0.01, at=(0.8, 0.2, -0.1))
    twin = Twin(replace(free, pushes=(push,)))
    twin.advance_to(0.1)
    assert twin.entities.state("box").angular == pytest.approx((0, 0, 0.5 * 3.0 * 0.01 / 0.06), rel=1e-3)


def test_pushes_add_up_and_end_each_at_its_own_time(free):
    pushes = (Push("box", 0.1, force=(3.0, 0.0, 0.0), duration=0.4), Push("box", 0.3, force=(0.0, 6.0, 0.0)))
    twin = Twin(replace(free, pushes=pushes))
    twin.advance_to(0.35)
    assert twin.entities.state("box").linear == pytest.approx((0.25, 0.1, 0.0), rel=1e-9)
    twin.advance_to(1.0)
    assert twin.entities.state("box").linear == pytest.approx((0.4, 0.2, 0.0), rel=1e-9)


def test_a_drawn_direction_is_horizontal_follows_from_the_seed_and_is_as_often_this_as_that(free):
    first, second = Push("box", 0.0, strength=30.0), Push("box", 0.5, strength=30.0)
    twin = Twin(replace(free, pushes=(first, second)))
    angles = []
    for seed in range(200):
        twin.reset(replace(free, pushes=(first, second), seed=seed))
        twin.advance_to(0.2)
        x, y, z = twin.entities.state("box").linear
        assert (hypot(x, y), z) == (pytest.approx(1.0, rel=1e-9), pytest.approx(0.0, abs=1e-12))
        angles.append(atan2(y, x))
        if seed < 3:
            twin.advance_to(0.7)
            changed = np.array(twin.entities.state("box").linear) - (x, y, z)
            assert hypot(*changed[:2]) == pytest.approx(1.0, rel=1e-6)
            assert abs(atan2(changed[1], changed[0]) - angles[-1]) > 1e-3
            again = Twin(replace(free, pushes=(first, second), seed=seed))
            again.advance_to(0.7)
            assert again.state_sha256() == twin.state_sha256()
    assert stats.kstest(angles, stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 0.01


def driven(**more):
    commands = rovers(2).command("/robot_1/forward_velocity_controller/commands", [9, 2, 9, 2]).scenario().commands
    return replace(rovers(2, 1.0).scenario(), commands=commands, **more)


PUSHES = (Push("robot_1", 0.3, strength=200.0), Push("robot_2::base_link", 1.0, force=(0.0, 80.0, 5.0), duration=0.3))


def after(twin, seconds):
    twin.advance_to(twin.time + seconds)
    return twin.state_sha256()


def test_set_on_a_built_twin_is_the_same_to_the_bit_as_built_with_it():
    plain, pushed = driven(), driven(pushes=PUSHES, seed=3)
    twin = Twin(plain)
    diagram = twin.diagram
    unpushed = after(twin, 2.0)
    twin.reset(pushed)
    assert twin.diagram is diagram, "it was built again"
    assert twin.scenario == pushed
    assert after(twin, 2.0) == after(Twin(pushed), 2.0) != unpushed
    twin.reset()
    assert after(twin, 2.0) == after(Twin(pushed), 2.0)
    twin.reset(plain)
    assert after(twin, 2.0) == unpushed


def test_yaml_snapshots_restore_recordings_and_rebuilds_keep_them(tmp_path):
    pushed = driven(pushes=PUSHES)
    assert ScenarioFile(scenario_to_yaml(pushed), "x.yaml").scenario == pushed
    twin = Twin(driven())
    twin.recorder.begin()
    twin.reset(pushed)
    known = {}
    for time in (0.1, 0.35, 0.7, 1.1, 1.7):  # before, within and after each push
        twin.advance_to(time)
        known[time] = twin.snapshot()
    end = after(twin, 0.3)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    assert [len(snapshot.pushes) for snapshot in known.values()] == [2, 1, 1, 0, 0]
    known[0.7].save(tmp_path / "state.json")
    known[0.7] = Snapshot.load(tmp_path / "state.json")
    for time, snapshot in known.items():
        twin.restore(snapshot)
        assert after(twin, 2.0 - time) == end, time
    twin.restore(known[0.35])
    twin.entities.spawn(Robot("third", ROVER, xyz=(9, 9, 0.13)))
    twin.entities.delete("third")
    assert twin.snapshot().pushes == known[0.35].pushes


def test_a_push_is_made_once_though_the_step_changes_beside_it(free):
    for change in (0.1, 0.104, 0.108):
        twin = Twin(replace(free, pushes=(Push("box", 0.101, force=(3.0, 0.0, 0.0), duration=0.5),)))
        twin.advance_to(change)
        twin.clock.set_time_step(0.004)
        twin.advance_to(1.0)
        assert twin.entities.state("box").linear[0] == pytest.approx(0.5, abs=0.005)


def test_a_deleted_robot_takes_its_pushes_with_it():
    twin = Twin(driven(pushes=PUSHES))
    twin.entities.delete("robot_2")
    assert twin.scenario.pushes == PUSHES[:1]
    assert len(twin.snapshot().pushes) == 1
    twin.advance_to(1.5)


def test_a_model_of_the_world_can_be_pushed(tmp_path):
    scenario = rover_and_crate(tmp_path).scenario()
    twin = Twin(replace(scenario, pushes=(Push("crate", 0.1, force=(0.0, 0.0, 1000.0), duration=0.2),)))
    twin.advance_to(0.1)
    before = twin.entities.state("crate").position[2]
    twin.advance_to(0.3)
    assert twin.entities.state("crate").position[2] > before + 0.01


def test_a_step_that_fails_leaves_a_push_to_come(free):
    twin = Twin(replace(free, pushes=(Push("box", 0.0, force=(1e300, 0.0, 0.0), duration=1.0),)))
    for _ in range(2):
        with pytest.raises(RunError):
            twin.advance_to(0.5)
        assert len(twin.snapshot().pushes) == 1
        assert twin.time == 0.0


@pytest.mark.parametrize(
    ("push", "message"),
    [
        (Push("robot_3", 1.0, strength=1.0), "Entity [robot_3] does not exist. Did you mean 'robot_"),
        (Push("robot_1::base_lnk", 1.0, strength=1.0), "has no link 'base_lnk'"),
        (Push("", 1.0, strength=1.0), "needs a robot, a link or a model"),
        (Push("robot_1", 1.0), "either a force (three numbers) or a strength"),
        (Push("robot_1", 1.0, force=(1, 0, 0), strength=1.0), "either a force (three numbers) or a strength"),
        (Push("robot_1", 1.0, strength=-1.0), "-1 N is not above zero"),
        (Push("robot_1", -1.0, strength=1.0), "-1 s is not a time from zero"),
        (Push("robot_1", 1.0, strength=1.0, duration=-1.0), "-1 s is not a duration"),
        (Push("robot_1", 1.0, force=(1.0, float("nan"), 0.0)), "nan is not a finite number"),
    ],
)
def test_a_push_that_cannot_be_made_is_refused_and_changes_nothing(push, message):
    twin = Twin(driven())
    before, scenario = twin.state_sha256(), twin.scenario
    with pytest.raises(ScenarioError) as refused:
        twin.reset(replace(scenario, pushes=(push,)))
    assert message in str(refused.value)
    assert (twin.state_sha256(), twin.scenario) == (before, scenario)
