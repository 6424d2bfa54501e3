"""Robots under controllers: they get where they are told, and stay as close as their files and physics allow."""

import re
import sysconfig
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from conftest import ARM
from scipy.interpolate import CubicHermiteSpline

from drake_twin import TwinBuilder
from drake_twin.errors import CommandError

SHARE = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share"
DATA = SHARE / "example-robot-data" / "robots"
needs_data = pytest.mark.skipif(
    not DATA.is_dir(), reason="example-robot-data is not installed: pip install '.[corpus]'"
)

ARM_CONTROLLERS = """controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    arm_controller: {type: joint_trajectory_controller/JointTrajectoryController}
arm_controller:
  ros__parameters:
    joints: [joint_1, joint_2, joint_3]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""
ACTION = "/arm/arm_controller/follow_joint_trajectory"


@pytest.fixture
def arm(tmp_path):
    controllers = tmp_path / "controllers.yaml"
    controllers.write_text(ARM_CONTROLLERS)
    return TwinBuilder().robot("arm", ARM, controllers=controllers).build()


def point(time, positions, velocities=()):
    return {"positions": positions, "velocities": velocities, "time_from_start": time}


def positions(twin, robot="arm", joints=("joint_1", "joint_2", "joint_3")):
    state = twin.robot_state(robot)
    return np.array([state.positions[state.joints.index(joint)] for joint in joints])


JOINTS = ["joint_1", "joint_2", "joint_3"]


def goal(*points):
    return {"trajectory": {"joint_names": JOINTS, "points": list(points)}}


# Trajectories


def test_an_arm_follows_a_cubic_trajectory_within_a_hundredth_of_a_radian(arm):
    done = []
    arm.graph.send_goal(ACTION, goal(point(2.0, [1.0, 0.5, -0.5], [0.0, 0.0, 0.0])), done.append)
    cubic = CubicHermiteSpline([0, 2], [[0, 0, 0], [1.0, 0.5, -0.5]], [[0, 0, 0], [0, 0, 0]])
    errors = []
    arm.subscribe("/clock", lambda message: errors.append(np.abs(positions(arm) - cubic(min(arm.time, 2))).max()), 100)
    arm.advance_to(3.0)
    assert max(errors) < 0.01
    assert len(errors) == 300
    (sent,) = done
    assert (sent.status, sent.result.error_code) == ("succeeded", 0)


def test_a_trajectory_on_the_topic_moves_the_arm_too(arm):
    arm.publish("/arm/arm_controller/joint_trajectory", goal(point(1.0, [0.3, 0.2, 0.1]))["trajectory"])
    arm.advance_to(2.0)
    assert positions(arm) == pytest.approx([0.3, 0.2, 0.1], abs=2e-3)


def test_a_newer_goal_takes_the_place_of_the_one_before(arm):
    first = arm.graph.send_goal(ACTION, goal(point(2.0, [1.0, 0.0, 0.0])))
    arm.advance_to(0.5)
    assert first.status == "executing"
    second = arm.graph.send_goal(ACTION, goal(point(1.0, [-0.5, 0.0, 0.0])))
    arm.advance_to(0.6)
    assert (first.status, second.status) == ("aborted", "executing")
    arm.advance_to(3.0)
    assert second.status == "succeeded"
    assert positions(arm)[0] == pytest.approx(-0.5, abs=2e-3)


def test_a_cancelled_goal_leaves_the_arm_where_it_is(arm):
    sent = arm.graph.send_goal(ACTION, goal(point(2.0, [1.0, 0.0, 0.0])))
    arm.advance_to(0.5)
    assert sent.feedback.joint_names == JOINTS
    sent.cancel()
    where = positions(arm)[0]
    arm.advance_to(3.0)
    assert sent.status == "canceled"
    assert positions(arm)[0] == pytest.approx(where, abs=0.15)
    assert positions(arm)[0] < 0.6


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"trajectory": {"joint_names": ["elbow"], "points": [point(1.0, [1.0])]}}, "elbow"),
        ({"trajectory": {"joint_names": JOINTS, "points": [point(1.0, [1.0])]}}, "position"),
        (goal(point(1.0, [0.1] * 3), point(0.5, [0.2] * 3)), "increas"),
        ({"trajectory": 5}, "not a mapping"),
        ({"trajectry": {}}, "no field trajectry; it has trajectory"),
    ],
)
def test_a_wrong_goal_is_rejected_in_words(arm, wrong, reason):
    with pytest.raises(CommandError, match=f"goal is rejected: .*{reason}"):
        arm.graph.send_goal(ACTION, wrong)


def test_a_goal_ends_with_the_controller_that_has_it(arm):
    sent = arm.graph.send_goal(ACTION, goal(point(2.0, [1.0, 0.0, 0.0])))
    arm.advance_to(0.5)
    arm.control.manager("arm").switch_controller(deactivate=["arm_controller"])
    assert sent.is_done
    with pytest.raises(CommandError, match="controller arm_controller is not active"):
        arm.graph.send_goal(ACTION, goal(point(2.0, [1.0, 0.0, 0.0])))
    arm.reset()
    again = arm.graph.send_goal(ACTION, goal(point(0.5, [0.2, 0.0, 0.0])))
    arm.reset()
    assert again.status == "canceled"
    arm.advance_to(1.0)
    assert positions(arm)[0] == pytest.approx(0.0, abs=1e-3)


def test_trajectories_repeat_to_the_last_bit_whoever_listens(arm):
    hashes = []
    for rate in (None, 30.0):
        arm.reset()
        if rate:
            arm.subscribe("/arm/arm_controller/controller_state", lambda message: None, rate)
        arm.graph.send_goal(ACTION, goal(point(0.7, [1.0, 0.5, -0.5])))
        arm.advance_to(1.0)
        hashes.append(arm.state_sha256())
    assert hashes[0] == hashes[1]


# Servos


def with_interfaces(file, folder, *interfaces):
    """A URDF with a ``<ros2_control>`` tag for all its joints."""
    text = file.read_text()
    joints = re.findall(r'<joint name="([^"]+)" type="(?:revolute|prismatic|continuous)"', text)
    commands = "".join(f'<command_interface name="{name}"/>' for name in interfaces)
    tags = "".join(f'<joint name="{joint}">{commands}<state_interface name="position"/></joint>' for joint in joints)
    copy = folder / file.name
    copy.write_text(text.replace("</robot>", f'<ros2_control name="s" type="system">{tags}</ros2_control></robot>'))
    return copy, joints


@needs_data
@pytest.mark.parametrize("time_step", [0.001, 0.01])
@pytest.mark.parametrize("name", ["ur_description/urdf/ur5_robot.urdf", "z1_description/urdf/z1.urdf"])
def test_a_position_step_settles_within_a_milliradian_without_overshoot(tmp_path, name, time_step):
    file, joints = with_interfaces(DATA / name, tmp_path, "position")
    twin = TwinBuilder(time_step=time_step).package_path(SHARE).robot("arm", file, xyz=(0, 0, 3)).build()
    (topic,) = twin.built.commanded
    start = positions(twin, joints=joints)
    limits = np.array([*twin.graph.command_limits(topic).values()])
    # A radian, or as much as there is room for; down for those whose links meet on the way up.
    down = np.array([joint == "wrist_1_joint" for joint in joints]) | (start + 1.0 > limits[:, 1])
    targets = np.clip(np.where(down, start - 1.0, start + 1.0), limits[:, 0], limits[:, 1])
    for index in range(len(joints)):
        twin.reset()
        command = start.copy()
        command[index] = targets[index]
        twin.publish(topic, command)
        step, overshoot = command[index] - start[index], 0.0
        for tick in range(1, 401):
            twin.advance_to(0.01 * tick)
            overshoot = max(overshoot, (positions(twin, joints=joints)[index] - command[index]) / step)
        assert overshoot < 0.05
        assert positions(twin, joints=joints) == pytest.approx(command, abs=1e-3)


@needs_data
@pytest.mark.parametrize("time_step", [0.001, 0.01])
@pytest.mark.parametrize("name", ["ur_description/urdf/ur5_robot.urdf", "z1_description/urdf/z1.urdf"])
def test_a_velocity_is_held_to_a_thousandth_against_gravity(tmp_path, name, time_step):
    file, joints = with_interfaces(DATA / name, tmp_path, "velocity")
    twin = TwinBuilder(time_step=time_step).package_path(SHARE).robot("arm", file, xyz=(0, 0, 3)).build()
    (topic,) = twin.built.commanded
    for index in range(len(joints)):
        twin.reset()
        command = np.zeros(len(joints))
        lower, upper = twin.built.plans[0].description.joints_by_name[joints[index]].limits.lower, None
        upper = twin.built.plans[0].description.joints_by_name[joints[index]].limits.upper
        start = positions(twin, joints=joints)[index]
        command[index] = 1.0 if upper - start > start - lower else -1.0
        twin.publish(topic, command)
        twin.advance_to(0.4)
        state = twin.robot_state("arm")
        velocity = state.velocities[state.joints.index(joints[index])]
        assert velocity == pytest.approx(command[index], rel=1e-3), joints[index]


def test_a_wheel_that_has_turned_far_stands_still_when_told_to(tmp_path):
    robot = tmp_path / "robot.urdf"
    robot.write_text("""<robot name="r"><link name="base"/><link name="wheel"><inertial><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint><link name="world"/>
      <joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/></joint>
      <ros2_control name="s" type="system"><joint name="axle"><command_interface name="velocity"/></joint>
      </ros2_control></robot>""")
    twin = TwinBuilder(time_step=0.01).robot("r", robot).build()
    topic = "/r/forward_velocity_controller/commands"
    twin.publish(topic, [1800.0])
    twin.advance_to(20.0)
    assert positions(twin, "r", ["axle"])[0] > 35_000
    twin.publish(topic, [0.0])
    twin.advance_to(22.0)
    before = positions(twin, "r", ["axle"])[0]
    twin.advance_to(42.0)
    assert positions(twin, "r", ["axle"])[0] == pytest.approx(before, abs=1e-9)


# Drives

CART = """<robot name="cart">
  <link name="base_link"><inertial><mass value="5"/><inertia ixx="0.05" iyy="0.08" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial></link>
  {wheels}
  <link name="caster"><inertial><mass value="0.1"/>
    <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="caster_joint" type="fixed"><parent link="base_link"/><child link="caster"/>
    <origin xyz="-0.2 0 0.05"/></joint>
  <gazebo reference="caster"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>
  <ros2_control name="s" type="system">
    <joint name="left"><command_interface name="velocity"/><state_interface name="position"/>
      <state_interface name="velocity"/></joint>
    <joint name="right"><command_interface name="velocity"/><state_interface name="position"/>
      <state_interface name="velocity"/></joint>
  </ros2_control>
