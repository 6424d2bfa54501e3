"""A recorded run, done again: the same state to the last bit."""

import json
import subprocess
import sys
from collections import deque
from fractions import Fraction
from types import MappingProxyType

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers

from drake_twin import messages
from drake_twin.errors import CommandError, InputError
from drake_twin.scenario import Robot
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay


def wheels(robot):
    return f"/{robot}/forward_velocity_controller/commands"


def a_lively_run(seconds, commands, spawns, pauses, seed=1):
    """A run with commands, spawns, deletes, pauses, switches and steps of another length at random times."""
    rng = np.random.default_rng(seed)
    twin = rovers(2, time_step=0.005).command(wheels("robot_1"), [1, 2, 1, 2], time=0.3, period=1.0).build()
    twin.recorder.begin()
    kinds = ["command"] * commands + ["spawn"] * spawns + ["pause"] * pauses + ["switch", "step", "stop", "delete"]
    rng.shuffle(kinds)
    count = 0
    for kind in kinds:
        twin.advance_to(twin.time + float(rng.exponential(seconds / len(kinds))))
        robot = str(rng.choice(twin.robots))
        if kind == "command":
            twin.publish(wheels(robot), rng.uniform(-4, 4, 4))
        elif kind == "spawn":
            count += 1
            twin.entities.spawn(Robot(f"new_{count}", ROVER, xyz=(-3.0 * count, 0.0, 0.13)))
        elif kind == "delete" and count:
            twin.entities.delete(f"new_{count}")
        elif kind == "pause":
            twin.pause()
            twin.step(3)
            twin.play()
        elif kind == "switch":
            manager = twin.control.manager("robot_1")
            manager.switch_controller(deactivate=["forward_velocity_controller"])
            manager.switch_controller(activate=["forward_velocity_controller"])
        elif kind == "step":
            twin.clock.set_time_step(0.01)
        elif kind == "stop":
            twin.control.emergency_stop("robot_2")
            twin.advance_to(twin.time + 0.1)
            twin.control.clear_emergency_stop("robot_2")
    return twin


def test_a_replay_ends_in_the_same_state():
    twin = a_lively_run(3.0, commands=40, spawns=2, pauses=2)
    again = replay(twin.recorder.recording())
    assert again.state_sha256() == twin.state_sha256()
    assert again.robots == twin.robots


def test_a_minute_with_five_hundred_commands_five_spawns_and_two_pauses_in_another_process(tmp_path):
    twin = a_lively_run(60.0, commands=500, spawns=5, pauses=2)
    twin.recorder.recording().save(tmp_path / "run.json")
    program = (
        "import sys; from drake_twin import Recording, replay;print(replay(Recording.load(sys.argv[1])).state_sha256())"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "run.json")]
    other = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    assert other == twin.state_sha256()


def test_what_callbacks_do_is_in_it_and_what_the_scenario_does_itself_is_there_once():
    twin = rovers(1).command(wheels("robot_1"), [1] * 4, time=0.1, period=0.2).build()
    twin.recorder.begin()
    twin.subscribe("/clock", lambda message: twin.publish(wheels("robot_1"), [twin.time] * 4), 7.0)
    twin.advance_to(1.0)
    recording = twin.recorder.recording()
    assert [call.name for call in recording.calls] == ["publish"] * 7
    assert replay(recording).state_sha256() == twin.state_sha256()


