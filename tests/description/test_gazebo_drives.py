"""Gazebo's drive plugins as controllers: what Gazebo does with the same tags, by the plugins' sources."""

from math import atan, sin

import numpy as np
import pytest
from drive_harness import Driven
from urdf_text import parse_urdf

from drake_twin import TwinBuilder
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import read_controllers
from drake_twin.description.gazebo_drive import PLANAR_MOVE, Servo
from drake_twin.description.gazebo_drives import gazebo_drives
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_model import load_robot_model
from drake_twin.errors import InputError

WHEELS = ("fl", "fr", "rl", "rr", "steer_left", "steer_right")


def drives_of(content, filename, name="drive", joints=WHEELS):
    text = '<robot name="r"><link name="base_footprint"/>'
    for joint in joints:
        text += f'<link name="{joint}_link"/><joint name="{joint}" type="continuous"><axis xyz="0 1 0"/>'
        text += f'<parent link="base_footprint"/><child link="{joint}_link"/></joint>'
    text += f'<gazebo><plugin filename="{filename}" name="{name}">{content}</plugin></gazebo></robot>'
    return gazebo_drives(parse_urdf(text))


def drive_of(*arguments, **options):
    (drive,) = drives_of(*arguments, **options)
    if drive.controller is not None:
        check(drive)
    return drive


def check(drive):
    """The controller takes the parameters without a warning, and claims what the record says it needs."""
    cls = controller_class(drive.controller.type)
    if cls is None or drive.controller.type.startswith("joint_state"):
        return
    parameters, warnings = read_parameters(cls.Parameters, drive.controller)
    assert warnings == ()
    claims = cls.claimed_interfaces(parameters, None)
    assert tuple(map(str, claims)) == tuple("/".join(interface) for interface in drive.interfaces)


DIFF = "<left_joint>fl</left_joint><right_joint>fr</right_joint>"


def test_classic_diff_drive_with_everything_said():
    drive = drive_of(
        "<ros><namespace>n</namespace><remapping>odom:=odom/raw</remapping></ros><update_rate>30</update_rate>"
        "<num_wheel_pairs>2</num_wheel_pairs><left_joint>fl</left_joint><right_joint>fr</right_joint>"
        "<left_joint>rl</left_joint><right_joint>rr</right_joint>"
        "<wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter>"
        "<max_wheel_torque>20</max_wheel_torque><max_wheel_acceleration>1.5</max_wheel_acceleration>"
        "<odometry_frame>o</odometry_frame><robot_base_frame>b</robot_base_frame><odometry_source>0</odometry_source>"
        "<publish_odom>true</publish_odom><publish_odom_tf>1</publish_odom_tf><covariance_yaw>0.1</covariance_yaw>",
        "libgazebo_ros_diff_drive.so",
    )
    values = drive.controller.parameters
    assert (drive.controller.name, drive.controller.type) == ("drive", "diff_drive_controller/DiffDriveController")
    assert (values["left_wheel_names"], values["right_wheel_names"]) == (["fl", "rl"], ["fr", "rr"])
    assert (values["wheel_separation"], values["wheel_radius"], values["publish_rate"]) == (0.4, 0.1, 30.0)
    assert (values["odom_frame_id"], values["base_frame_id"], values["enable_odom_tf"]) == ("o", "b", True)
    assert values["pose_covariance_diagonal"] == [1e-5, 1e-5, 1e12, 1e12, 1e12, 0.1]
    assert drive.topics == {"cmd_vel_unstamped": "cmd_vel", "odom": "odom/raw"}
    assert drive.efforts == {"fl": 20.0, "rl": 20.0, "fr": 20.0, "rr": 20.0}
    assert not drive.true_odometry


def test_classic_diff_drives_defaults():
    drive = drive_of(DIFF, "libgazebo_ros_diff_drive.so")
    values = drive.controller.parameters
    assert (values["wheel_separation"], values["wheel_radius"], values["publish_rate"]) == (0.34, 0.075, 100.0)
    assert (values["base_frame_id"], values["enable_odom_tf"]) == ("base_footprint", False)
    assert drive.topics == {"cmd_vel_unstamped": "cmd_vel"}  # publish_odom is false
    assert drive.efforts == {"fl": 5.0, "fr": 5.0}
    assert drive.true_odometry


