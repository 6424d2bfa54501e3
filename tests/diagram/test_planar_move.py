"""Robots that Gazebo moves over the plane with no drive at all: they go where the twist says, and no farther."""

from math import atan2, cos, pi, sin

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import World

# A sled on four feet that rub, with an arm's joint on it; its root link is massless, as many robots' is.
SLED = """<robot name="sled">
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed"><parent link="base_footprint"/><child link="base_link"/>
    <origin xyz="0 0 0.1"/></joint>
  <link name="base_link">
    <inertial><mass value="10"/><inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision name="body"><geometry><box size="0.6 0.4 0.1"/></geometry></collision>
    {feet}
  </link>
  <link name="flag"><inertial><mass value="0.1"/>
    <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mast" type="continuous"><parent link="base_link"/><child link="flag"/><origin xyz="0 0 0.1"/>
    <axis xyz="0 0 1"/></joint>
  {more}
</robot>"""
FEET = "".join(
    f'<collision name="foot_{x}_{y}"><origin xyz="{x} {y} -0.05"/><geometry><sphere radius="0.05"/></geometry>'
    "</collision>"
    for x in (-0.2, 0.2)
    for y in (-0.15, 0.15)
)
MOVE = """<gazebo><plugin name="object_controller" filename="libgazebo_ros_planar_move.so">
    {more}<robot_base_frame>base_footprint</robot_base_frame></plugin></gazebo>"""
WALL = """<robot name="wall"><link name="world"/><link name="wall">
    <inertial><mass value="50"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.2 4 1"/></geometry></collision></link>
  <joint name="stands" type="fixed"><parent link="world"/><child link="wall"/><origin xyz="0 0 0.5"/></joint>
</robot>"""


@pytest.fixture
def sled(tmp_path):
    file = tmp_path / "sled.urdf"
    file.write_text(SLED.format(feet=FEET, more=MOVE.format(more="")))
    return file


def pose(twin, robot="sled"):
    """x, y, and the heading, in the world."""
    x, y, _, qw, qx, qy, qz = twin.robot_state(robot).base_pose
    return np.array([x, y, atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))])


def twist(x=0.0, y=0.0, z=0.0):
    return {"linear": {"x": x, "y": y}, "angular": {"z": z}}


def driven(twin, command, until=3.0, robot="sled"):
    """The velocity forwards, to the left and about z while a command holds that was given at 0.5 s."""
    twin.advance_to(0.5)
    twin.publish(f"/{robot}/cmd_vel", command)
    twin.advance_to(until)
    velocity = twin.latest(f"/{robot}/ground_truth/odom").twist.twist
    return velocity.linear.x, velocity.linear.y, velocity.angular.z


@pytest.mark.parametrize(
    "command", [(0.5, 0, 0), (0, 0.3, 0), (0, 0, 1.0), (-0.1, 0.1, 0), (0.05, 0, 0.1), (0.4, 0.0, 1.5)]
)
def test_the_base_has_the_commanded_velocity_although_its_feet_rub(sled, command):
    twin = TwinBuilder().robot("sled", sled, xyz=(1, 2, 0), rpy=(0, 0, 0.7)).build()
    assert (twin.findings.not_started, twin.findings.warnings) == ((), ())
    reached = driven(twin, twist(*command))
    assert reached == pytest.approx(command, abs=0.01 * np.abs(command).max())


def test_feet_far_from_a_slender_mass_do_not_keep_it_from_turning(sled):
    slender = '<inertia ixx="0.02" iyy="0.02" izz="0.01"'
    sled.write_text(sled.read_text().replace('<inertia ixx="0.1" iyy="0.2" izz="0.3"', slender))
    twin = TwinBuilder().robot("sled", sled).build()
    assert driven(twin, twist(z=1.0)) == pytest.approx((0, 0, 1.0), abs=0.01)


@pytest.mark.parametrize("world", [World(ground_friction=100.0), World(gravity=(0.0, 0.0, 0.0))])
def test_rough_ground_and_weightlessness_make_no_difference(sled, world):
    twin = TwinBuilder(world=world).robot("sled", sled).build()
    driven(twin, twist(0.5, 0.2, 0.0), until=4.5)
    assert pose(twin) == pytest.approx((2.0, 0.8, 0.0), abs=0.02)


