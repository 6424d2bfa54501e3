"""Robots that only a Gazebo plugin drives, in the twin."""

import re

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import CommandError, InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot

CART = """<robot name="cart">
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed"><parent link="base_footprint"/><child link="base_link"/></joint>
  <link name="base_link"><inertial><mass value="5"/><inertia ixx="0.05" iyy="0.08" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial></link>
  {wheels}
  <link name="caster"><inertial><mass value="0.1"/>
    <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="caster_joint" type="fixed"><parent link="base_link"/><child link="caster"/>
    <origin xyz="-0.2 0 0.05"/></joint>
  <gazebo reference="caster"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>
  {more}
</robot>"""
WHEEL = """<link name="{name}_wheel"><inertial><mass value="0.5"/>
    <inertia ixx="1e-3" iyy="2e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="{name}" type="continuous"><parent link="base_link"/><child link="{name}_wheel"/>
    <origin xyz="0 {y} 0.1"/><axis xyz="0 1 0"/></joint>"""
DIFF_DRIVE = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
    {ros}<left_joint>left</left_joint><right_joint>right</right_joint>
    <wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter>
    <max_wheel_torque>20</max_wheel_torque><publish_odom>true</publish_odom>
    <publish_odom_tf>true</publish_odom_tf><robot_base_frame>base_footprint</robot_base_frame>
  </plugin></gazebo>"""


@pytest.fixture
def make(tmp_path):
    def make(more):
        wheels = WHEEL.format(name="left", y=0.2) + WHEEL.format(name="right", y=-0.2)
        (tmp_path / "cart.urdf").write_text(CART.format(wheels=wheels, more=more))
        return TwinBuilder().robot("cart", tmp_path / "cart.urdf").build()

    return make


def test_a_value_of_a_plugin_that_its_controller_refuses_has_the_line_of_the_plugin(make, tmp_path):
    drive = """<gazebo><plugin name="drive" filename="gz-sim-diff-drive-system"><left_joint>left</left_joint>
      <right_joint>right</right_joint><wheel_separation>0.4</wheel_separation><wheel_radius>-0.1</wheel_radius>
      </plugin></gazebo>"""
    with pytest.raises(InputError, match=rf"^{tmp_path}/cart.urdf:\d+: controller 'drive': -0.1 is not above 0"):
        make(drive)


def test_a_twist_drives_a_cart_that_has_only_the_plugin(make):
    twin = make(DIFF_DRIVE.format(ros=""))
    assert twin.findings.not_started == ()
    assert twin.graph.topics()["/cart/cmd_vel"] == "geometry_msgs/msg/Twist"
    twin.publish("/cart/cmd_vel", {"linear": {"x": 0.5}, "angular": {"z": 0.3}})
    twin.advance_to(2.0)  # the plugin has no timeout
    twist = twin.latest("/cart/ground_truth/odom").twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.5, 0.3), rel=0.02)


def test_its_odometry_is_the_true_pose_and_is_on_tf(make):
    twin = make(DIFF_DRIVE.format(ros=""))
    twin.publish("/cart/cmd_vel", {"linear": {"x": 0.5}, "angular": {"z": 0.3}})
    twin.advance_to(2.0)
    true = twin.latest("/cart/ground_truth/odom").pose.pose.position
    odometry = twin.latest("/cart/odom")
    assert (odometry.pose.pose.position.x, odometry.pose.pose.position.y) == pytest.approx((true.x, true.y), abs=1e-12)
    (transform,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id == "cart/base_footprint"]
    assert transform.header.frame_id == "cart/odom"
    assert transform.transform.translation.x == pytest.approx(true.x, abs=1e-12)


def test_its_odometry_stays_true_after_many_turns(make):
    twin = make(DIFF_DRIVE.format(ros=""))
    twin.clock.set_time_step(0.01)
    twin.publish("/cart/cmd_vel", {"linear": {"x": 0.5}, "angular": {"z": 3.0}})
    twin.advance_to(30.3)
    assert np.linalg.norm(twin.entities.state_vector("cart")[:4]) > 1.1  # Drake keeps the direction only
    true, seen = twin.entities.state("cart"), twin.latest("/cart/odom")
    sent = seen.pose.pose.orientation
    turned = abs(np.dot([sent.w, sent.x, sent.y, sent.z], true.orientation))
    assert turned == pytest.approx(1, abs=1e-6)
    forwards = np.hypot(*true.linear[:2])
    assert seen.twist.twist.linear.x == pytest.approx(forwards, rel=1e-3)
    (transform,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id == "cart/base_footprint"]
    rotation = transform.transform.rotation
    assert (rotation.w, rotation.z) == pytest.approx((sent.w, sent.z), abs=1e-9)


def test_the_plugins_own_remapping_names_the_topics(make):
    twin = make(DIFF_DRIVE.format(ros="<ros><remapping>cmd_vel:=drive/twist</remapping></ros>"))
    assert "/cart/drive/twist" in twin.graph.topics()
    assert "/cart/cmd_vel" not in twin.graph.topics()


def test_a_plugin_that_cannot_work_is_said_and_the_robot_is_there(make):
    twin = make(DIFF_DRIVE.format(ros="").replace(">left<", ">lft<"))
    assert twin.findings.not_started == (
        "cart: Gazebo plugin drive (libgazebo_ros_diff_drive.so): the robot has no movable joint 'lft' (cart.urdf:21)",
    )


def test_of_two_plugins_that_hear_the_same_twist_the_one_with_wheels_drives(make):
    twin = make(
        '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so"/></gazebo>' + DIFF_DRIVE.format(ros="")
    )
    assert [controller.name for controller in twin.built.plans[0].controllers] == ["drive"]
    (reason,) = twin.findings.not_started
    assert "it would move the base in addition to drive, which drives wheels by the same topics (cart.urdf:" in reason


def test_a_plugin_that_is_named_as_another_controller_has_a_name_of_its_own(make, tmp_path):
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {drive: {type: joint_state_broadcaster/JointStateBroadcaster}}}"
    )
    control = f"""<gazebo><plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
        <parameters>{tmp_path / "c.yaml"}</parameters></plugin></gazebo>"""
    twin = make(control + DIFF_DRIVE.format(ros=""))
    assert [controller.name for controller in twin.built.plans[0].controllers] == ["drive", "drive_plugin"]
    assert set(twin.control.manager("cart").active) == {"drive", "drive_plugin"}
    twin.publish("/cart/cmd_vel", {"linear": {"x": 0.4}})
    twin.advance_to(1.5)
    assert twin.latest("/cart/ground_truth/odom").twist.twist.linear.x == pytest.approx(0.4, rel=0.02)


def test_gz_names_its_topics_by_the_model_and_ros_by_the_bridge(make):
    twin = make(
        """<gazebo><plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
        <left_joint>left</left_joint><right_joint>right</right_joint><wheel_separation>0.4</wheel_separation>
        <wheel_radius>0.1</wheel_radius><topic>cmd_vel</topic></plugin></gazebo>"""
    )
    twin.publish("/cart/cmd_vel", {"linear": {"x": 0.4}})
    twin.advance_to(1.5)
    assert twin.latest("/cart/ground_truth/odom").twist.twist.linear.x == pytest.approx(0.4, rel=0.02)


def test_a_joint_position_controller_of_gz_takes_a_float(make):
    twin = make(
        """<gazebo><plugin filename="gz-sim-joint-position-controller-system" name="p"><joint_name>left</joint_name>
        <topic>left/position</topic><p_gain>20</p_gain><d_gain>3</d_gain></plugin></gazebo>"""
    )
    assert twin.graph.topics()["/cart/left/position"] == "std_msgs/msg/Float64"
    twin.publish("/cart/left/position", {"data": 0.2})
    twin.advance_to(3.0)
    assert twin.robot_state("cart").positions[0] == pytest.approx(0.2, abs=0.01)


def test_one_message_of_actuators_commands_each_wheel_by_its_element(make):
    plugin = """<gazebo><plugin filename="gz-sim-joint-controller-system" name="{joint}">
        <joint_name>{joint}</joint_name><use_actuator_msg>true</use_actuator_msg><actuator_number>{number}</actuator_number></plugin></gazebo>"""
    twin = make(plugin.format(joint="left", number=0) + plugin.format(joint="right", number=2))
    assert twin.graph.topics()["/cart/actuators"] == "actuator_msgs/msg/Actuators"
    twin.publish("/cart/actuators", {"velocity": [1.5, 9.0, -2.0], "position": [7.0]})
    twin.advance_to(0.5)
    assert twin.robot_state("cart").velocities[:2] == pytest.approx((1.5, -2.0), rel=0.01)
    twin.publish("/cart/actuators", {"velocity": [2.5]})  # the right wheel has no element of it
    twin.advance_to(1.0)
    assert twin.robot_state("cart").velocities[:2] == pytest.approx((2.5, -2.0), rel=0.01)
    with pytest.raises(CommandError, match=re.escape("velocity[2] is commanded, but the message has 0 elements of")):
        twin.publish("/cart/actuators", {"position": [2.5]})


PENDULUM = """<robot name="p"><link name="world"/><link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint>
  <link name="disc"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="disc"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="50" velocity="1"/></joint>
  <gazebo><plugin filename="gz-sim-{kind}-system" name="c"><joint_name>j</joint_name>{inside}</plugin></gazebo>