@pytest.mark.parametrize(
    ("content", "unread"),
    [
        ("<ros/><command_topic>cmd_vel</command_topic><odometry_topic>odom</odometry_topic>", ()),
        ("<publish_wheel_tf>false</publish_wheel_tf>", ()),
        ("<publish_wheel_tf>1</publish_wheel_tf>", ("publish_wheel_tf",)),
        ("<command_topic>drive</command_topic><ros><odd>1</odd></ros>", ("command_topic", "ros/odd")),
    ],
)
def test_what_a_diff_drive_does_anyway_is_not_unread(content, unread):
    assert set(drive_of(DIFF + content, "libgazebo_ros_diff_drive.so").unread) == set(unread)


def test_a_wheels_acceleration_limits_the_base():
    drive = drive_of(DIFF + "<max_wheel_acceleration>0.5</max_wheel_acceleration>", "libgazebo_ros_diff_drive.so")
    radius = drive.controller.parameters["wheel_radius"]
    for command in ({"x": 9.0}, {"z": 9.0}):
        dut = Driven(drive.controller.type, drive.controller.parameters)
        rims = dut.commands_while(0.04, **command) * radius
        np.testing.assert_allclose(np.abs(rims), np.outer([0.005, 0.01, 0.015, 0.02], [1, 1]))


def test_a_command_to_a_plugins_drive_holds_for_ever():
    drive = drive_of(DIFF, "libgazebo_ros_diff_drive.so")
    dut = Driven(drive.controller.type, drive.controller.parameters)
    dut.send(x=0.15)
    dut.advance(30.0)
    assert dut.commands == pytest.approx([2.0, 2.0])


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "<left_joint> is missing"),
        ("<left_joint>fl</left_joint><right_joint>nose</right_joint>", "the robot has no movable joint 'nose'"),
        (DIFF + "<left_joint>rl</left_joint>", "<num_wheel_pairs> is 1, but there are 2 left and 1 right joints"),
    ],
)
def test_a_plugin_that_does_not_work_in_gazebo_is_not_started(content, reason):
    drive = drive_of(content, "libgazebo_ros_diff_drive.so")
    assert drive.controller is None
    assert drive.not_started == f"drive (libgazebo_ros_diff_drive.so): {reason}"


def test_a_value_that_cannot_be_is_an_error():
    with pytest.raises(InputError, match="<wheel_diameter> is -1, which is not above zero"):
        drive_of(DIFF + "<wheel_diameter>-1</wheel_diameter>", "libgazebo_ros_diff_drive.so")


def test_gz_diff_drive_with_limits_topics_and_frames():
    drive = drive_of(
        DIFF + "<wheel_separation>0.16</wheel_separation><wheel_radius>0.033</wheel_radius>"
        "<min_velocity>-0.3</min_velocity><max_velocity>0.5</max_velocity><max_angular_velocity>2</max_angular_velocity>"
        "<max_linear_acceleration>1</max_linear_acceleration><odom_publish_frequency>30</odom_publish_frequency>"
        "<topic>cmd_vel</topic><odom_topic>/odom</odom_topic><tf_topic>/tf</tf_topic><frame_id>odom</frame_id>",
        "gz-sim-diff-drive-system",
        "gz::sim::systems::DiffDrive",
    )
    values = drive.controller.parameters
    assert drive.controller.name == "diff_drive"
    assert values["linear"]["x"] == {
        "min_velocity": -0.3,
        "max_velocity": 0.5,
        "max_acceleration_reverse": -np.inf,
        "max_acceleration": 1.0,
    }
    assert values["angular"]["z"] == {"min_velocity": -0.3, "max_velocity": 2.0}
    assert (values["publish_rate"], values["base_frame_id"]) == (30.0, "base_footprint")
    assert drive.topics == {"cmd_vel_unstamped": "cmd_vel", "odom": "odom"}
    assert drive.gz_topics == {"cmd_vel_unstamped": "cmd_vel", "odom": "/odom", "tf_odometry": "/tf"}


def test_where_gz_limits_one_direction_only_the_other_is_free():
    drive = drive_of(DIFF + "<max_acceleration>1</max_acceleration>", "gz-sim-diff-drive-system")
    dut = Driven(drive.controller.type, drive.controller.parameters)
    dut.commands_while(0.05, x=0.02)
    assert dut.commands == pytest.approx([0.1, 0.1])
    dut.commands_while(0.06, x=0.0)
    assert dut.commands == [0.0, 0.0]