def test_a_longer_step_makes_no_difference(sled):
    twin = TwinBuilder(time_step=0.01).robot("sled", sled).build()
    driven(twin, twist(0.5, 0.2), until=4.5)
    assert pose(twin) == pytest.approx((2.0, 0.8, 0.0), abs=0.02)


def test_it_stays_where_it_is_before_the_first_command_and_upright_on_the_ground(sled):
    twin = TwinBuilder().robot("sled", sled, xyz=(1, 2, 0.1), rpy=(0.0, 0.1, 0.7)).build()
    twin.advance_to(1.0)
    x, y, z, *quaternion = twin.robot_state("sled").base_pose
    assert (x, y) == pytest.approx((1, 2), abs=1e-6)
    assert z == pytest.approx(0.2 * sin(0.1) + 0.05 * (1 - cos(0.1)), abs=1e-3)  # it fell onto its front feet
    half = np.array([0.05, 0.35])
    (cp, cy), (sp, sy) = np.cos(half), np.sin(half)
    assert quaternion == pytest.approx([cp * cy, -sp * sy, sp * cy, cp * sy], abs=1e-6)


@pytest.mark.parametrize("yaw", [0.0, 2.5])
def test_a_twist_that_turns_drives_an_arc(sled, yaw):
    twin = TwinBuilder().robot("sled", sled, xyz=(1, 2, 0), rpy=(0, 0, yaw)).build()
    driven(twin, twist(0.5, 0.2, 0.8), until=1.0)
    start_x, start_y, start = pose(twin)
    assert start - yaw == pytest.approx(0.8 * 0.5, abs=5e-3)  # it takes 5 ms to get going
    twin.advance_to(4.5)
    turn, (vx, vy) = 0.8 * 3.5, np.array([0.5, 0.2]) / 0.8
    forwards, left = vx * sin(turn) - vy * (1 - cos(turn)), vx * (1 - cos(turn)) + vy * sin(turn)
    expected_x = start_x + cos(start) * forwards - sin(start) * left
    expected_y = start_y + sin(start) * forwards + cos(start) * left
    x, y, heading = pose(twin)
    assert (x, y) == pytest.approx((expected_x, expected_y), abs=2e-4)
    assert (heading - start - turn + pi) % (2 * pi) - pi == pytest.approx(0.0, abs=1e-4)


def test_the_last_twist_holds_until_the_next(sled):
    twin = TwinBuilder().robot("sled", sled).build()
    assert driven(twin, twist(0.2), until=20.0)[0] == pytest.approx(0.2, rel=0.01)
    twin.publish("/sled/cmd_vel", twist())
    twin.advance_to(20.5)
    stopped = pose(twin)
    twin.advance_to(22.0)
    assert pose(twin) == pytest.approx(stopped, abs=1e-6)


def test_a_wall_stops_it_and_it_comes_away_again(sled, tmp_path):
    (tmp_path / "wall.urdf").write_text(WALL)
    twin = TwinBuilder().robot("sled", sled).robot("wall", tmp_path / "wall.urdf", xyz=(1.0, 0, 0)).build()
    driven(twin, twist(0.5), until=4.0)
    assert pose(twin) == pytest.approx((0.6, 0, 0), abs=5e-3)  # its front, 0.3 m ahead, is at the wall's face
    twin.publish("/sled/cmd_vel", twist(-0.5))
    twin.advance_to(5.0)
    assert pose(twin)[0] == pytest.approx(0.1, abs=0.01)


def test_it_does_not_turn_through_a_wall(sled, tmp_path):
    (tmp_path / "wall.urdf").write_text(WALL)
    twin = TwinBuilder().robot("sled", sled).robot("wall", tmp_path / "wall.urdf", xyz=(0, 0.32, 0), rpy=(0, 0, pi / 2))
    twin = twin.build()  # its side is 2 cm from the wall, and its corner would pass 14 cm behind the wall's face
    driven(twin, twist(z=1.0), until=4.0)
    assert 0.0 < pose(twin)[2] < 0.2