def test_refused_calls_messages_goals_and_joint_positions_are_done_again(tmp_path):
    controllers = tmp_path / "controllers.yaml"
    controllers.write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "arm: {ros__parameters: {joints: [joint_1], command_interfaces: [position], state_interfaces: [position]}}\n"
    )
    twin = rovers(1).robot("robot_2", ARM, xyz=(0, 3, 0), controllers=controllers).build()
    twin.recorder.begin()
    twin.publish(wheels("robot_1"), messages.float64_multi_array([2, 2, 2, 2]))
    twin.entities.set_joint_positions("robot_2", {"joint_2": 0.3})
    goal = {"trajectory": {"joint_names": ["joint_1"], "points": [{"positions": [1.0], "time_from_start": 1.0}]}}
    sent = twin.graph.send_goal("/robot_2/arm/follow_joint_trajectory", goal)
    twin.advance_to(0.5)
    sent.cancel()
    with pytest.raises(CommandError):
        twin.publish(wheels("robot_1"), [1, 2])  # which deactivates the controller
    twin.advance_to(1.0)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_what_is_given_by_name_is_done_again_by_name():
    twin = rovers(2).build()
    twin.recorder.begin()
    twin.entities.spawn(robot=Robot("new", ROVER, xyz=(-3, 0, 0.13)))
    twin.entities.apply_wrench("new", force=(20, 0, 0), duration=0.5)
    twin.advance_to(0.7)
    twin.entities.set_state("robot_2", linear=(0.5, 0, 0))
    twin.control.manager("robot_1").switch_controller(deactivate=["joint_state_broadcaster"], strictness=2)
    twin.advance_to(1.0)
    again = replay(twin.recorder.recording())
    assert again.state_sha256() == twin.state_sha256()
    assert again.robot_state("new").base_pose[0] != -3.0


def test_a_recording_may_begin_in_the_middle_and_hold_a_reset():
    twin = rovers(1).build()
    twin.publish(wheels("robot_1"), [2, 3, 2, 3])
    twin.advance_to(0.4)
    twin.recorder.begin()
    twin.advance_to(0.7)
    twin.reset()
    twin.publish(wheels("robot_1"), [5, 5, 5, 5])
    twin.advance_to(0.2)
    again = replay(twin.recorder.recording())
    assert (again.time, again.state_sha256()) == (0.2, twin.state_sha256())


def test_a_recording_is_a_file_and_what_is_none_is_refused(tmp_path):
    twin = rovers(1).build()
    with pytest.raises(InputError, match="nothing has been recorded"):
        twin.recorder.recording()
    twin.recorder.begin()
    twin.publish(wheels("robot_1"), [2, 3, 2, 3])
    twin.advance_to(0.1)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert Recording.load(tmp_path / "run.json") == twin.recorder.recording()
    for text in ("", "{}", '{"format": "drake_twin recording", "version": 9}'):
        (tmp_path / "run.json").write_text(text)
        with pytest.raises(InputError):
            Recording.load(tmp_path / "run.json")


def test_what_a_callback_may_not_do_is_not_done_again():
    twin = rovers(1).build()
    twin.recorder.begin()
    refused = []

    def meddle(message):
        for call in (lambda: twin.entities.spawn(Robot("new", ROVER, xyz=(3, 3, 0.13))), twin.reset):
            with pytest.raises(InputError, match="a callback cannot"):
                call()
            refused.append(call)

    twin.subscribe("/clock", meddle, 10)
    twin.advance_to(0.5)
    again = replay(twin.recorder.recording())
    assert refused
    assert (again.robots, again.state_sha256()) == (twin.robots, twin.state_sha256())


def test_going_back_to_a_snapshot_is_in_it(tmp_path):
    twin = rovers(1).build()
    twin.publish(wheels("robot_1"), [2, 3, 2, 3])
    twin.advance_to(0.2)
    snapshot = twin.snapshot()
    twin.recorder.begin()
    twin.publish(wheels("robot_1"), [4] * 4)
    twin.advance_to(0.5)
    twin.restore(snapshot)
    twin.advance_to(0.6)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == twin.state_sha256()


@pytest.mark.parametrize(
    "data",
    [
        (float(number) for number in range(4)),
        range(4),
        [Fraction(3, 2)] * 4,
        deque([1, 2, 3, 4]),
        MappingProxyType({"data": (1, 2, 3, 4)}),
    ],
)
def test_messages_made_of_anything_that_holds_numbers_are_done_again(data):
    twin = rovers(1).build()
    twin.recorder.begin()
    twin.publish(wheels("robot_1"), data)
    twin.advance_to(0.2)
    assert any(velocity > 0.5 for velocity in twin.robot_state("robot_1").velocities)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