def test_gz_topics_have_the_models_name_by_default():
    drive = drive_of(DIFF, "ignition-gazebo-diff-drive-system")
    assert drive.topics == {"cmd_vel_unstamped": "cmd_vel", "odom": "odometry"}
    assert drive.gz_topics["cmd_vel_unstamped"] == "/model/{model}/cmd_vel"


def test_gz_mecanum_drive():
    content = "<front_left_joint>fl</front_left_joint><front_right_joint>fr</front_right_joint>"
    content += "<back_left_joint>rl</back_left_joint><back_right_joint>rr</back_right_joint>"
    content += "<wheel_separation>0.4</wheel_separation><wheelbase>0.6</wheelbase><wheel_radius>0.1</wheel_radius>"
    drive = drive_of(content, "gz-sim-mecanum-drive-system")
    dut = Driven(drive.controller.type, drive.controller.parameters)
    dut.send(z=1.0)
    dut.advance(10.0)
    assert dut.commands == pytest.approx([-5.0, 5.0, 5.0, -5.0])
    assert drive.topics["reference_unstamped"] == "cmd_vel"


def test_gz_ackermann_steering_drives_the_wheels_that_are_not_steered():
    text = '<robot name="r"><link name="base"/>'
    for joint, parent in (
        ("steer_left", "base"),
        ("steer_right", "base"),
        ("fl", "steer_left_link"),
        ("fr", "steer_right_link"),
        ("rl", "base"),
        ("rr", "base"),
    ):
        text += f'<link name="{joint}_link"/><joint name="{joint}" type="continuous"><parent link="{parent}"/>'
        text += f'<child link="{joint}_link"/></joint>'
    text += '<gazebo><plugin filename="gz-sim-ackermann-steering-system" name="gz::sim::systems::AckermannSteering">'
    text += "<left_joint>fl</left_joint><left_joint>rl</left_joint><right_joint>fr</right_joint>"
    text += "<right_joint>rr</right_joint><left_steering_joint>steer_left</left_steering_joint>"
    text += "<right_steering_joint>steer_right</right_steering_joint><max_velocity>1</max_velocity>"
    text += "<steering_limit>0.5</steering_limit></plugin></gazebo></robot>"
    (drive,) = gazebo_drives(parse_urdf(text))
    check(drive)
    assert drive.interfaces == (
        ("rr", "velocity"),
        ("rl", "velocity"),
        ("steer_right", "position"),
        ("steer_left", "position"),
    )
    assert drive.warnings == (
        "of <right_joint> fr, rr the twin drives rr; the others roll",
        "of <left_joint> fl, rl the twin drives rl; the others roll",
    )
    dut = Driven(drive.controller.type, drive.controller.parameters)
    dut.commands_while(0.05, x=5.0, z=50.0)
    # gz: the smallest turning radius is wheel_base / sin(limit), with a kingpin width of 0.8 and a base of 1
    radius = 1.0 / sin(0.5)
    assert dut.commands[2:] == pytest.approx([atan(1 / (radius + 0.4)), atan(1 / (radius - 0.4))])
    assert dut.commands[:2] == pytest.approx([(1 + 0.5 / radius) / 0.2, (1 - 0.5 / radius) / 0.2])


def test_classic_ackermann_takes_its_geometry_from_the_model():
    text = '<robot name="r"><link name="base"/>'
    places = {"fl": (0.5, 0.3), "fr": (0.5, -0.3), "rl": (-0.4, 0.25), "rr": (-0.4, -0.25)}
    for name, (x, y) in places.items():
        parent = "base"
        if name.startswith("f"):
            parent = f"{name}_steering_link"
            text += f'<link name="{parent}"/><joint name="{name}_steering" type="continuous"><parent link="base"/>'
            text += f'<child link="{parent}"/><origin xyz="{x} {y} 0"/></joint>'
            x, y = 0, 0
        text += f'<link name="{name}_link"><collision><geometry><cylinder radius="0.15" length="0.1"/></geometry>'
        text += f'</collision></link><joint name="{name}" type="continuous"><parent link="{parent}"/>'
        text += f'<child link="{name}_link"/><origin xyz="{x} {y} 0" rpy="1.57 0 0"/></joint>'
    text += '<gazebo><plugin filename="libgazebo_ros_ackermann_drive.so" name="car">'
    for tag, joint in (("front_left", "fl"), ("front_right", "fr"), ("rear_left", "rl"), ("rear_right", "rr")):
        text += f"<{tag}_joint>{joint}</{tag}_joint>"
    text += "<left_steering_joint>fl_steering</left_steering_joint><max_steer>0.5</max_steer>"
    text += "<right_steering_joint>fr_steering</right_steering_joint></plugin></gazebo></robot>"
    (drive,) = gazebo_drives(parse_urdf(text))
    check(drive)
    values = drive.controller.parameters
    assert values["traction_wheels_radius"] == 0.15
    assert values["wheelbase"] == pytest.approx(0.9)
    assert values["traction_track_width"] == pytest.approx(0.5)
    assert values["steering_track_width"] == pytest.approx(0.6)
    dut = Driven(drive.controller.type, values)
    dut.send(z=0.9)  # an angle, as the plugin takes it
    dut.advance(0.005)
    dut.advance(0.015)
    assert np.tan(dut.commands[2:]) == pytest.approx([1 / (1 / np.tan(0.5) + 1 / 3), 1 / (1 / np.tan(0.5) - 1 / 3)])