</robot>"""
WHEEL = """<link name="{name}_wheel"><inertial><mass value="0.5"/>
    <inertia ixx="1e-3" iyy="2e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="{name}" type="continuous"><parent link="base_link"/><child link="{name}_wheel"/>
    <origin xyz="0 {y} 0.1"/><axis xyz="0 1 0"/><limit effort="20" velocity="50"/></joint>"""
DRIVE = """controller_manager:
  ros__parameters:
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    drive: {type: diff_drive_controller/DiffDriveController}
drive:
  ros__parameters:
    left_wheel_names: [left]
    right_wheel_names: [right]
    wheel_separation: 0.4
    wheel_radius: 0.1
    publish_rate: 100.0
    pose_covariance_diagonal: [0.001, 0.001, 0.001, 0.001, 0.001, 0.01]
    twist_covariance_diagonal: [0.001, 0.001, 0.001, 0.001, 0.001, 0.01]
"""


@pytest.fixture
def cart(tmp_path):
    wheels = WHEEL.format(name="left", y=0.2) + WHEEL.format(name="right", y=-0.2)
    (tmp_path / "cart.urdf").write_text(CART.format(wheels=wheels))
    (tmp_path / "drive.yaml").write_text(DRIVE)
    return TwinBuilder().robot("cart", tmp_path / "cart.urdf", controllers=tmp_path / "drive.yaml").build()


def drive(twin, linear, angular, until):
    """Commands a twist again and again, as a program does, until a time."""
    while twin.time < until - 1e-9:
        twin.publish("/cart/drive/cmd_vel", {"twist": {"linear": {"x": linear}, "angular": {"z": angular}}})
        twin.advance_to(min(twin.time + 0.1, until))


def heading(quaternion):
    w, x, y, z = quaternion
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def test_a_commanded_twist_is_reached_on_the_ground(cart):
    drive(cart, 0.5, 0.8, 2.0)
    twist = cart.latest("/cart/ground_truth/odom").twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.5, 0.8), rel=0.01)
    odometry = cart.latest("/cart/drive/odom").twist.twist
    assert (odometry.linear.x, odometry.angular.z) == pytest.approx((0.5, 0.8), rel=0.01)


def test_a_square_closes_as_far_as_wheel_slip_lets_it(cart):
    x, y, _ = cart.robot_state("cart").base_pose[:3]
    for _ in range(4):
        drive(cart, 0.5, 0.0, cart.time + 4.0)
        drive(cart, 0.0, 0.0, cart.time + 0.2)
        drive(cart, 0.0, pi / 4, cart.time + 2.0)
        drive(cart, 0.0, 0.0, cart.time + 0.2)
    pose = cart.robot_state("cart").base_pose
    odometry = cart.latest("/cart/drive/odom").pose.pose
    gap = np.hypot(pose[0] - x, pose[1] - y)
    slip = np.hypot(pose[0] - x - odometry.position.x, pose[1] - y - odometry.position.y)
    assert np.hypot(odometry.position.x, odometry.position.y) < 0.02  # as the wheels tell it, the square closes
    assert gap < slip + 0.02
    assert slip < 0.15
    assert heading(pose[3:]) == pytest.approx(0.0, abs=0.05)


def test_odometry_and_tf_agree_and_the_base_has_one_parent(cart):
    drive(cart, 0.3, 0.5, 1.5)
    odometry = cart.latest("/cart/drive/odom")
    (transform,) = [item for item in cart.latest("/tf").transforms if item.child_frame_id == odometry.child_frame_id]
    assert transform.header.frame_id == odometry.header.frame_id
    assert (transform.transform.translation.x, transform.transform.translation.y) == pytest.approx(
        (odometry.pose.pose.position.x, odometry.pose.pose.position.y), abs=1e-12
    )
    assert transform.transform.rotation.z == pytest.approx(odometry.pose.pose.orientation.z, abs=1e-12)


def test_without_commands_the_base_brakes_after_half_a_second(cart):
    drive(cart, 0.5, 0.0, 1.0)
    cart.advance_to(1.3)
    assert cart.latest("/cart/ground_truth/odom").twist.twist.linear.x == pytest.approx(0.5, rel=0.01)
    cart.advance_to(2.0)
    assert cart.latest("/cart/ground_truth/odom").twist.twist.linear.x == pytest.approx(0.0, abs=1e-3)


def test_an_arc_ends_where_geometry_says(cart):
    drive(cart, 0.4, 0.4, 3.0)
    odometry = cart.latest("/cart/drive/odom").pose.pose.position
    angle = 0.4 * 3.0
    assert (odometry.x, odometry.y) == pytest.approx((sin(angle), 1 - cos(angle)), abs=0.03)


# Isolation


def test_fifty_robots_of_one_file_and_none_hears_anothers_command(tmp_path):
    robot = tmp_path / "robot.urdf"
    robot.write_text("""<robot name="r"><link name="base"/><link name="wheel"><inertial><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint><link name="world"/>
      <joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/></joint>
      <ros2_control name="s" type="system"><joint name="axle"><command_interface name="velocity"/>
      <state_interface name="velocity"/></joint></ros2_control></robot>""")
    builder = TwinBuilder(time_step=0.01)
    for index in range(50):
        builder.robot(f"r{index}", robot, xyz=(index, 0, 1))
    twin = builder.build()
    for index in range(0, 50, 2):
        twin.publish(f"/r{index}/forward_velocity_controller/commands", [index + 1.0])
    twin.advance_to(0.5)
    speeds = [twin.robot_state(f"r{index}").velocities[0] for index in range(50)]
    expected = [index + 1.0 if index % 2 == 0 else 0.0 for index in range(50)]
    assert speeds == pytest.approx(expected, rel=1e-3, abs=1e-9)
    assert twin.control.manager("r3").switch_controller(deactivate=["forward_velocity_controller"])
    assert all("forward_velocity_controller" in twin.control.manager(f"r{index}").active for index in (0, 2, 4))


def test_two_robots_whose_parameters_contradict_each_other(tmp_path):
    files = {}
    for name, kind, rate in (("a", "velocity", 50), ("b", "position", 200)):
        files[name] = tmp_path / f"{name}.yaml"
        files[name].write_text(
            f"controller_manager:\n  ros__parameters:\n    update_rate: {rate}\n"
            f"    wheels: {{type: {kind}_controllers/JointGroup{kind.title()}Controller}}\n"
            "wheels: {ros__parameters: {joints: [axle]}}\n"
        )
    robot = tmp_path / "robot.urdf"
    robot.write_text("""<robot name="r"><link name="base"/><link name="wheel"><inertial><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint><link name="world"/>
      <joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/></joint>
      <ros2_control name="s" type="system"><joint name="axle"><command_interface name="velocity"/>
      <command_interface name="position"/></joint></ros2_control></robot>""")
    builder = TwinBuilder()
    for index, (name, file) in enumerate(files.items()):
        builder.robot(name, robot, xyz=(index, 0, 1), controllers=file)
    twin = builder.build()
    for name in files:
        twin.publish(f"/{name}/wheels/commands", [2.0])
    twin.advance_to(3.0)
    assert twin.robot_state("a").velocities[0] == pytest.approx(2.0, rel=1e-3)
    assert twin.robot_state("b").positions[0] == pytest.approx(2.0, abs=1e-3)
    rates = [twin.control.manager(name).list_controllers()[0].update_rate for name in files]
    assert rates == [50, 200]
    claims = [twin.control.manager(name).list_controllers()[0].claimed_interfaces for name in files]
    assert claims == [("axle/velocity",), ("axle/position",)]