def test_a_robot_ten_times_as_heavy_stops_it(sled, tmp_path):
    heavy = tmp_path / "heavy.urdf"
    heavy.write_text(sled.read_text().replace('<mass value="10"/>', '<mass value="100"/>').replace("object_c", "c"))
    twin = TwinBuilder().robot("sled", sled).robot("heavy", heavy, xyz=(1.2, 0, 0)).build()
    driven(twin, twist(0.5), until=4.0)
    assert pose(twin, "heavy") == pytest.approx((1.2, 0, 0), abs=2e-3)
    assert pose(twin)[0] == pytest.approx(0.6, abs=5e-3)


def test_its_odometry_is_its_pose_in_the_world_and_is_on_tf(sled):
    twin = TwinBuilder().robot("sled", sled, xyz=(1, 2, 0), rpy=(0, 0, 2.0)).build()
    driven(twin, twist(0.3, 0.1, 0.2))
    x, y, heading = pose(twin)
    odometry = twin.latest("/sled/odom").pose.pose
    assert (odometry.position.x, odometry.position.y) == pytest.approx((x, y), abs=1e-12)
    assert 2 * atan2(odometry.orientation.z, odometry.orientation.w) == pytest.approx(heading, abs=1e-12)
    truth = twin.latest("/sled/ground_truth/odom").pose.pose
    assert (truth.position.x, truth.position.y, truth.orientation.z) == pytest.approx(
        (x, y, odometry.orientation.z), abs=1e-12
    )
    (transform,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id == "sled/base_footprint"]
    assert transform.transform.translation.x == pytest.approx(x, abs=1e-12)


def test_the_joints_under_the_base_do_not_show(sled):
    twin = TwinBuilder().robot("sled", sled).build()
    driven(twin, twist(0.3))
    assert list(twin.joint_states("sled").name) == ["mast"]
    frames = [item.child_frame_id for topic in ("/tf", "/tf_static") for item in twin.latest(topic).transforms]
    assert sorted(frames) == ["sled/base_footprint", "sled/base_link", "sled/flag"]
    assert twin.robot_state("sled").joints == ("mast",)
    assert list(twin.entities.start_positions("sled")) == ["mast"]
    assert [joint.name for joint in twin.built.plans[0].description.joints] == ["base_joint", "mast"]
    with pytest.raises(InputError, match=r"no movable joint 'base\.linear\.x'"):
        twin.entities.set_joint_positions("sled", {"base.linear.x": 1.0})


def test_its_controller_claims_the_base_and_lets_go_of_it(sled):
    twin = TwinBuilder().robot("sled", sled).build()
    manager = twin.control.manager("sled")
    commands, _ = manager.list_hardware_interfaces()
    assert [(item.name, item.is_claimed) for item in commands] == [
        ("base.linear.x/velocity", True),
        ("base.linear.y/velocity", True),
        ("base.angular.z/velocity", True),
    ]
    driven(twin, twist(0.5))
    assert manager.switch_controller(deactivate=["object_controller"])
    moving = pose(twin)[0]
    twin.advance_to(5.0)
    stopped = pose(twin)[0]
    assert moving < stopped <= moving + 0.5**2 / (2 * 30)  # it brakes with 30 N for each kg, and rubs besides
    assert manager.switch_controller(activate=["object_controller"])
    twin.publish("/sled/cmd_vel", twist(0, 0.5))
    twin.advance_to(6.0)
    assert twin.latest("/sled/ground_truth/odom").twist.twist.linear.y == pytest.approx(0.5, rel=0.01)


def test_an_emergency_stop_brings_it_to_rest(sled):
    twin = TwinBuilder().robot("sled", sled).build()
    driven(twin, twist(0.5, 0, 1.0))
    twin.control.emergency_stop("sled")
    twin.advance_to(5.0)
    velocity = twin.latest("/sled/ground_truth/odom").twist.twist
    assert (velocity.linear.x, velocity.linear.y, velocity.angular.z) == pytest.approx((0, 0, 0), abs=1e-3)


def test_after_a_reset_it_drives_the_same_way_to_the_last_bit(sled):
    twin = TwinBuilder().robot("sled", sled, xyz=(1, 2, 0), rpy=(0, 0, 1.0)).build()
    driven(twin, twist(0.5, 0.1, 0.4))
    first = twin.state_sha256()
    twin.reset()
    assert pose(twin) == pytest.approx((1, 2, 1.0), abs=1e-12)
    driven(twin, twist(0.5, 0.1, 0.4))
    assert twin.state_sha256() == first