</robot>"""


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_a_pid_of_gz_swings_as_the_equation_of_its_gains(tmp_path, engine):
    text = PENDULUM.format(kind="joint-position-controller", inside="<p_gain>4</p_gain><d_gain>0.4</d_gain>")
    (tmp_path / "p.urdf").write_text(text)
    twin = TwinBuilder(engine=engine).robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/joint/j/0/cmd_pos", {"data": 0.5})
    twin.advance_to(0.02)
    (q,), (v,) = twin.robot_state("p").positions, twin.robot_state("p").velocities
    for time in (0.3, 0.6, 1.0):
        twin.advance_to(time)
        # 0.1 q'' + 0.4 q' + 4 (q - 0.5) = 0 from the state at 0.02 s
        decay, turning = 2.0, np.sqrt(40.0 - 4.0)
        since = time - 0.02
        cosine, sine = np.cos(turning * since), np.sin(turning * since)
        e = q - 0.5
        expected = 0.5 + np.exp(-decay * since) * (e * cosine + (v + decay * e) / turning * sine)
        assert twin.robot_state("p").positions[0] == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_the_integral_part_of_a_pid_moves_as_its_equation_with_its_bound(tmp_path, engine):
    """0.1 q'' = 4 (0.5 - q) - 0.4 q' + s, s' = 6 (0.5 - q), |s| ≤ 0.7, from the state at 0.02 s."""
    inside = "<p_gain>4</p_gain><d_gain>0.4</d_gain><i_gain>6</i_gain><i_max>0.7</i_max><i_min>-0.7</i_min>"
    (tmp_path / "p.urdf").write_text(PENDULUM.format(kind="joint-position-controller", inside=inside))
    twin = TwinBuilder(engine=engine).robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/joint/j/0/cmd_pos", {"data": 0.5})
    twin.advance_to(0.02)
    state = twin.robot_state("p")
    q, v, s, step = state.positions[0], state.velocities[0], 6 * 0.5 * 0.02, 1e-4
    for number in range(1, 10001):
        v += step * (4 * (0.5 - q) - 0.4 * v + s) / 0.1
        q += step * v
        s = min(max(s + step * 6 * (0.5 - q), -0.7), 0.7)
        if number in (2800, 5800, 9800):
            twin.advance_to(0.02 + step * number)
            assert twin.robot_state("p").positions[0] == pytest.approx(q, abs=0.01)


def test_the_integral_part_bears_what_the_servo_alone_would_sag_under(tmp_path):
    """2 N·m on a PD of 10 N·m/rad would leave 0.2 rad; the offset of a velocity's PID is an effort of its own."""
    inside = "<p_gain>10</p_gain><d_gain>2</d_gain><i_gain>20</i_gain><i_max>5</i_max><i_min>-5</i_min>"
    (tmp_path / "p.urdf").write_text(PENDULUM.format(kind="joint-position-controller", inside=inside))
    twin = TwinBuilder().robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/joint/j/0/cmd_pos", {"data": 0.0})
    twin.entities.apply_wrench("p::disc", torque=(0, 0, 2), duration=20)
    twin.advance_to(10.0)
    assert twin.robot_state("p").positions[0] == pytest.approx(0, abs=1e-3)


