from dataclasses import replace

import numpy as np
import pytest

from drake_twin import Twin
from drake_twin.builder.demo import DEMOS, demo_scenario
from drake_twin.twin.controller_manager import STRICT

FORWARD = "forward_velocity_controller"


@pytest.mark.parametrize("robot", DEMOS)
def test_the_demo_moves_every_robot(robot):
    twin = Twin(demo_scenario(robot, 3))
    twin.advance_to(1.0)
    for name in twin.robots:
        assert np.abs(twin.robot_state(name).velocities).max() > 0.1


@pytest.mark.parametrize("robot", DEMOS)
def test_without_its_drive_every_robot_stays(robot):
    twin = Twin(demo_scenario(robot, 2, drive=False))
    before = [twin.robot_state(name).positions for name in twin.robots]
    twin.advance_to(1.0)
    after = [twin.robot_state(name).positions for name in twin.robots]
    assert np.abs(np.array(after) - before).max() < 1e-3


def test_the_demos_rovers_drive_circles_that_never_meet():
    twin = Twin(demo_scenario("rover", 2, time_step=0.01))
    closest, tracks = np.inf, {name: [] for name in twin.robots}
    for second in range(1, 61):
        twin.advance_to(float(second))
        places = [np.array(twin.robot_state(name).base_pose[:2]) for name in twin.robots]
        closest = min(closest, float(np.linalg.norm(places[1] - places[0])))
        for name, place in zip(twin.robots, places, strict=True):
            tracks[name].append(place)
    assert closest > 2.0
    for track in tracks.values():
        assert np.ptp(track, axis=0).max() < 2.5  # they stay where they are
        assert np.ptp(track, axis=0).min() > 1.0  # and get about


def commands_of(scenario):
    """The commands of each topic, as arrays of their times (s) and their velocities (rad/s)."""
    topics = dict.fromkeys(command.topic for command in scenario.commands)
    for topic in topics:
        own = [item for item in scenario.commands if item.topic == topic]
        yield np.array([item.time for item in own]), np.array([item.data for item in own]), own[0].period


def test_the_demos_rovers_turn_left_on_one_circle_at_each_of_their_speeds():
    for _, velocities, _ in commands_of(demo_scenario("rover", 2)):
        left, right = velocities[:, 0], velocities[:, 1]
        assert velocities[:, 2:] == pytest.approx(velocities[:, :2])  # front and rear
        assert (right > left).all()
        assert (left + right) / (right - left) == pytest.approx([11 / 5] * 2)  # the radius, in halves of the track


def test_the_demos_arms_return_and_neighbors_turn_in_opposite_directions():
    scenario = demo_scenario("arduinobot", 3)
    assert [robot.xyz[2] for robot in scenario.robots] == [0.0] * 3  # each is bolted to the ground
    firsts = []
    for times, velocities, period in commands_of(scenario):
        assert np.diff([*times, period]) @ velocities == pytest.approx([0.0] * 4, abs=1e-12)
        firsts.append(velocities[0, 0])
    assert np.diff(np.sign(firsts)).tolist() in ([2, -2], [-2, 2])


@pytest.mark.parametrize("robot", DEMOS)
def test_the_inactive_controllers_change_nothing_of_the_motion(robot):
    scenario = demo_scenario(robot, 2)
    plain = replace(
        scenario, robots=tuple(replace(item, controllers=(), inactive_controllers=()) for item in scenario.robots)
    )
    twins = [Twin(scenario), Twin(plain)]
    for twin in twins:
        twin.advance_to(2.5)
        assert twin.findings == ()
    for name in twins[0].robots:
        own, other = (twin.robot_state(name) for twin in twins)
        assert (own.positions, own.velocities, own.base_pose) == (other.positions, other.velocities, other.base_pose)
    assert [transform.header.frame_id for transform in twins[0].latest("/tf").transforms] == [
        transform.header.frame_id for transform in twins[1].latest("/tf").transforms
    ]


def test_the_demos_rover_drives_by_cmd_vel_once_its_drive_is_switched_on():
    twin = Twin(demo_scenario("rover", 2, drive=False))
    manager = twin.control.manager("robot_1")
    assert manager.states == {
        "joint_state_broadcaster": "active",
        FORWARD: "active",
        "drive_controller": "inactive",
    }
    assert not manager.switch_controller(["drive_controller"], [], STRICT)  # both claim the wheels
    assert manager.switch_controller(["drive_controller"], [FORWARD], STRICT)

    def drive(forward, turn):
        for _ in range(20):
            twist = {"linear": {"x": forward}, "angular": {"z": turn}}
            twin.publish("/robot_1/drive_controller/cmd_vel", {"twist": twist})
            twin.advance_to(twin.time + 0.1)
        return twin.entities.state("robot_1")

    assert drive(0.5, 0.0).position[0] == pytest.approx(1.0, abs=0.02)
    assert drive(0.0, 1.0).angular[2] == pytest.approx(1.0, abs=0.02)  # though the wheels skid
    assert twin.entities.state("robot_2").position[0] == pytest.approx(0.0, abs=1e-3)


def test_the_demos_arm_follows_trajectories_and_grips_once_these_are_switched_on():
    twin = Twin(demo_scenario("arduinobot", 1, drive=False))
    manager = twin.control.manager("robot_1")
    own = ["joint_trajectory_controller", "gripper_controller"]
    assert manager.states == {"joint_state_broadcaster": "active", FORWARD: "active", **dict.fromkeys(own, "inactive")}
    assert manager.switch_controller(own, [FORWARD], STRICT)
    twin.publish(
        "/robot_1/joint_trajectory_controller/joint_trajectory",
        {
            "joint_names": ["joint_1", "joint_2", "joint_3"],
            "points": [{"positions": [0.5, 0.4, -0.6], "time_from_start": 1.0}],
        },
    )
    goal = twin.graph.send_goal(
        "/robot_1/gripper_controller/gripper_cmd", {"command": {"position": 0.5, "max_effort": 5.0}}
    )
    twin.advance_to(1.5)
    assert goal.status == "succeeded"
    assert twin.robot_state("robot_1").positions[:4] == pytest.approx((0.5, 0.4, -0.6, 0.5), abs=0.01)
