"""Robots and models of the world are put elsewhere and deleted while all else goes on as it was."""

import numpy as np
import pytest
from conftest import ARM
from world_with_crate import CRATE_AT, rover_and_crate

from drake_twin import Recording, Twin
from drake_twin.errors import InputError
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.replay import replay

COMMANDS = "/rover/forward_velocity_controller/commands"


@pytest.fixture
def twin(tmp_path):
    twin = rover_and_crate(tmp_path).robot("arm", ARM, xyz=(0, -2, 0)).build()
    twin.publish(COMMANDS, [2, 3, 2, 3])
    twin.advance_to(0.4)
    return twin


def resting_on(twin, height):
    """The z of the crate after it has fallen for two seconds."""
    twin.advance_to(twin.time + 2.0)
    return twin.entities.state("crate").position[2] == pytest.approx(height, abs=2e-3)


def test_a_free_robot_and_a_moving_model_are_put_elsewhere_at_rest(twin):
    crate = twin.entities.state("crate")
    twin.entities.place("rover", (3, 1, 0.13), (0, 0, 1.0))
    state = twin.entities.state("rover")
    assert state.position == pytest.approx((3, 1, 0.13), abs=1e-12)
    assert state.orientation == pytest.approx((np.cos(0.5), 0, 0, np.sin(0.5)), abs=1e-12)
    assert (*state.linear, *state.angular) == pytest.approx((0,) * 6, abs=1e-12)
    assert twin.entities.state("crate") == crate
    twin.entities.place("crate", (5, 5, 0.2))
    assert twin.entities.state("crate").position == pytest.approx((5, 5, 0.2), abs=1e-12)


def test_an_arm_that_is_welded_to_the_world_is_welded_elsewhere_and_does_not_notice(twin):
    twin.entities.set_joint_positions("arm", {"joint_2": 0.3})
    twin.publish("/arm/forward_velocity_controller/commands", [0.1, 0.2, 0.0, 0.0])
    twin.advance_to(1.0)
    before, rover = twin.robot_state("arm", with_efforts=False), twin.robot_state("rover", with_efforts=False)
    plan = twin.built.plans[1]
    twin.entities.place("arm", (1, -3, 0.5), (0, 0, 0.5))
    after = twin.robot_state("arm", with_efforts=False)
    assert (after.positions, after.velocities) == (before.positions, before.velocities)
    assert after.base_pose == pytest.approx((1, -3, 0.5, np.cos(0.25), 0, 0, np.sin(0.25)))
    assert twin.robot_state("rover", with_efforts=False) == rover
    assert twin.built.plans[1].joints.start_positions == plan.joints.start_positions
    twin.advance_to(2.0)
    moved = np.subtract(twin.robot_state("arm").positions, after.positions)
    assert moved[:2] == pytest.approx((0.1, 0.2), abs=0.01)  # its command still holds
    assert twin.robot_state("rover").velocities == pytest.approx((2, 3, 2, 3), rel=0.02)


def test_a_static_model_is_put_elsewhere_and_stands_there(twin):
    before = twin.robot_state("rover", with_efforts=False)
    twin.entities.place("crate", (1, 2, 0.35))  # 5 cm above the ramp, whose upper side is at 0.1 m
    assert resting_on(twin, 0.3)
    assert before != twin.robot_state("rover", with_efforts=False)
    twin.entities.place("ramp", (3, 3, 0.05))
    assert twin.built.world_file.models[0].pose.xyz == (3, 3, 0.05)
    assert resting_on(twin, 0.2)  # fallen to the ground
    twin.entities.place("crate", (3, 3, 0.35))
    assert resting_on(twin, 0.3)


def test_models_are_deleted_and_the_others_keep_their_state(twin):
    states = {name: twin.robot_state(name, with_efforts=False) for name in twin.robots}
    twin.entities.set_state("crate", linear=(0.5, 0, 0))
    crate = twin.entities.state("crate")
    twin.entities.delete("ramp")
    assert twin.entities.state("crate") == crate
    assert {name: twin.robot_state(name, with_efforts=False) for name in twin.robots} == states
    twin.entities.delete("crate")
    with pytest.raises(InputError, match=r"Entity \[crate\] does not exist\. Valid: rover, arm"):
        twin.entities.state("crate")
    assert twin.built.world_file.models == ()
    twin.advance_to(1.0)
    assert twin.robot_state("rover").velocities == pytest.approx((2, 3, 2, 3), rel=0.02)


def test_an_edited_world_is_recorded_saved_and_reset_to_where_things_were_put(twin, tmp_path):
    twin.recorder.begin()
    twin.advance_to(0.5)
    twin.entities.place("ramp", (3, 3, 0.05), (0, 0, 0.3))
    twin.entities.place("crate", (2, 0, 0.2))
    twin.advance_to(0.7)
    twin.entities.place("arm", (0, -3, 0))
    twin.entities.delete("crate")
    twin.advance_to(0.9)
    twin.recorder.recording().save(tmp_path / "run.json")
    again = replay(Recording.load(tmp_path / "run.json"))
    assert again.state_sha256() == twin.state_sha256()
    assert scenario_to_yaml(again.scenario) == scenario_to_yaml(twin.scenario)
    text = scenario_to_yaml(twin.scenario)
    assert ScenarioFile(text, "edited.yaml").scenario == twin.scenario
    twin.reset()
    assert twin.entities.state("arm").position == (0, -3, 0)
    snapshot = twin.snapshot()
    twin.entities.delete("ramp")
    twin.restore(snapshot)
    assert twin.built.world_file.models[0].pose.rpy == (0, 0, 0.3)