def test_velocity_commands_of_gz_are_there_at_once_at_their_velocity(tmp_path):
    inside = "<use_velocity_commands>true</use_velocity_commands><cmd_max>0.5</cmd_max>"
    (tmp_path / "p.urdf").write_text(PENDULUM.format(kind="joint-position-controller", inside=inside))
    twin = TwinBuilder().robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/joint/j/0/cmd_pos", {"data": 0.5})
    twin.advance_to(0.5)
    state = twin.robot_state("p")
    assert state.positions[0] == pytest.approx(0.25, abs=0.01)
    assert state.velocities[0] == pytest.approx(0.5, rel=0.01)
    twin.advance_to(1.1)
    assert twin.robot_state("p").positions[0] == pytest.approx(0.5, abs=1e-3)


def test_of_two_plugins_at_a_joint_the_first_has_its_servo_and_its_effort(tmp_path):
    first = "<p_gain>20</p_gain><d_gain>3</d_gain><i_gain>0</i_gain><topic>first</topic>"
    second = "<cmd_max>0.001</cmd_max><cmd_min>-0.001</cmd_min><p_gain>0</p_gain><topic>second</topic>"
    text = PENDULUM.format(kind="joint-position-controller", inside=first)
    plugin = '<plugin filename="gz-sim-joint-position-controller-system" name="d"><joint_name>j</joint_name>{}</plugin>'
    (tmp_path / "p.urdf").write_text(text.replace("</gazebo>", plugin.format(second) + "</gazebo>"))
    twin = TwinBuilder().robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/first", {"data": 0.5})
    twin.advance_to(3.0)
    assert twin.robot_state("p").positions[0] == pytest.approx(0.5, abs=1e-3)