@pytest.mark.parametrize("data", [print, None, {1, 2}, object()])
def test_messages_that_are_none_are_refused_again(data):
    twin = rovers(1).build()
    twin.recorder.begin()
    with pytest.raises(CommandError):
        twin.publish(wheels("robot_1"), data)
    twin.advance_to(0.1)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_a_run_whose_files_are_gone_is_not_replayed_without_them(tmp_path):
    (tmp_path / "box.urdf").write_text('<robot name="box"><link name="box"/></robot>')
    twin = rovers(1).build()
    twin.recorder.begin()
    twin.entities.spawn(Robot("box", str(tmp_path / "box.urdf")))
    twin.advance_to(0.1)
    (tmp_path / "box.urdf").unlink()
    with pytest.raises(InputError, match=r"spawn at 0 s of the recording cannot be repeated: .*does not exist"):
        replay(twin.recorder.recording())


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        ("name", "scenario"),
        ("name", "__init__"),
        ("name", 5),
        ("time", "x"),
        ("time", float("nan")),
        ("arguments", 5),
        ("arguments", {"!": "tuple", "items": [1, 2, 3, 4, 5, 6, 7]}),
        ("named", {"!": "mapping", "items": [["q", 1]]}),
        ("named", [5]),
        ("named", {"!": "array", "type": "<i8", "shape": [1], "data": [10**30]}),
    ],
)
def test_a_call_that_is_none_is_refused_in_words(tmp_path, entry, value):
    twin = rovers(1).build()
    twin.recorder.begin()
    twin.publish(wheels("robot_1"), [2, 3, 2, 3])
    file = tmp_path / "run.json"
    twin.recorder.recording().save(file)
    data = json.loads(file.read_text())
    data["recording"]["calls"]["items"][0][entry] = value
    file.write_text(json.dumps(data))
    with pytest.raises(InputError):
        replay(Recording.load(file))


@pytest.mark.parametrize("entry", ["start", "calls", "end"])
@pytest.mark.parametrize("value", [None, "x", [5], -5, 1e300])
def test_a_recording_of_other_things_is_refused_in_words(tmp_path, entry, value):
    twin = rovers(1).build()
    twin.recorder.begin()
    file = tmp_path / "run.json"
    twin.recorder.recording().save(file)
    data = json.loads(file.read_text())
    data["recording"][entry] = value
    file.write_text(json.dumps(data))
    with pytest.raises(InputError):
        Recording.load(file)


@pytest.mark.parametrize("first", [0.392, 0.3925])
def test_times_between_two_steps_of_the_old_length_are_met_by_the_new_one(first):
    twin = rovers(1).build()
    twin.recorder.begin()
    twin.advance_to(0.252)
    twin.clock.set_time_step(0.0025)
    twin.advance_to(first)
    assert twin.time == pytest.approx(0.3925)
    twin.publish(wheels("robot_1"), [2, 3, 2, 3])
    twin.advance_to(0.5)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_a_step_that_a_callback_sets_where_the_advance_ends_holds_from_there(tmp_path):
    controllers = tmp_path / "controllers.yaml"
    controllers.write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "arm: {ros__parameters: {joints: [joint_1], command_interfaces: [position], state_interfaces: [position]}}\n"
    )
    twin = rovers(1).robot("robot_2", ARM, xyz=(0, 3, 0), controllers=controllers).build()
    twin.recorder.begin()
    goal = {"trajectory": {"joint_names": ["joint_1"], "points": [{"positions": [0.1], "time_from_start": 0.1}]}}
    sent = twin.graph.send_goal(
        "/robot_2/arm/follow_joint_trajectory", goal, lambda _: twin.clock.set_time_step(0.0005)
    )
    while not sent.is_done:
        twin.step()
    assert [call.name for call in twin.recorder.recording().calls] == ["send_goal", "set_time_step"]
    assert twin.clock.time_step == 0.0005
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_a_recording_has_a_snapshot_calls_and_an_end():
    with rovers(1).build() as twin:
        start = twin.snapshot()
    assert Recording(start, (), 1.0).end == 1.0
    for parts in (("start", (), 1.0), (start, ("call",), 1.0), (start, [], 1.0), (start, (), float("nan"))):
        with pytest.raises(InputError, match="a recording has a snapshot, calls and the time of the end"):
            Recording(*parts)