def test_a_snapshot_undoes_an_edit(twin):
    before, sha256 = twin.snapshot(), twin.state_sha256()
    twin.entities.delete("crate")
    twin.entities.place("arm", (9, 9, 0))
    twin.restore(before)
    assert twin.state_sha256() == sha256
    assert twin.entities.state("crate").position == pytest.approx(CRATE_AT, abs=2e-3)
    assert twin.entities.state("arm").position == (0, -2, 0)


def test_what_cannot_be_placed_or_deleted_is_said_and_nothing_changes(twin):
    sha256 = twin.state_sha256()
    for call, what in (
        (
            lambda: twin.entities.place("nobody", (0, 0, 0)),
            r"Entity \[nobody\] does not exist\. Valid: rover, arm, ramp, crate",
        ),
        (lambda: twin.entities.place("rover::base", (0, 0, 0)), "does not exist"),
        (lambda: twin.entities.place("ramp", (0, 0)), "the position .* is not 3 finite numbers"),
        (
            lambda: twin.entities.place("arm", (0, 0, 0), (0, float("nan"), 0)),
            "the roll, pitch and yaw .* finite numbers",
        ),
        (lambda: twin.entities.delete("nobody"), r"Entity \[nobody\] does not exist\."),
    ):
        with pytest.raises(InputError, match=what):
            call()
    assert twin.state_sha256() == sha256
    twin.subscribe("/clock", lambda _: twin.entities.place("arm", (0, 0, 0)))
    with pytest.raises(InputError, match="a callback cannot rearrange the twin that calls it"):
        twin.advance_to(twin.time + 0.01)
    assert twin.entities.state("arm").position == (0, -2, 0)


def test_placed_models_of_a_scenario_stand_where_it_says(tmp_path):
    builder = rover_and_crate(tmp_path)
    text = scenario_to_yaml(builder.scenario())
    text = text.replace("world:\n", "world:\n  model_poses: {crate: [4, 4, 0.2, 0, 0, 0.1]}\n")
    twin = Twin(ScenarioFile(text, "placed.yaml").scenario)
    assert twin.entities.state("crate").position == pytest.approx((4, 4, 0.2))


def test_a_model_like_one_of_the_world_falls_as_it_does_and_replays(tmp_path):
    twin = rover_and_crate(tmp_path).build()
    twin.recorder.begin()
    twin.entities.copy_model("crate", "second", (4, 4, 1.0), (0, 0, 0.3))
    twin.entities.copy_model("second", "third", (6, 4, 1.0))
    twin.entities.place("crate", (8, 4, 1.0))
    twin.advance_to(1.5)
    heights = [twin.entities.state(name).position[2] for name in ("crate", "second", "third")]
    assert heights == pytest.approx([heights[0]] * 3, abs=1e-6)
    assert heights[0] < 0.9
    twin.entities.copy_model("ramp", "ramp_2", (0, 8, 0.05))
    twin.entities.delete("second")
    assert [model.name for model in twin.built.world_file.models] == ["ramp_2", "ramp", "third", "crate"]
    twin.entities.delete("crate")  # what is like it stays
    twin.advance_to(1.6)
    assert [model.name for model in twin.built.world_file.models] == ["ramp_2", "ramp", "third"]
    again = replay(twin.recorder.recording())
    assert again.state_sha256() == twin.state_sha256()
    saved = Twin(ScenarioFile(scenario_to_yaml(twin.scenario), "saved.yaml").scenario)
    assert saved.entities.state("third").position == pytest.approx((6, 4, 1.0))


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("nobody", "a", (0, 0, 0)), r"Entity \[nobody\] does not exist"),
        (("crate", "ramp", (0, 0, 0)), r"Entity \[ramp\] already exists"),
        (("crate", "rover", (0, 0, 0)), r"Entity \[rover\] already exists"),
        (("crate", "", (0, 0, 0)), "cannot name a model"),
        (("crate", "a", (0, 0)), "is not 3 finite numbers"),
    ],
)
def test_what_cannot_be_copied_is_said(twin, arguments, what):
    with pytest.raises(InputError, match=what):
        twin.entities.copy_model(*arguments)


def test_a_copy_of_a_model_that_the_file_lacks_is_refused(tmp_path):
    text = scenario_to_yaml(rover_and_crate(tmp_path).scenario())
    for copies, what in (("{a: nobody}", "'nobody' does not exist"), ("{ramp: crate}", "ramp is taken")):
        changed = text.replace("world:\n", f"world:\n  model_copies: {copies}\n")
        with pytest.raises(InputError, match=what):
            Twin(ScenarioFile(changed, "copied.yaml").scenario)


def test_values_of_the_plant_are_set_at_once_and_taken_back_at_the_start(twin):
    instance = twin.built.robots["rover"].instance
    body = twin.plant.GetBodyByName("rover_base_link", instance)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    masses = [body.get_mass(context)]
    twin.entities.set_values({"rover.payload": 2.5})
    masses.append(body.get_mass(context))
    twin.reset()
    masses.append(body.get_mass(context))
    assert masses == pytest.approx([masses[0], masses[0] + 2.5, masses[0]])


def test_a_force_that_throws_a_model_through_a_wall_in_one_step_is_said(twin, caplog):
    """That is more than half of the crate, which has 2 kg and 0.4 m: f / m · h² > 0.2 m."""
    step = twin.scenario.time_step
    twin.entities.apply_wrench("crate", force=(0.199 * 2 / step**2, 0, 0), duration=step)
    assert not caplog.records
    twin.entities.apply_wrench("crate", force=(0.201 * 2 / step**2, 0, 0), duration=step)
    (record,) = caplog.records
    assert record.getMessage().startswith("crate: ")
    assert f"N move 2 kg by 201 mm in a step of {1e3 * step:g} ms" in record.getMessage()