def test_a_topic_with_a_placeholder_that_nobody_filled_is_a_name(tmp_path):
    text = PENDULUM.format(kind="joint-position-controller", inside="<topic>a/{b}/c</topic>")
    (tmp_path / "p.urdf").write_text(text)
    assert any("{b}" in topic for topic in TwinBuilder().robot("p", tmp_path / "p.urdf").build().graph.topics())


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_forces_of_gzs_joint_controller_follow_a_velocity_by_their_gain(tmp_path, engine):
    inside = "<use_force_commands>1</use_force_commands><p_gain>0.2</p_gain>"
    (tmp_path / "p.urdf").write_text(PENDULUM.format(kind="joint-controller", inside=inside))
    twin = TwinBuilder(engine=engine).robot("p", tmp_path / "p.urdf").build()
    twin.publish("/p/joint/j/cmd_vel", {"data": 0.8})
    twin.advance_to(0.5)
    assert twin.robot_state("p").velocities[0] == pytest.approx(0.8 * (1 - np.exp(-0.2 / 0.1 * 0.5)), rel=0.02)


def test_the_cadre_rovers_wheels_turn_as_their_plugin_says(corpus):
    file = corpus / "cadre_demos/cadre_demo/robot_description/robot/robot.xacro"
    twin = TwinBuilder().robot("rover", file, xyz=(0, 0, 0.3)).build()
    twin.publish("/rover/cmd_vel", {"linear": {"x": 0.2}})
    twin.advance_to(2.0)
    assert twin.robot_state("rover").velocities[:4] == pytest.approx([0.2 / 0.0975] * 4, rel=0.01)


