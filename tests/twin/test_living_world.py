"""Robots come and go, and the step changes, while all else goes on as it was."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from living import living
from pydrake.systems.framework import LeafSystem

from drake_twin.errors import InputError
from drake_twin.scenario import Robot, ScenarioError

NEW = Robot("new", ROVER, xyz=(-3.0, 0.0, 0.13))


def wheels(robot):
    return f"/{robot}/forward_velocity_controller/commands"


@pytest.fixture
def twin():
    twin = rovers(3).build()
    for index in range(1, 4):
        twin.publish(wheels(f"robot_{index}"), [2, 3, 2, 3])
    twin.advance_to(0.5)
    return twin


def states(twin, *robots):
    """All that a state consists of; efforts follow from it, and from the step to come."""
    return {robot: replace(twin.robot_state(robot), efforts=()) for robot in robots or twin.robots}


def efforts(twin, robot):
    return twin.robot_state(robot).efforts


# Spawn and delete


def test_a_spawn_changes_nobody_else_by_a_bit_and_all_drive_on(twin):
    before, before_efforts = states(twin), efforts(twin, "robot_1")
    assert max(map(abs, before_efforts)) > 0.1
    twin.entities.spawn(NEW)
    assert states(twin, *before) == before
    assert efforts(twin, "robot_1") == pytest.approx(before_efforts, abs=1e-3)  # one solve for all: to its tolerance
    twin.publish(wheels("new"), [4, 4, 4, 4])
    twin.advance_to(1.5)
    for robot in before:
        assert twin.robot_state(robot).velocities == pytest.approx((2, 3, 2, 3), rel=0.01)
    assert twin.robot_state("new").velocities == pytest.approx((4, 4, 4, 4), rel=0.01)
    assert twin.time == 1.5


def test_a_delete_changes_nobody_else_by_a_bit_and_takes_its_topics_along(twin):
    before = states(twin, "robot_1", "robot_3")
    twin.entities.delete("robot_2")
    assert twin.robots == ("robot_1", "robot_3")
    assert states(twin) == before
    assert not any(topic.startswith("/robot_2/") for topic in twin.graph.topics())
    assert not any("robot_2" in item.child_frame_id for item in twin.latest("/tf").transforms)
    twin.advance_to(1.0)
    assert twin.robot_state("robot_3").velocities == pytest.approx((2, 3, 2, 3), rel=0.01)


def test_who_listens_goes_on_listening(twin):
    seen = {"robot_1": [], "robot_2": []}
    for robot, times in seen.items():
        twin.subscribe(f"/{robot}/joint_states", lambda message, times=times: times.append(message.header.stamp), 10)
    twin.advance_to(0.75)
    twin.entities.delete("robot_2")
    twin.advance_to(1.05)
    assert [len(times) for times in seen.values()] == [6, 3]
    twin.entities.spawn(Robot("robot_2", ROVER, xyz=(0, 2, 0.13)))
    twin.advance_to(1.25)
    assert [len(times) for times in seen.values()] == [8, 5]


def test_claims_emergency_stops_and_goals_of_others_stay(twin):
    manager = twin.control.manager("robot_1")
    manager.switch_controller(deactivate=["forward_velocity_controller"])
    twin.control.emergency_stop("robot_2")
    twin.entities.spawn(NEW)
    assert twin.control.manager("robot_1") is manager
    assert manager.active == ("joint_state_broadcaster",)
    twin.advance_to(2.5)
    assert twin.robot_state("robot_1").velocities == pytest.approx([0] * 4, abs=5e-3)
    assert twin.robot_state("robot_2").velocities == pytest.approx([0] * 4, abs=5e-3)
    assert manager.switch_controller(activate=["forward_velocity_controller"])
    twin.publish(wheels("robot_1"), [1, 1, 1, 1])
    twin.advance_to(3.0)
    assert twin.robot_state("robot_1").velocities == pytest.approx([1] * 4, rel=0.01)


def test_what_cannot_be_spawned_or_deleted_is_said_as_gazebo_says_it_and_nothing_changes(twin):
    before = twin.state_sha256()
    with pytest.raises(InputError, match=r"Entity \[robot_1\] already exists\."):
        twin.entities.spawn(Robot("robot_1", ROVER))
    with pytest.raises(InputError, match=r"Entity \[robot_9\] does not exist\."):
        twin.entities.delete("robot_9")
    with pytest.raises(ScenarioError, match="the file does not exist"):
        twin.entities.spawn(Robot("new", "/nowhere/robot.urdf"))
    with pytest.raises(InputError, match="'plant' is the name of another part"):
        twin.entities.spawn(Robot("plant", ROVER))
    assert twin.state_sha256() == before
    twin.entities.delete("robot_1")
    twin.entities.delete("robot_2")
    with pytest.raises(InputError, match="last one"):
        twin.entities.delete("robot_3")


def test_nothing_spawns_inside_a_callback(twin):
    refused = []

    def spawn(message):
        with pytest.raises(InputError, match="a callback cannot spawn"):
            twin.entities.spawn(NEW)
        refused.append(True)

    twin.subscribe("/clock", spawn, 10)
    twin.advance_to(0.6)
    assert refused


def test_reset_keeps_who_is_there_and_begins_anew(twin):
    twin.entities.spawn(NEW)
    twin.advance_to(1.0)
    twin.reset()
    twin.advance_to(0.2)
    first = twin.state_sha256()
    for _ in range(100):
        twin.reset()
    twin.advance_to(0.2)
    assert twin.state_sha256() == first
    assert twin.robots[-1] == "new"


def test_two_hundred_spawns_and_deletes_leave_nothing_behind():
    rng = np.random.default_rng(3)
    twin = rovers(2).build()

    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1])

    alone, others, sizes = living(LeafSystem), 0, []
    count = 0
    for turn in range(200):
        if others < 3 and (others == 0 or rng.random() < 0.5):
            twin.entities.spawn(Robot(f"r{count}", ROVER, xyz=(-3.0 - 2 * (count % 4), 0.0, 0.13)))
            count, others = count + 1, others + 1
        else:
            twin.entities.delete(str(rng.choice(twin.robots[2:])))
            others -= 1
        twin.step(2)
        if turn >= 60:
            sizes.append(resident())
    for robot in twin.robots[2:]:
        twin.entities.delete(robot)
    assert living(LeafSystem) == alone
    assert max(sizes[-20:]) < 1.1 * max(sizes[:20])


# The physics step


def test_a_new_step_changes_no_state_and_drives_on(twin):
    before = states(twin)
    twin.clock.set_time_step(0.01)
    assert states(twin) == before
    assert (twin.time, twin.clock.time_step) == (0.5, 0.01)
    steps = twin.clock.step_count
    twin.advance_to(1.0)
    assert twin.clock.step_count - steps == 50
    assert twin.robot_state("robot_1").velocities == pytest.approx((2, 3, 2, 3), rel=0.01)


def test_a_new_step_waits_for_its_next_multiple(twin):
    twin.advance_to(0.503)
    twin.clock.set_time_step(0.01)
    assert twin.clock.time_step == 0.001
    twin.step(7)
    twin.step()
    assert (twin.clock.time_step, twin.time) == (0.01, pytest.approx(0.52))
    twin.clock.set_time_step(0.002)
    twin.advance_to(0.6)
    assert (twin.clock.time_step, twin.clock.step_count) == (0.002, 300)


def test_commands_and_subscriptions_keep_their_times_across_a_new_step():
    twin = (
        rovers(1).command(wheels("robot_1"), [2] * 4, time=0.203).command(wheels("robot_1"), [4] * 4, time=0.6).build()
    )
    times = []
    twin.subscribe("/clock", lambda message: times.append(round(twin.time, 9)), 20)
    twin.advance_to(0.1)
    twin.clock.set_time_step(0.01)
    twin.advance_to(0.5)
    assert twin.robot_state("robot_1").velocities == pytest.approx([2] * 4, rel=0.01)
    twin.advance_to(1.0)
    assert twin.robot_state("robot_1").velocities == pytest.approx([4] * 4, rel=0.01)
    assert times == pytest.approx(np.arange(20) * 0.05)


@pytest.mark.parametrize("step", [0, -0.001, float("nan"), "fast", 1e-9, 5.0])
def test_a_step_that_is_none_is_refused(twin, step):
    with pytest.raises(InputError):
        twin.clock.set_time_step(step)
    assert twin.clock.time_step == 0.001


# Under adverse use


@pytest.mark.parametrize("robot", [None, "robot_3", {}, ROVER])
def test_what_is_no_robot_is_refused(twin, robot):
    with pytest.raises(InputError, match="is not a Robot"):
        twin.entities.spawn(robot)


@pytest.mark.parametrize(
    "wrong",
    [
        {"xyz": (1, 2)},
        {"xyz": None},
        {"xyz": ("a", "b", "c")},
        {"xyz": (10**400, 0, 0)},
        {"xyz": np.zeros(3)},
        {"namespace": 5},
        {"xacro_args": None},
        {"initial_positions": None},
        {"remappings": {"/new/joint_states": 5}},
        {"active_controllers": 5},
        {"without_repairs": 5},
        {"self_collision": "no"},
        {"name": "entity_states"},
    ],
)
def test_a_robot_with_values_of_another_kind_is_refused_and_nothing_changes(twin, wrong):
    before = twin.state_sha256()
    with pytest.raises(ScenarioError):
        twin.entities.spawn(Robot(**{"name": "new", "model": ROVER, **wrong}))
    assert twin.state_sha256() == before


def test_a_refused_spawn_leaves_nothing_behind(twin):
    before = living(LeafSystem)
    for _ in range(3):
        with pytest.raises(InputError, match="would both publish the frame"):
            twin.entities.spawn(Robot("new", ROVER, xacro_args={"robot_name": "robot_1"}, frame_prefix=""))
    assert living(LeafSystem) == before
    twin.step(10)


def test_a_push_goes_on_across_a_new_step():
    twin = rovers(1).build()
    twin.advance_to(1.0)
    twin.entities.apply_wrench("robot_1", torque=(0, 0, 50), duration=0.5)
    twin.clock.set_time_step(0.01)
    twin.advance_to(1.4)
    assert abs(twin.entities.state("robot_1").angular[2]) > 0.01
    twin.advance_to(2.4)
    assert abs(twin.entities.state("robot_1").angular[2]) < 0.01


def test_the_manager_of_a_deleted_robot_switches_nothing_any_more(twin):
    manager = twin.control.manager("robot_2")
    twin.entities.delete("robot_2")
    assert not manager.load_controller("forward_velocity_controller")
    assert not manager.switch_controller(deactivate=["forward_velocity_controller"], strictness=2)
    twin.entities.spawn(Robot("robot_2", ROVER, xyz=(0, 2, 0.13)))
    assert not manager.switch_controller(deactivate=["forward_velocity_controller"], strictness=2)
    assert "forward_velocity_controller" in twin.control.manager("robot_2").active


def test_who_listens_to_what_never_changes_hears_of_the_robots_that_come(twin):
    frames, texts = [], []
    twin.subscribe("/tf_static", lambda message: frames.append(len(message.transforms)))
    twin.subscribe("/robot_2/robot_description", lambda message: texts.append(message.data))
    twin.step()
    twin.entities.delete("robot_2")
    twin.step()
    assert (len(frames), len(texts)) == (1, 1)
    twin.entities.spawn(Robot("robot_2", ARM, xyz=(-3, 0, 0)))
    twin.step()
    assert frames[-1] > frames[0]
    assert len(texts) == 2
    assert texts[1] != texts[0]