def test_of_two_robots_of_one_file_only_the_commanded_one_moves(sled):
    twin = TwinBuilder().robot("sled", sled).robot("other", sled, xyz=(0, 2, 0), rpy=(0, 0, pi / 2)).build()
    driven(twin, twist(0.5))
    assert pose(twin) == pytest.approx((1.25, 0, 0), abs=0.01)
    assert pose(twin, "other") == pytest.approx((0, 2, pi / 2), abs=1e-6)
    twin.publish("/other/cmd_vel", twist(0.5))
    twin.advance_to(4.0)
    assert pose(twin, "other") == pytest.approx((0, 2.5, pi / 2), abs=0.01)


def test_a_base_that_is_fixed_to_the_world_is_not_moved(sled):
    sled.write_text(
        sled.read_text()
        .replace('<link name="base_footprint"/>', '<link name="world"/><link name="base_footprint"/>')
        .replace(
            "<gazebo>",
            '<joint name="w" type="fixed"><parent link="world"/><child link="base_footprint"/></joint><gazebo>',
        )
    )
    twin = TwinBuilder().robot("sled", sled).build()
    (reason,) = twin.findings.not_started
    assert "it moves the base, which is fixed to the world (sled.urdf:" in reason


def test_velocity_control_of_gz_drives_the_same_way(sled):
    sled.write_text(
        SLED.format(
            feet=FEET,
            more='<gazebo><plugin filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl"/>'
            "</gazebo>",
        )
    )
    twin = TwinBuilder().robot("sled", sled).build()
    assert driven(twin, twist(0.3, 0.2, 0.0)) == pytest.approx((0.3, 0.2, 0.0), abs=0.003)


def test_linorobots_mecanum_base_drives_as_its_plugin_says(corpus):
    file = corpus / "linorobot2/linorobot2_description/urdf/robots/mecanum.urdf.xacro"
    builder = TwinBuilder().robot("lino", file, xyz=(1, 2, 0.0), rpy=(0, 0, 1.0))
    twin = builder.robot("other", file, xyz=(-3, 0, 0.0)).build()
    assert [text for text in twin.findings.not_started if "sensor" not in text] == []
    assert driven(twin, twist(0.4, -0.2, 0.5), robot="lino") == pytest.approx((0.4, -0.2, 0.5), abs=0.004)
    odometry = twin.latest("/lino/odom/unfiltered").pose.pose.position
    assert (odometry.x, odometry.y) == pytest.approx(pose(twin, "lino")[:2], abs=1e-12)
    assert all(name.endswith("_wheel_joint") for name in twin.joint_states("lino").name)
    assert pose(twin, "other") == pytest.approx((-3, 0, 0), abs=1e-6)


def test_the_drive_is_as_strong_with_a_rubbing_joint_in_every_engine(tmp_path):
    """What brakes the mast in CENIC is no shape of the robot's, however far it reaches."""
    control = '<ros2_control name="s" type="system"><joint name="mast"><command_interface name="velocity"/></joint>'
    text = SLED.format(feet=FEET, more=MOVE.format(more="") + control + "</ros2_control>")
    file = tmp_path / "sled.urdf"
    file.write_text(text.replace('<axis xyz="0 0 1"/></joint>', '<axis xyz="0 0 1"/><dynamics friction="5"/></joint>'))
    limits = []
    for engine in ("discrete", "cenic"):
        plant = TwinBuilder(engine=engine).robot("sled", file).build().plant
        instance = plant.GetModelInstanceByName("sled")
        actuators = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices(instance)]
        limits.append({a.name(): a.effort_limit() for a in actuators if not a.name().startswith("mast")})
    assert len(limits[0]) == 3
    assert limits[0] == pytest.approx(limits[1], rel=1e-5)


def test_cenic_drives_it_as_the_discrete_engine_does(sled):
    twin = TwinBuilder(engine="cenic", time_step=0.01).robot("sled", sled).build()
    assert driven(twin, twist(0.3, 0.2, 0.4)) == pytest.approx((0.3, 0.2, 0.4), abs=0.003)