@pytest.mark.parametrize(
    ("bridged", "expected"),
    [
        ({}, ["drive"]),  # without a bridge the drive's comes first
        ({"/tf": "/tf"}, ["odometry"]),
        ({"/model/cart/tf": "/tf"}, ["drive"]),
        ({"/tf": "/tf", "/model/cart/tf": "/tf"}, ["drive", "odometry"]),  # as in ROS
    ],
)
def test_the_transform_that_a_bridge_takes_to_ros_is_the_one_of_the_twin(tmp_path, bridged, expected):
    plugins = """<gazebo><plugin name="drive" filename="gz-sim-diff-drive-system"><left_joint>left</left_joint>
      <right_joint>right</right_joint></plugin>
      <plugin name="odometry" filename="gz-sim-odometry-publisher-system"><tf_topic>/tf</tf_topic></plugin></gazebo>"""
    wheels = WHEEL.format(name="left", y=0.2) + WHEEL.format(name="right", y=-0.2)
    (tmp_path / "cart.urdf").write_text(CART.format(wheels=wheels, more=plugins))
    plan = plan_robot(Robot("cart", str(tmp_path / "cart.urdf"), remappings=bridged), PackageIndex())
    assert [item.name for item in plan.controllers if item.parameters.enable_odom_tf] == expected


def test_a_joint_that_a_plugin_commands_has_its_motion_and_what_ros2_control_gives_it(tmp_path):
    control = """<ros2_control name="s" type="system">
      <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
      <joint name="left"><state_interface name="position"/></joint></ros2_control>"""
    wheels = WHEEL.format(name="left", y=0.2) + WHEEL.format(name="right", y=-0.2)
    (tmp_path / "cart.urdf").write_text(CART.format(wheels=wheels, more=control + DIFF_DRIVE.format(ros="")))
    joints = plan_robot(Robot("cart", str(tmp_path / "cart.urdf")), PackageIndex()).description.controlled_joints
    interfaces = {name: [item.name for item in joints[name].state_interfaces] for name in ("left", "right")}
    assert interfaces == {"left": ["position"], "right": ["position", "velocity"]}
    assert [item.name for item in joints["left"].command_interfaces] == ["velocity"]


def test_where_a_bridge_has_stamped_twists_the_drive_listens_to_them(tmp_path):
    wheels = WHEEL.format(name="left", y=0.2) + WHEEL.format(name="right", y=-0.2)
    plugin = """<gazebo><plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
        <left_joint>left</left_joint><right_joint>right</right_joint><wheel_separation>0.4</wheel_separation>
        <wheel_radius>0.1</wheel_radius></plugin></gazebo>"""
    (tmp_path / "cart.urdf").write_text(CART.format(wheels=wheels, more=plugin))
    for stamped, own in (
        (["/model/cart/cmd_vel"], "cmd_vel"),
        ([], "cmd_vel_unstamped"),
        (["/x"], "cmd_vel_unstamped"),
    ):
        plan = plan_robot(Robot("cart", str(tmp_path / "cart.urdf"), stamped_topics=tuple(stamped)), PackageIndex())
        (drive,) = plan.controllers
        for topics in (drive.wiring.topics, drive.wiring.gz_topics):
            assert [name for name in topics if name.startswith("cmd_vel")] == [own]
        assert drive.parameters.use_stamped_vel == (own == "cmd_vel")