def test_planar_move_commands_the_base():
    drive = drive_of("<publish_odom_tf>false</publish_odom_tf>", "libgazebo_ros_planar_move.so", "object_controller")
    assert (drive.controller.type, drive.controller.parameters["publish_rate"]) == (PLANAR_MOVE, 20.0)
    assert drive.interfaces[0] == ("base.linear.x", "velocity")
    assert drive.topics == {"cmd_vel_unstamped": "cmd_vel", "odom": "odom"}
    assert drive_of("<topic>twist</topic>", "gz-sim-velocity-control-system").topics == {"cmd_vel_unstamped": "twist"}


def test_joint_state_publishers_broadcast_their_joints():
    classic = drive_of(
        "<joint_name>fl</joint_name><update_rate>30</update_rate>", "libgazebo_ros_joint_state_publisher.so"
    )
    assert classic.controller.type == "joint_state_broadcaster/JointStateBroadcaster"
    assert classic.controller.parameters == {
        "joints": ["fl"],
        "interfaces": ["position", "velocity"],
        "update_rate": 30,
    }
    assert classic.topics == {"joint_states": "joint_states"}
    gz = drive_of("", "gz-sim-joint-state-publisher-system")
    assert gz.controller.parameters["joints"] == list(WHEELS)


@pytest.mark.parametrize(
    ("filename", "interface", "topic"),
    [
        ("gz-sim-joint-position-controller-system", "position", "joint/fl/0/cmd_pos"),
        ("gz-sim-joint-controller-system", "velocity", "joint/fl/cmd_vel"),
        ("gz-sim-apply-joint-force-system", "effort", "joint/fl/cmd_force"),
    ],
)
def test_joint_controllers_of_gz_are_joint_group_controllers_commanded_by_a_number(filename, interface, topic):
    drive = drive_of("<joint_name>fl</joint_name><i_gain>0</i_gain>", filename)
    assert drive.controller.type == f"{interface}_controllers/JointGroup{interface.title()}Controller"
    assert (drive.topics, drive.types) == ({"commands": topic}, {"commands": "std_msgs/msg/Float64"})
    assert drive.gz_topics == {"commands": f"/model/{{model}}/{topic}"}
    assert drive.interfaces == (("fl", interface),)
    named = drive_of(
        "<joint_name>fl</joint_name><topic>/lift</topic><initial_position>0.2</initial_position>", filename
    )
    assert named.topics == {"commands": "lift"}
    assert named.start == ({"fl": 0.2} if interface == "position" else {})


POSITIONS, VELOCITIES = "gz-sim-joint-position-controller-system", "gz-sim-joint-controller-system"


@pytest.mark.parametrize(
    ("filename", "inside", "servo", "efforts", "velocities"),
    [  # the defaults are those of JointPositionController.cc and JointController.cc
        (POSITIONS, "", Servo(1.0, 0.01), {"fl": 1000}, {}),
        (POSITIONS, "<p_gain>30</p_gain><d_gain>2</d_gain><cmd_max>5</cmd_max>", Servo(30, 2), {"fl": 5}, {}),
        (POSITIONS, "<cmd_max>20</cmd_max><cmd_min>-4</cmd_min>", Servo(1.0, 0.01), {"fl": 4}, {}),
        (POSITIONS, "<use_velocity_commands>1</use_velocity_commands><cmd_max>3</cmd_max>", Servo(), {}, {"fl": 3}),
        (VELOCITIES, "<use_force_commands>true</use_force_commands><p_gain>0.2</p_gain>", Servo(0.2), {"fl": 1000}, {}),
        (VELOCITIES, "", Servo(), {}, {}),
    ],
)
def test_joint_controllers_of_gz_have_their_own_servos(filename, inside, servo, efforts, velocities):
    drive = drive_of(f"<joint_name>fl</joint_name>{inside}", filename)
    assert list(drive.servos.values()) == [servo]
    assert (drive.efforts, drive.velocities) == (efforts, velocities)


