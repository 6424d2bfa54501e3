"""Parameters of controllers that are set while the twin runs."""

import pytest
from conftest import rovers
from two_hinges import hinges, trajectories

from drake_twin.errors import CommandError, InputError
from drake_twin.messages.parameter_value import python_value
from drake_twin.twin.replay import replay

NAME = "hinges"
TOPIC, ACTION = f"/{NAME}/c/joint_trajectory", f"/{NAME}/c/follow_joint_trajectory"


def arm(folder, **more):
    return hinges(folder, {"c": trajectories("left", "right", **more)}, names=(NAME,)).build()


@pytest.fixture
def twin(tmp_path):
    with arm(tmp_path) as twin:
        yield twin


def goal(joints=("left", "right"), seconds=1.0, position=0.3):
    points = [{"positions": [position] * len(joints), "time_from_start": seconds}]
    return {"trajectory": {"joint_names": list(joints), "points": points}}


def value(twin, name):
    return twin.control.parameters(NAME, "c")[name].value


def used(twin):
    return next(item.parameters for item in twin.built.plans[0].controllers if item.name == "c")


def test_what_an_active_controller_follows_counts_at_once(twin):
    with pytest.raises(CommandError):
        twin.graph.send_goal(ACTION, goal(["left"]))
    twin.control.set_parameters(NAME, "c", {"allow_partial_joints_goal": True})
    assert value(twin, "allow_partial_joints_goal") is True
    twin.graph.send_goal(ACTION, goal(["left"]))


def test_gains_count_at_once_and_the_trajectory_goes_on(tmp_path):
    """Without a gain the joint stays; with p an error decays by 1 - p / f at each update, of which f = 100 Hz come."""
    with arm(tmp_path, command_interfaces=["velocity"]) as twin:
        twin.publish(TOPIC, goal(seconds=0.1)["trajectory"])
        twin.advance_to(1.0)
        assert twin.robot_state(NAME).positions[0] == pytest.approx(0.0, abs=1e-6)
        twin.control.set_parameters(NAME, "c", {"gains.left.p": 4.0})
        twin.advance_to(1.5)
        found = twin.robot_state(NAME).positions[:2]
    assert 0.3 - found[0] == pytest.approx(0.3 * (1.0 - 4.0 / 100.0) ** 50, rel=0.04)
    assert found[1] == pytest.approx(0.0, abs=1e-3)


def test_state_goals_and_managers_stay(twin):
    ended = []
    manager = twin.control.manager(NAME)
    twin.graph.send_goal(ACTION, goal(), ended.append)
    twin.advance_to(0.5)
    before = twin.state_sha256()
    twin.control.set_parameters(NAME, "c", {"constraints.goal_time": 2.0})
    assert twin.state_sha256() == before
    assert twin.control.manager(NAME) is manager
    twin.advance_to(1.5)
    (done,) = ended
    assert done.status == "succeeded"
    assert twin.robot_state(NAME).positions[0] == pytest.approx(0.3, abs=0.01)


def test_other_values_count_when_the_controller_is_configured_next(twin):
    twin.control.set_parameters(NAME, "c", {"cmd_timeout": 5.0})
    assert (value(twin, "cmd_timeout"), used(twin).cmd_timeout) == (5.0, 0.0)
    manager = twin.control.manager(NAME)
    manager.switch_controller(deactivate=["c"])
    assert used(twin).cmd_timeout == 0.0
    manager.configure_controller("c")
    assert (value(twin, "cmd_timeout"), used(twin).cmd_timeout) == (5.0, 5.0)
    assert manager.states["c"] == "inactive"


def test_a_callback_may_configure_a_controller_with_new_values(twin):
    twin.control.set_parameters(NAME, "c", {"cmd_timeout": 5.0})

    def configure(_):
        if twin.time > 0.2 and not used(twin).cmd_timeout:
            twin.control.manager(NAME).switch_controller(deactivate=["c"])
            twin.control.manager(NAME).configure_controller("c")

    twin.subscribe("/clock", configure)
    twin.advance_to(0.5)
    assert (used(twin).cmd_timeout, twin.control.manager(NAME).states["c"]) == (5.0, "inactive")


def test_a_controller_that_is_not_active_follows_everything(twin):
    twin.control.manager(NAME).switch_controller(deactivate=["c"])
    twin.control.set_parameters(NAME, "c", {"cmd_timeout": 5.0, "update_rate": 50})
    assert used(twin).cmd_timeout == 5.0
    assert twin.control.manager(NAME).list_controllers()[-1].update_rate == 50.0


