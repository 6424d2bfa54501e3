"""CENIC as the engine: the same robots, the same commands, steps that the engine chooses."""

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import Robot, World
from drake_twin.twin.snapshot import Snapshot

WHEELS = "/robot_1/forward_velocity_controller/commands"


def cenic(count=1, **options):
    return rovers(count, engine="cenic", time_step=0.01, **options)


def test_a_commanded_velocity_has_its_sign_and_its_size():
    """Drake's CENIC turns velocity targets round (trap of Drake 1.51); ours come as positions."""
    twin = cenic().build()
    twin.publish(WHEELS, [0.3, 2.0, 0.3, 2.0])
    twin.advance_to(1.0)
    assert twin.robot_state("robot_1").velocities == pytest.approx(
        [0.3, 2.0, 0.3, 2.0], rel=0.01
    )  # they slip in a turn
    twin.publish(WHEELS, [-1.0] * 4)
    twin.advance_to(2.0)
    assert twin.robot_state("robot_1").velocities == pytest.approx([-1.0] * 4, rel=1e-3)


def test_a_rover_drives_where_the_discrete_engine_drives_it():
    ends = []
    for twin in (cenic().build(), rovers(1).build()):
        twin.publish(WHEELS, [2.0, 3.0, 2.0, 3.0])
        twin.advance_to(3.0)
        ends.append(twin.robot_state("robot_1").base_pose[:3])
    assert ends[0] == pytest.approx(ends[1], abs=0.02)


def test_positions_velocities_and_holds_of_an_arm(tmp_path):
    controllers = tmp_path / "controllers.yaml"
    controllers.write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "arm: {ros__parameters: {joints: [joint_1, joint_2], command_interfaces: [position],"
        " state_interfaces: [position, velocity]}}\n"
    )
    twin = TwinBuilder(engine="cenic", time_step=0.01).robot("arm", ARM, controllers=controllers).build()
    done = []
    point = {"positions": [1.0, 0.5], "velocities": [0, 0], "time_from_start": 2.0}
    goal = {"trajectory": {"joint_names": ["joint_1", "joint_2"], "points": [point]}}
    twin.graph.send_goal("/arm/arm/follow_joint_trajectory", goal, done.append)
    errors = []

    def look(message):
        s = min(twin.time / 2.0, 1.0)
        wanted = np.array([1.0, 0.5]) * (3 * s**2 - 2 * s**3)
        errors.append(np.abs(np.array(twin.robot_state("arm").positions[:2]) - wanted).max())

    twin.subscribe("/clock", look, 50)
    twin.advance_to(4.0)
    assert [goal.status for goal in done] == ["succeeded"]
    assert max(errors) < 0.01
    assert twin.robot_state("arm").positions[2] == pytest.approx(0.0, abs=1e-3)


def test_efforts_and_limits_are_the_joints(tmp_path):
    robot = tmp_path / "robot.urdf"
    robot.write_text("""<robot name="r"><link name="world"/><link name="bar"><inertial><mass value="1"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="turn" type="revolute"><parent link="world"/><child link="bar"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" velocity="50" effort="0.2"/></joint>
      <ros2_control name="s" type="system"><joint name="turn"><command_interface name="effort"/></joint>
      </ros2_control></robot>""")
    twin = TwinBuilder(engine="cenic", time_step=0.01, world=World(ground=False)).robot("r", robot).build()
    twin.publish("/r/forward_effort_controller/commands", [5.0])
    twin.advance_to(0.5)
    assert twin.robot_state("r").velocities[0] == pytest.approx(0.2 / 0.1 * 0.5, rel=1e-3)
    twin.advance_to(4.0)
    assert twin.robot_state("r").positions[0] == pytest.approx(1.0, abs=0.02)


def test_a_run_repeats_whoever_listens_and_whatever_the_calls():
    hashes = []
    for rate, slices in ((None, 1), (33.0, 1), (None, 7)):
        twin = cenic(2).build()
        twin.publish(WHEELS, [2.0, 3.0, 2.0, 3.0])
        if rate:
            twin.subscribe("/robot_1/joint_states", lambda message: None, rate)
        for part in range(slices):
            twin.advance_to(1.4 * (part + 1) / slices)
        hashes.append(twin.state_sha256())
    assert len(set(hashes)) == 1


def test_robots_come_and_go_and_snapshots_hold_to_the_accuracy(tmp_path):
    twin = cenic().build()
    twin.publish(WHEELS, [2.0] * 4)
    twin.advance_to(0.5)
    twin.snapshot().save(tmp_path / "state.json")
    twin.entities.spawn(Robot("new", ROVER, xyz=(-3, 0, 0.13)))
    twin.advance_to(1.5)
    end = twin.robot_state("robot_1")
    twin.restore(Snapshot.load(tmp_path / "state.json"))
    assert twin.robots == ("robot_1",)
    twin.advance_to(1.5)
    assert twin.robot_state("robot_1").base_pose == pytest.approx(end.base_pose, abs=2e-3)


@pytest.mark.parametrize(("option", "value"), [("engine", "magic"), ("accuracy", 0.0), ("accuracy", 5.0)])
def test_what_is_no_engine_is_refused(option, value):
    with pytest.raises(InputError, match=option):
        rovers(1, **{option: value}).build()