@pytest.mark.parametrize(
    ("inside", "efforts", "warning"),
    [
        ("<cmd_min>1</cmd_min><cmd_max>-1</cmd_max>", {}, None),  # an empty range is no limit to gz-math
        ("<cmd_min>0</cmd_min><cmd_max>10</cmd_max>", {"fl": 10}, "efforts from 0 to 10 are limited to 10"),
    ],
)
def test_the_range_of_a_pid_limits_its_effort(inside, efforts, warning):
    drive = drive_of(f"<joint_name>fl</joint_name><i_gain>0</i_gain>{inside}", POSITIONS)
    assert drive.efforts == efforts
    assert [each[: len(warning or "")] for each in drive.warnings] == ([] if warning is None else [warning])


@pytest.mark.parametrize(
    ("inside", "reason"),
    [
        ("<p_gain>-5</p_gain>", "gains are -5 and 0.01"),
        ("<cmd_min>0</cmd_min><cmd_max>0</cmd_max>", "range of efforts is zero"),
        ("<use_velocity_commands>1</use_velocity_commands><cmd_max>-1</cmd_max>", "<cmd_max> is -1"),
    ],
)
def test_a_plugin_that_would_do_harm_is_not_started(inside, reason):
    assert reason in drive_of(f"<joint_name>fl</joint_name>{inside}", POSITIONS).not_started


def test_a_trajectory_controller_of_gz_has_gains_for_each_joint():
    drive = drive_of(
        "<topic>arm/trajectory</topic><joint_name>fl</joint_name><position_p_gain>10</position_p_gain>"
        "<position_d_gain>1</position_d_gain><position_cmd_max>5</position_cmd_max>"
        "<joint_name>fr</joint_name><position_p_gain>20</position_p_gain><velocity_p_gain>3</velocity_p_gain>"
        "<initial_position>0.3</initial_position><position_i_gain>0.5</position_i_gain>",
        "gz-sim-joint-trajectory-controller-system",
    )
    assert drive.controller.type == "joint_trajectory_controller/JointTrajectoryController"
    assert drive.topics == {"joint_trajectory": "arm/trajectory"}
    assert drive.servos == {("fl", "position"): Servo(10, 4), ("fr", "position"): Servo(20, 0)}
    assert (drive.efforts, drive.start) == ({"fl": 5}, {"fl": 0.3})
    assert drive.warnings == ("<position_i_gain> is not simulated",)


@pytest.mark.parametrize(
    ("filename", "interface", "default"),
    [(POSITIONS, "position", "joint/fl/0/cmd_pos"), (VELOCITIES, "velocity", "joint/fl/cmd_vel")],
)
def test_joint_controllers_of_gz_may_be_commanded_by_an_element_of_actuators(filename, interface, default):
    asked = "<joint_name>fl</joint_name><use_actuator_msg>true</use_actuator_msg>"
    numbered = f"{asked}<actuator_number>3</actuator_number>"
    drive = drive_of(numbered, filename)
    assert drive.types == {"commands": "actuator_msgs/msg/Actuators"}
    assert drive.elements == {"commands": (interface, 3)}
    assert (drive.topics, drive.gz_topics) == ({"commands": "actuators"}, {"commands": "/actuators"})
    below = drive_of(f"{numbered}<sub_topic>command/motors</sub_topic>", filename)
    assert below.gz_topics == {"commands": "/model/{model}/command/motors"}
    assert drive_of(f"{numbered}<topic>/motors</topic>", filename).gz_topics == {"commands": "/motors"}
    without = drive_of(asked, filename)
    assert without.topics == {"commands": default}
    assert "<use_actuator_msg> without <actuator_number>" in without.warnings[0]
    negative = drive_of(f"{asked}<actuator_number>-1</actuator_number>", filename)
    assert "<actuator_number> is -1, which is not an index" in negative.not_started