def test_a_robot_that_moves_stays_where_it_is():
    """command_timeout is the twin's own: 0.2 s after its last command the rover brakes."""
    topic = "/robot_1/forward_velocity_controller/commands"
    with rovers(1).build() as twin:
        twin.publish(topic, [5.0] * 4)
        twin.advance_to(0.2)
        pose = twin.robot_state("robot_1").base_pose
        manager = twin.control.manager("robot_1")
        manager.switch_controller(deactivate=["forward_velocity_controller"])
        twin.control.set_parameters("robot_1", "forward_velocity_controller", {"command_timeout": 0.2})
        assert twin.robot_state("robot_1").base_pose == pose
        manager.switch_controller(activate=["forward_velocity_controller"])
        twin.publish(topic, [5.0] * 4)
        twin.advance_to(0.8)
        velocities = twin.robot_state("robot_1").velocities
    assert max(map(abs, velocities)) < 0.05


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"joints": ["left"]}, "parameter 'joints' cannot be set because it is read-only"),
        ({"p": 1.0}, "parameter 'p' cannot be set because it was not declared"),
        ({"constraints.goal_time": 1}, "Wrong parameter type"),
        ({"constraints.goal_time": -1.0}, "doesn't comply with floating point range"),
        ({"use_sim_time": False}, "use_sim_time"),
    ],
)
def test_what_cannot_be_set_changes_nothing(twin, values, reason):
    before = twin.scenario
    with pytest.raises(InputError, match=reason):
        twin.control.set_parameters(NAME, "c", {"cmd_timeout": 1.0} | values)
    assert twin.scenario == before
    assert value(twin, "cmd_timeout") == 0.0


def test_values_that_the_robot_cannot_have_are_refused_as_a_whole():
    with rovers(1).build() as twin:
        manager = twin.control.manager("robot_1")
        manager.switch_controller(deactivate=["forward_velocity_controller"])
        with pytest.raises(InputError, match="no joint 'nobody'"):
            twin.control.set_parameters("robot_1", "forward_velocity_controller", {"joints": ["nobody"]})
        twin.advance_to(0.1)
        assert len(twin.control.parameters("robot_1", "forward_velocity_controller")["joints"].value) == 4


def test_an_unknown_controller_is_named(twin):
    with pytest.raises(InputError, match=r"no controller 'd'\. Valid: c\."):
        twin.control.parameters(NAME, "d")


def test_the_change_is_told_and_so_is_a_load(twin):
    heard = []
    twin.subscribe("/parameter_events", heard.append)
    twin.control.set_parameters(NAME, "c", {"constraints.goal_time": 2.0, "cmd_timeout": 3.0})
    manager = twin.control.manager(NAME)
    manager.switch_controller(deactivate=["c"])
    manager.unload_controller("c")
    manager.load_controller("c")
    twin.advance_to(0.1)
    changed, loaded = heard
    assert (changed.node, loaded.node) == ("/hinges/c", "/hinges/c")
    found = {item.name: python_value(item.value) for item in changed.changed_parameters}
    assert found == {"constraints.goal_time": 2.0, "cmd_timeout": 3.0}
    new = {item.name: (item.value.type, python_value(item.value)) for item in loaded.new_parameters}
    assert new["joints"] == (9, ["left", "right"])
    assert new["command_joints"] == (9, [])
    assert not loaded.changed_parameters


def test_a_recording_repeats_it(twin):
    twin.recorder.begin()
    twin.publish(TOPIC, goal()["trajectory"])
    twin.advance_to(0.2)
    twin.control.set_parameters(NAME, "c", {"constraints.goal_time": 2.0})
    with pytest.raises(InputError):
        twin.control.set_parameters(NAME, "c", {"joints": ["left"]})
    twin.advance_to(0.5)
    recording = twin.recorder.recording
    again = replay(recording() if callable(recording) else recording)
    assert again.state_sha256() == twin.state_sha256()
    assert again.control.parameters(NAME, "c")["constraints.goal_time"].value == 2.0


def test_a_saved_state_keeps_them(twin):
    twin.control.set_parameters(NAME, "c", {"constraints.goal_time": 2.0})
    saved = twin.snapshot()
    twin.control.set_parameters(NAME, "c", {"constraints.goal_time": 3.0})
    twin.restore(saved)
    assert value(twin, "constraints.goal_time") == 2.0
