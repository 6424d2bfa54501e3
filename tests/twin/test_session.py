"""What stays and what ends when a twin is reset, restored or built again."""

from dataclasses import replace

import pytest
from two_hinges import efforts, hinges, trajectories, velocities, write_hinges

from drake_twin import InputError, Twin
from drake_twin.scenario import Command, Robot

WHEELS = "/r/wheels/commands"
CONTROLLERS = {"wheels": velocities("left", "right")}


def newcomer(folder, controllers, name="new"):
    """A robot with controllers of its own."""
    (folder / name).mkdir()
    robot, file = write_hinges(folder / name, controllers)
    return Robot(name, str(robot), xyz=(0.0, -5.0, 0.0), controllers=(str(file),))


def goal(twin, topic, position):
    points = [{"positions": [position], "time_from_start": 1.0}]
    return twin.graph.send_goal(topic, {"trajectory": {"joint_names": ["left"], "points": points}})


def test_a_reset_ends_a_silence(tmp_path):
    twin = hinges(tmp_path, CONTROLLERS).command(WHEELS, [1.0, 0.0], time=0.1).build()
    for silenced, expected in ((True, None), (False, [1.0, 0.0])):
        if silenced:
            twin.graph.silence(WHEELS)
        twin.advance_to(0.2)
        command = twin.graph.command(WHEELS)
        assert (command and list(command.data)) == expected
        twin.reset()


def test_a_saved_twin_whose_robot_has_other_controllers_gets_these(tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
    twin = hinges(tmp_path / "one", CONTROLLERS).build()
    other = hinges(tmp_path / "other", {"torques": efforts("left")}).build()
    other.publish("/r/torques/commands", [2.0])
    other.advance_to(0.1)
    twin.advance_to(0.3)
    twin.restore(other.snapshot())
    assert twin.control.manager("r").active == ("torques",)
    for each in (twin, other):
        each.advance_to(0.5)
    assert twin.state_sha256() == other.state_sha256()


def test_pushes_and_time_go_on_when_a_robot_comes_or_the_step_changes(tmp_path):
    twin = hinges(tmp_path, {"torques": efforts("left", "right")}).build()
    twin.entities.apply_wrench("r::left_link", torque=(0.0, 0.0, 2.0), duration=0.4)
    twin.advance_to(0.1)
    twin.entities.spawn(newcomer(tmp_path, CONTROLLERS))
    twin.clock.set_time_step(0.002)
    assert twin.time == pytest.approx(0.1)
    twin.advance_to(1.0)
    assert twin.clock.step_count == 500
    assert twin.robot_state("r").velocities[0] == pytest.approx(2.0 / 0.5 * 0.4, rel=1e-6)
    assert twin.context.get_time() == pytest.approx(1.0)


def test_a_robot_that_comes_has_its_controllers_started_and_the_others_go_on(tmp_path):
    twin = hinges(tmp_path, {"arm": trajectories("left")}).build()
    old = goal(twin, "/r/arm/follow_joint_trajectory", 0.4)
    twin.advance_to(0.5)
    twin.entities.spawn(newcomer(tmp_path, {"arm": trajectories("left")}))
    new = goal(twin, "/new/arm/follow_joint_trajectory", -0.2)
    twin.advance_to(1.7)
    assert (old.status, new.status) == ("succeeded", "succeeded")
    assert twin.robot_state("r").positions[0] == pytest.approx(0.4, abs=1e-3)
    assert twin.robot_state("new").positions[0] == pytest.approx(-0.2, abs=1e-3)


def test_a_robot_that_goes_leaves_a_manager_that_switches_nothing(tmp_path):
    twin = hinges(tmp_path, CONTROLLERS, ("r", "other")).build()
    manager = twin.control.manager("other")
    twin.entities.delete("other")
    assert manager.states == {}
    assert not manager.switch_controller(deactivate=["wheels"], strictness=2)
    assert not manager.load_controller("wheels")
    assert twin.control.manager("r").states == {"wheels": "active"}
    twin.step()


def test_a_robot_that_goes_ends_its_goals_without_a_word(tmp_path):
    twin = hinges(tmp_path, {"arm": trajectories("left")}, ("r", "other")).build()
    gone = goal(twin, "/other/arm/follow_joint_trajectory", 0.4)
    stays = goal(twin, "/r/arm/follow_joint_trajectory", 0.4)
    twin.advance_to(0.5)
    twin.entities.delete("other")
    assert gone.status == "canceled"
    twin.advance_to(1.5)
    assert stays.status == "succeeded"


def test_a_push_is_in_the_hash_and_in_what_is_saved(tmp_path):
    twin = hinges(tmp_path, CONTROLLERS).build()
    before = twin.state_sha256()
    twin.entities.apply_wrench("r::left_link", torque=(0.0, 0.0, 2.0), duration=0.4)
    assert twin.state_sha256() != before
    saved = twin.snapshot()
    twin.reset()
    assert twin.state_sha256() == before
    twin.restore(saved)
    assert twin.snapshot() == saved


def test_a_description_is_heard_again_when_another_robot_has_taken_the_name(tmp_path):
    twin = hinges(tmp_path, CONTROLLERS, ("stays", "r")).build()
    heard = []
    twin.subscribe("/r/robot_description", lambda message: heard.append(message.data), rate=None)
    twin.advance_to(0.1)
    twin.entities.delete("r")
    twin.advance_to(0.2)
    assert len(heard) == 1
    other = newcomer(tmp_path, {"torques": efforts("left")}, "r")
    file = tmp_path / "r" / "hinges.urdf"
    file.write_text(file.read_text().replace('name="hinges"', 'name="other_hinges"'))
    twin.entities.spawn(other)
    twin.advance_to(0.3)
    assert len(heard) == 2
    assert "other_hinges" in heard[1]


@pytest.mark.parametrize("optional", [False, True])
def test_an_optional_command_that_nobody_accepts_is_a_finding_and_another_one_an_error(tmp_path, optional):
    scenario = hinges(tmp_path, {"wheels": velocities("left", "right")}).scenario()
    commands = (Command("/r/arm/commands", (1.0,), optional=optional), Command("/r/wheels/commands", (1.0, 2.0)))
    scenario = replace(scenario, commands=commands)
    if not optional:
        with pytest.raises(InputError, match="/r/arm/commands"):
            Twin(scenario)
        return
    twin = Twin(scenario)
    (finding,) = twin.findings
    assert finding.what.startswith("ros2 topic pub /r/arm/commands (")
    twin.advance_to(1.0)
    assert twin.robot_state("r").velocities == pytest.approx((1.0, 2.0), rel=1e-3)