def test_a_joint_controller_may_begin_with_a_velocity():
    asked = "<joint_name>fl</joint_name><joint_name>fr</joint_name>"
    drive = drive_of(f"{asked}<initial_velocity>-3</initial_velocity>", VELOCITIES)
    assert drive.controller.type == "gz_sim/JointController"
    assert drive.controller.parameters == {"joints": ["fl", "fr"], "initial_velocity": -3.0}
    assert drive_of(asked, VELOCITIES).controller.type == "velocity_controllers/JointGroupVelocityController"


def test_a_pid_with_an_integral_part_or_an_offset_has_a_controller_of_it():
    drive = drive_of("<joint_name>fl</joint_name><i_max>3</i_max>", POSITIONS)
    assert (drive.controller.type, drive.warnings) == ("gz_sim/JointPidController", ())
    assert drive.controller.parameters == {
        "joints": ["fl"],
        "interface": "position",
        "i_gain": 0.1,  # JointPositionController.cc's default
        "i_max": 3.0,
        "i_min": -1.0,
        "cmd_offset": 0.0,
        "update_rate": 10,
    }
    fast = drive_of("<joint_name>fl</joint_name><p_gain>4</p_gain><i_gain>2</i_gain>", POSITIONS)
    assert fast.controller.parameters["update_rate"] == 50
    force = "<joint_name>fl</joint_name><use_force_commands>1</use_force_commands>"
    plain, more = (drive_of(force + inside, VELOCITIES) for inside in ("", "<cmd_offset>2</cmd_offset>"))
    assert plain.controller.type == "velocity_controllers/JointGroupVelocityController"
    assert (more.controller.parameters["interface"], more.controller.parameters["cmd_offset"]) == ("velocity", 2.0)
    assert drive_of(f"{force}<d_gain>0.5</d_gain>", VELOCITIES).warnings == ("<d_gain> of 0.5 is not simulated",)


def test_several_plugins_of_a_kind_have_names_of_their_own_and_other_plugins_are_left_out():
    text = '<robot name="r"><link name="b"/><link name="l"/><joint name="j" type="continuous"><parent link="b"/>'
    text += '<child link="l"/></joint><gazebo>'
    for _ in range(2):
        text += '<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">'
        text += "<joint_name>j</joint_name></plugin>"
    text += '<plugin filename="libgazebo_ros_camera.so" name="camera"/></gazebo></robot>'
    assert [drive.controller.name for drive in gazebo_drives(parse_urdf(text))] == [
        "joint_controller",
        "joint_controller_2",
    ]


def test_an_sdf_models_plugins_count_too(tmp_path):
    file = tmp_path / "model.sdf"
    inertial = "<inertial><mass>1</mass></inertial>"
    file.write_text(
        f'<sdf version="1.8"><model name="m"><link name="base">{inertial}</link>'
        + "".join(
            f'<link name="{side}_link">{inertial}</link><joint name="{side}" type="revolute"><parent>base</parent>'
            f"<child>{side}_link</child><axis><xyz>0 1 0</xyz></axis></joint>"
            for side in ("left", "right")
        )
        + '<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">\n'
        "<left_joint>left</left_joint><right_joint>right</right_joint></plugin></model></sdf>"
    )
    (drive,) = gazebo_drives(load_robot_model(str(file), PackageIndex()).description)
    check(drive)
    assert drive.interfaces == (("left", "velocity"), ("right", "velocity"))


@pytest.mark.parametrize(
    ("robot", "arguments", "types"),
    [
        (
            "cadre_demos/cadre_demo/robot_description/robot/robot.xacro",
            {"robot_name": "rover"},
            ["joint_state_broadcaster/JointStateBroadcaster", "diff_drive_controller/DiffDriveController"],
        ),
        (
            "linorobot2/linorobot2_description/urdf/robots/2wd.urdf.xacro",
            {},
            ["diff_drive_controller/DiffDriveController"],
        ),
        (
            "linorobot2/linorobot2_description/urdf/robots/4wd.urdf.xacro",
            {},
            ["diff_drive_controller/DiffDriveController"],
        ),
        ("linorobot2/linorobot2_description/urdf/robots/mecanum.urdf.xacro", {}, [PLANAR_MOVE]),
    ],
)
def test_robots_of_the_corpus_that_only_plugins_drive(corpus, robot, arguments, types):
    model = load_robot_model(str(corpus / robot), PackageIndex([corpus]), xacro_args=arguments)
    drives = gazebo_drives(model.description)
    assert [drive.controller.type for drive in drives] == types
    for drive in drives:
        check(drive)
        assert drive.topics.get("cmd_vel_unstamped", "cmd_vel") == "cmd_vel"