# A step of 1e-16 s, where two times differ by rounding, throws joints that mimic others: 6 · 0.1 s lies so far behind
# 0.5 s and CENIC's longest step, and some multiples of 25 ms behind those of 5 ms.


def arm_at(twin, time):
    fastest = 0.0
    for step in range(round(twin.time / twin.clock.time_step), round(time / twin.clock.time_step)):
        twin.advance_to((step + 1) * twin.clock.time_step)
        fastest = max(fastest, *map(abs, twin.robot_state("arm").velocities))
    return fastest


def test_the_longest_grid_leaves_no_step_of_rounding():
    twin = TwinBuilder(engine="cenic", time_step=0.1).robot("arm", ARM).build()
    topic = "/arm/forward_velocity_controller/commands"
    for tick in range(13):
        twin.publish(topic, [0.4, 0.3, -0.3, 0.1 if tick % 2 else -0.1])
        assert arm_at(twin, 0.1 * (tick + 1)) < 0.5
    assert twin.robot_state("arm").positions[:3] == pytest.approx([0.52, 0.39, -0.39], abs=0.01)


def test_updates_beside_the_grid_by_rounding_leave_no_step_of_rounding(tmp_path):
    joints = [f"joint_{index}" for index in range(1, 5)]
    gains = ", ".join(f"{joint}: {{p: 5.0, ff_velocity_scale: 1.0}}" for joint in joints)
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {update_rate: 40,"
        " c: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        f"c: {{ros__parameters: {{joints: [{', '.join(joints)}], command_interfaces: [velocity],"
        f" state_interfaces: [position, velocity], gains: {{{gains}}}}}}}\n"
    )
    builder = TwinBuilder(engine="cenic", time_step=0.005, accuracy=1e-2)
    twin = builder.robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    there = [0.5, 0.4, -0.4, 0.5]
    points = [{"positions": there, "velocities": [0.0] * 4, "time_from_start": 2.0}]
    twin.publish("/arm/c/joint_trajectory", {"joint_names": joints, "points": points})
    assert arm_at(twin, 4.0) < 0.5
    assert twin.robot_state("arm").positions[:4] == pytest.approx(there, abs=1e-3)


def test_a_finger_follows_the_one_that_it_mimics():
    fingers = []
    for engine, step in (("discrete", 0.001), ("cenic", 0.01)):
        twin = TwinBuilder(engine=engine, time_step=step).robot("arm", ARM).build()
        twin.publish("/arm/forward_velocity_controller/commands", [0.5, 0.2, 0.2, 0.3])
        twin.advance_to(1.0)
        left, right = twin.robot_state("arm").positions[3:]
        assert right == pytest.approx(-left, abs=1e-3)
        fingers.append(left)
    assert fingers[0] == pytest.approx(0.3, abs=5e-3)
    assert fingers[1] == pytest.approx(fingers[0], abs=1e-3)


def test_a_rover_that_meets_another_stops_where_the_discrete_engine_stops_it():
    ends = []
    for engine, step in (("discrete", 0.001), ("cenic", 0.01)):
        builder = TwinBuilder(engine=engine, time_step=step).robot("robot_1", ROVER, xyz=(0, 0, 0.13))
        twin = builder.robot("robot_2", ROVER, xyz=(1.2, 0, 0.13)).build()
        for topic in (WHEELS, WHEELS.replace("_1", "_2")):
            twin.publish(topic, [0.0] * 4)
        twin.publish(WHEELS, [3.0] * 4)
        twin.advance_to(2.4)  # later all wheels slip, with forces that cancel: how far both drift is up to the step
        first, second = (twin.robot_state(name).base_pose[0] for name in twin.robots)
        assert second - first == pytest.approx(0.57, abs=0.03)  # body to body, and a little aslant
        ends.append((first, second))
    assert ends[0] == pytest.approx(ends[1], abs=0.01)


def test_chained_updates_beside_the_grid_leave_no_step_of_rounding(tmp_path):
    """A chained controller's updates come a step after those above it: at times such as 1.001 s, which are rounded."""
    joints = [f"joint_{index}" for index in range(1, 5)]
    gains = "p: 2.0, feedforward_gain: 1.0"
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {update_rate: 100, pid: {type: pid_controller/PidController},"
        " c: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        f"pid: {{ros__parameters: {{dof_names: [{', '.join(joints)}], command_interface: velocity,"
        " reference_and_state_interfaces: [position],"
        f" gains: {{{', '.join(f'{joint}: {{{gains}}}' for joint in joints)}}}}}}}\n"
        f"c: {{ros__parameters: {{joints: [{', '.join(joints)}], command_joints:"
        f" [{', '.join(f'pid/{joint}' for joint in joints)}], command_interfaces: [position],"
        " state_interfaces: [position, velocity]}}\n"
    )
    builder = TwinBuilder(engine="cenic", time_step=0.001, accuracy=1e-2)
    twin = builder.robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    assert twin.control.manager("arm").active == ("pid", "c")
    there = [0.5, 0.4, -0.4, 0.5]
    points = [{"positions": there, "velocities": [0.0] * 4, "time_from_start": 1.0}]
    twin.publish("/arm/c/joint_trajectory", {"joint_names": joints, "points": points})
    assert arm_at(twin, 2.5) < 1.5
    twin.restore(twin.snapshot())
    assert arm_at(twin, 3.0) < 1.5