@pytest.mark.parametrize(
    "file",
    [
        "bumperbot/Section12_Build_the_Robot/bumperbot_ws/src/bumperbot_controller/config/bumperbot_controllers.yaml",
        "forklift_one/config/forklift_controllers.yaml",
        "gazebo_ros2_control/gazebo_ros2_control_demos/config/diff_drive_controller.yaml",
        "gz_ros2_control/gz_ros2_control_demos/config/ackermann_drive_controller.yaml",
        "gz_ros2_control/gz_ros2_control_demos/config/diff_drive_controller_velocity.yaml",
        "gz_ros2_control/gz_ros2_control_demos/config/tricycle_drive_controller.yaml",
        "ros2_control_demos/example_11/bringup/config/carlikebot_controllers.yaml",
        "ros2_control_demos/example_16/bringup/config/diffbot_chained_controllers.yaml",
        "ros2_control_demos/example_2/bringup/config/diffbot_controllers.yaml",
        "rosbot_xl_ros/rosbot_xl_controller/config/diff_drive_controller.yaml",
    ],
)
def test_parameters_of_the_corpus_load(corpus, file):
    drives = [
        (controller, cls)
        for controller in read_controllers(corpus / file, "/robot_1", {}).controllers
        if (cls := controller_class(controller.type)) is not None and hasattr(cls.Parameters, "base_frame_id")
    ]
    assert drives
    for controller, cls in drives:
        parameters, _ = read_parameters(cls.Parameters, controller)
        assert cls.claimed_interfaces(parameters, None)


@pytest.mark.parametrize(("text", "true"), [("world", True), ("encoder", False), ("1", True), ("0", False)])
def test_the_source_of_odometry_may_be_a_word_of_ros_1(text, true):
    content = f"{DIFF}<odometry_source>{text}</odometry_source>"
    drive = drive_of(content, "libgazebo_ros_diff_drive.so")
    assert drive.true_odometry is true
    assert bool(drive.warnings) is not text.isdigit()


def test_two_drives_of_one_robot_hear_one_topic_and_their_transforms_collide(tmp_path):
    """The idiom for four wheels: a plugin for the front wheels and one for those at the back."""
    wheels, drives = "", ""
    for place, x in (("front", 0.15), ("back", -0.15)):
        for side, y in (("left", 0.2), ("right", -0.2)):
            wheels += f'''<link name="{place}_{side}"><inertial><mass value="0.5"/>
            <inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial><collision>
            <origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
            <joint name="{place}_{side}_joint" type="continuous"><parent link="base_link"/>
            <child link="{place}_{side}"/><origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/></joint>'''
        drives += f'''<plugin name="{place}" filename="libgazebo_ros_diff_drive.so">
        <left_joint>{place}_left_joint</left_joint><right_joint>{place}_right_joint</right_joint>
        <wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter><publish_odom_tf>true</publish_odom_tf>
        <robot_base_frame>base_link</robot_base_frame></plugin>'''
    base = """<link name="base_link"><inertial><mass value="10"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    file = tmp_path / "four.urdf"
    file.write_text(f'<robot name="four">{base}{wheels}<gazebo>{drives}</gazebo></robot>')
    twin = TwinBuilder().robot("four", str(file), xyz=(0, 0, 0.1), namespace="/").build()
    twin.publish("/cmd_vel", {"linear": {"x": 0.5}})
    twin.advance_to(2.0)
    assert twin.robot_state("four").base_pose[0] == pytest.approx(1.0, abs=0.03)
    (finding,) = [item for item in twin.findings if "/tf" in item.what]
    assert finding.what == "controllers front and back both publish the pose of 'four/base_link' on /tf"


@pytest.mark.parametrize("text", ["", " ", "1.5"])
def test_a_number_that_is_empty_is_not_read_and_said(text):
    drive = drive_of(f"{DIFF}<max_wheel_acceleration>{text}</max_wheel_acceleration>", "libgazebo_ros_diff_drive.so")
    assert drive.unread == (() if text == "1.5" else ("max_wheel_acceleration",))
