"""Launch files as scenarios: worlds, frames, bridges, commands, and what is not started."""

from pathlib import Path

import pytest
from hinge import command, create, gz, hinge, launched, launched_hinge, node, publisher, spawner, write_hinge
from launch_files import not_started, write, write_python

from drake_twin.builder.launch_file import launch_description_scenario, launch_file_scenario
from drake_twin.description.package_index import share_folder
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.twin import Twin

MODELS = share_folder("models")
MAIN = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"


@pytest.fixture(scope="module")
def rovers():
    return launch_file_scenario(MAIN)


def test_the_rovers_topics_are_what_ros_would_name_them(rovers):
    topics = Twin(rovers.scenario).graph.topics()
    expected = {"/clock", "/tf", "/tf_static", "/model_states", "/link_states"}
    expected |= {"/rosout", "/parameter_events", "/diagnostics"}
    for name in ("/robot_1", "/robot_2"):
        expected |= {
            f"{name}/joint_states",
            f"{name}/dynamic_joint_states",
            f"{name}/forward_velocity_controller/commands",
            f"{name}/drive_controller/cmd_vel",
            f"{name}/drive_controller/odom",
            f"{name}_robot_description",
            f"{name}/ground_truth/odom",
        }
    assert set(topics) == expected
    assert not_started(rovers.scenario) == ()
    assert (rovers.paused, rovers.only_displayed, rovers.log) == (False, False, ())


def test_a_chain_of_spawners_is_active_at_time_zero(rovers):
    twin = Twin(rovers.scenario)
    for robot in twin.robots:
        states = [(item.name, item.state) for item in twin.control.manager(robot).list_controllers()]
        assert states == [
            ("joint_state_broadcaster", "active"),
            ("forward_velocity_controller", "active"),
            ("drive_controller", "inactive"),
        ]
    assert (twin.time, twin.latest("/robot_2/joint_states").name[0]) == (0, "robot_2_front_left_wheel_joint")


def test_the_rovers_stand_where_they_are_spawned_and_their_frames_hang_on_odom(rovers):
    assert [robot.xyz for robot in rovers.scenario.robots] == [(0, 0, 0.13), (0, 2, 0.13)]
    assert Path(rovers.scenario.world.file).samefile(MODELS / "rover_gazebo" / "worlds" / "plain.sdf")
    static = {
        item.child_frame_id: item.header.frame_id for item in Twin(rovers.scenario).latest("/tf_static").transforms
    }
    assert (static["robot_1_odom"], static["robot_2_odom"]) == ("world", "world")


def test_the_scenario_is_read_back_equal(rovers, tmp_path):
    text = scenario_to_yaml(rovers.scenario)
    assert ScenarioFile(text, tmp_path / "twin.yaml").scenario == rovers.scenario


def test_a_launch_description_in_plain_python_is_the_same(tmp_path):
    from drake_twin.launch import LaunchDescription, Node

    text = write_hinge(tmp_path).read_text()
    description = LaunchDescription(
        [
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": text}],
            ),
            Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
            Node(package="controller_manager", executable="spawner", arguments=["velocity"]),
        ]
    )
    written = launched_hinge(tmp_path, spawner("velocity"))
    assert launch_description_scenario(description).scenario.robots == written.scenario.robots


# --- worlds


@pytest.mark.parametrize(
    ("entities", "file", "paused"),
    [
        (gz("-r empty.sdf"), "empty.sdf", False),
        (gz("empty.sdf"), "empty.sdf", True),
        (gz("-r -s empty.sdf") + gz("-g -v4"), "empty.sdf", False),  # a server, and a window on it
        (gz("-s empty.sdf") + gz("-g"), "empty.sdf", True),
        (command("gz", "sim", "-r", "empty.sdf"), "empty.sdf", False),
        (command("ign gazebo -v 4 empty.sdf", shell=True), "empty.sdf", True),
        (command("gzserver", "--verbose", "-s", "libgazebo_ros_init.so", "empty.world"), "empty.world", False),
        (command("gazebo", "--pause", "empty.world") + command("gzclient"), "empty.world", True),
        (command("gzserver") + command("gzclient"), "empty.world", False),  # its own
        (command("gz", "sim", "-r"), None, False),
        ("", None, False),
    ],
)
def test_every_way_to_start_a_world(tmp_path, entities, file, paused):
    launch = launched_hinge(tmp_path, entities)
    assert (launch.scenario.world.file, launch.paused) == (file, paused)
    assert not_started(launch.scenario) == ()


def test_the_worlds_step_is_the_scenarios_unless_one_is_given(tmp_path):
    world = write(
        tmp_path / "quick.sdf",
        '<sdf version="1.9"><world name="w"><physics type="ode"><max_step_size>0.002</max_step_size></physics></world>'
        "</sdf>",
    )
    launch = launched_hinge(tmp_path, gz(f"-r {world}"))
    assert (launch.scenario.world.file, launch.scenario.time_step) == (str(world), 0.002)
    again = launch_file_scenario(tmp_path / "test.launch.py", time_step=0.004)
    assert again.scenario.time_step == 0.004


def test_a_world_file_that_is_missing_is_named_and_the_robot_stands_on_the_ground(tmp_path):
    launch = launched_hinge(tmp_path, gz(f"-r {tmp_path}/gone.sdf"))
    assert launch.scenario.world.file is None
    (reason,) = not_started(launch.scenario)
    assert reason.startswith(f"world {tmp_path}/gone.sdf: ")
    assert "does not exist, and of Gazebo's own worlds only some are built in" in reason


# --- frames


@pytest.mark.parametrize("form", [("0", "0", "1", "0", "0", "0"), ("0", "0", "1", "0", "0", "0", "1")])
def test_static_frames_reach_tf_static(tmp_path, form):
    launch = launched_hinge(tmp_path, node("tf2_ros", "static_transform_publisher", *form, "map", "world"))
    transforms = {item.child_frame_id: item for item in Twin(launch.scenario).latest("/tf_static").transforms}
    assert (transforms["world"].header.frame_id, transforms["world"].transform.translation.z) == ("map", 1)


@pytest.mark.parametrize(
    ("parent", "child", "reason"),
    [
        ("world", "base", "frame 'base': its parent is 'world' already"),  # as its URDF says
        ("odom", "arm", "frame 'arm': its parent is 'base' already"),
        ("arm", "world", "frame 'world': it would be its own ancestor"),
        ("a", "a", "frame 'a': it would be its own ancestor"),
        ("b", "camera", "frame 'camera': its parent is 'arm' already"),
    ],
)
def test_a_frame_that_has_a_parent_is_left_out_and_the_robot_runs(tmp_path, parent, child, reason):
    entities = [
        node("tf2_ros", "static_transform_publisher", "--frame-id", "arm", "--child-frame-id", "camera"),
        node("tf2_ros", "static_transform_publisher", "--frame-id", parent, "--child-frame-id", child),
    ]
    launch = launched_hinge(tmp_path, *entities)
    assert not_started(launch.scenario) == (f"tf2_ros/static_transform_publisher ({reason})",)
    assert [item.child for item in launch.scenario.static_transforms] == ["camera"]
    assert "/tf" in Twin(launch.scenario).graph.topics()


def test_a_frame_publisher_with_both_forms_is_named_with_its_line(tmp_path):
    words = ("0", "0", "0", "0", "0", "0", "a", "b", "--x", "1")
    (reason,) = not_started(launched_hinge(tmp_path, node("tf2_ros", "static_transform_publisher", *words)).scenario)
    assert reason.startswith(f"tf2_ros/static_transform_publisher: {tmp_path}/test.launch.py:")
    assert "the old form of arguments (numbers and frames) and the new one" in reason


# --- bridges


def cart(name):
    """A free robot with two wheels that Gazebo's own plugin drives."""
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    wheels = "".join(
        f'<link name="{name}_{side}">{body}{shape}</link><joint name="{name}_{side}_joint" type="continuous"><parent'
        f' link="{name}_base"/><child link="{name}_{side}"/><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/></joint>'
        for side, y in (("left", 0.3), ("right", -0.3))
    )
    return (
        f'<robot name="{name}"><link name="{name}_base">{body}</link>{wheels}<gazebo><plugin'
        ' filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">'
        f"<left_joint>{name}_left_joint</left_joint><right_joint>{name}_right_joint</right_joint>"
        "<wheel_separation>0.6</wheel_separation><wheel_radius>0.1</wheel_radius></plugin></gazebo></robot>"
    )


def test_one_bridge_names_the_topics_of_two_robots(tmp_path):
    carts = [
        create("-file", write(tmp_path / f"{name}.urdf", cart(name)), "-name", name, "-y", y)
        for name, y in (("a", 0), ("b", 3))
    ]
    words = [
        f"/model/{name}/{topic}"
        for name in ("a", "b")
        for topic in (
            "cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist",
            "odometry@nav_msgs/msg/Odometry[gz.msgs.Odometry",
        )
    ]
    remappings = [
        (f"/model/{name}/{gz_name}", f"/{name}/{ros_name}")
        for name in ("a", "b")
        for gz_name, ros_name in (("cmd_vel", "cmd_vel"), ("odometry", "odom"))
    ]
    launch = launched(tmp_path, *carts, node("ros_gz_bridge", "parameter_bridge", *words, remappings=remappings))
    topics = Twin(launch.scenario).graph.topics()
    assert {"/a/cmd_vel", "/a/odom", "/b/cmd_vel", "/b/odom"} <= set(topics)
    assert not [topic for topic in topics if topic.startswith("/model/")]
    assert not_started(launch.scenario) == ()


def test_a_bridge_without_remappings_carries_gazebos_names(tmp_path):
    words = ["/model/a/cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist", "/model/a/odometry@nav_msgs/msg/Odometry[x"]
    spawn = create("-file", write(tmp_path / "a.urdf", cart("a")), "-name", "a")
    topics = Twin(launched(tmp_path, spawn, node("ros_gz_bridge", "parameter_bridge", *words)).scenario).graph.topics()
    assert {"/model/a/cmd_vel", "/model/a/odometry"} < topics.keys()
    assert not topics.keys() & {"/cmd_vel", "/a/cmd_vel"}


def test_a_parameters_file_that_is_gone_is_refused_with_the_line_that_starts_the_robot(tmp_path):
    write_hinge(tmp_path)
    entities = [publisher(tmp_path / "hinge.urdf"), node("controller_manager", "ros2_control_node")]
    entities[1] = entities[1].replace("Node(", "Node(parameters=['/gone/c.yaml'], ", 1)
    with pytest.raises(InputError, match=rf"^{tmp_path}/\S+\.py:\d+: .*/gone/c.yaml"):
        launched(tmp_path, *entities)


@pytest.mark.parametrize(("topic", "told"), [("cmd_vel", 0), ("cmd_vell", 1), ("battery", 0)])
def test_a_topic_of_a_bridge_that_is_nearly_a_drives_is_a_finding(tmp_path, topic, told):
    spawned = create("-file", write(tmp_path / "a.urdf", cart("a")), "-name", "a")
    bridge = node("ros_gz_bridge", "parameter_bridge", f"/model/a/{topic}@geometry_msgs/msg/Twist]gz.msgs.Twist")
    found = launched(tmp_path, spawned, bridge).scenario.findings
    what = f"the bridge carries /model/a/{topic}, which nothing has in Gazebo. Did you mean '/model/a/cmd_vel'?"
    assert [item.what for item in found if "nothing has" in item.what] == [what] * told


@pytest.mark.parametrize(
    ("kind", "close"),
    [
        ("nav_msgs/msg/Oddometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs/msg/Odometry", ""),
        ("own_msgs/msg/Thing", ""),
        ("ros_gz_interfaces/msg/Contact", ""),
    ],
)
def test_a_type_of_a_bridge_that_is_nearly_one_of_ros_is_a_finding(tmp_path, kind, close):
    spawned = create("-file", write(tmp_path / "a.urdf", cart("a")), "-name", "a")
    bridge = node("ros_gz_bridge", "parameter_bridge", f"/model/a/odometry@{kind}[gz.msgs.Odometry")
    found = launched(tmp_path, spawned, bridge).scenario.findings
    what = f"ros_gz_bridge/parameter_bridge: unknown type {kind!r} of /model/a/odometry. Did you mean {close!r}?"
    told = [(item.what, item.kind, bool(item.lines)) for item in found if "unknown type" in item.what]
    assert told == ([(what, Kind.REFUSED_BY_ROS, True)] if close else [])


@pytest.mark.parametrize(
    ("package", "executable", "close"),
    [
        ("robot_sate_publisher", "robot_state_publisher", "robot_state_publisher"),
        ("tf2_rs", "static_transform_publisher", "tf2_ros"),
        ("my_robot", "robot_state_publisher", ""),
        ("tf2_ros", "static_transform_publisher", ""),
    ],
)
def test_a_package_that_is_nearly_that_of_its_executable_is_a_finding(tmp_path, package, executable, close):
    words = ("0", "0", "0", "0", "0", "0", "a", "b") if "static" in executable else ()
    found = launched_hinge(tmp_path, node(package, executable, *words)).scenario.findings
    what = f"{package}/{executable}: unknown package {package!r}. Did you mean {close!r}?"
    assert [item.what for item in found if "unknown package" in item.what] == ([what] if close else [])


def test_a_bridges_file_names_topics_too(tmp_path):
    file = write(
        tmp_path / "bridge.yaml",
        '- {ros_topic_name: "drive", gz_topic_name: "/model/a/cmd_vel", ros_type_name: x, gz_type_name: y}\n',
    )
    entities = [
        create("-file", write(tmp_path / "a.urdf", cart("a")), "-name", "a"),
        node("ros_gz_bridge", "parameter_bridge", namespace="sim", parameters=[{"config_file": str(file)}]),
    ]
    assert "/sim/drive" in Twin(launched(tmp_path, *entities).scenario).graph.topics()


def test_a_bridges_file_that_something_else_would_write_is_not_said_to_be_refused(tmp_path):
    bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(tmp_path / "later.yaml")}])
    scenario = launched_hinge(tmp_path, bridge).scenario
    assert not_started(scenario) == (
        f"ros_gz_bridge/parameter_bridge: its config_file {tmp_path / 'later.yaml'} does not exist",
    )
    assert not_started(scenario, Kind.REFUSED_BY_ROS) == ()


def test_spawn_names_with_slashes_are_robots_of_their_own(tmp_path):
    file = write_hinge(tmp_path)
    spawns = [create("-file", file, "-name", name) for name in ("team/r", "team_r", "other/r")]
    assert [robot.name for robot in launched(tmp_path, *spawns).scenario.robots] == ["team_r", "team_r_1", "other_r"]


@pytest.mark.parametrize("form", ["arguments", "file"])
def test_a_drive_listens_to_stamped_messages_where_the_bridge_has_them(tmp_path, form):
    if form == "file":
        entry = '- {topic_name: "/model/a/cmd_vel", ros_type_name: geometry_msgs/msg/TwistStamped, gz_type_name: y}'
        options = {"parameters": [{"config_file": str(write(tmp_path / "bridge.yaml", entry))}]}
        words = []
    else:
        options, words = {}, ["/model/a/cmd_vel@geometry_msgs/msg/TwistStamped]gz.msgs.Twist"]
    spawn = create("-file", write(tmp_path / "a.urdf", cart("a")), "-name", "a", "-z", 0.1)
    twin = Twin(launched(tmp_path, spawn, node("ros_gz_bridge", "parameter_bridge", *words, **options)).scenario)
    (topic,) = [name for name, kind in twin.graph.topics().items() if kind == "geometry_msgs/msg/TwistStamped"]
    assert topic.endswith("cmd_vel")
    assert "geometry_msgs/msg/Twist" not in twin.graph.topics().values()
    twin.publish(topic, {"twist": {"linear": {"x": 0.5}}})
    twin.advance_to(0.5)
    assert max(map(abs, twin.robot_state("a").velocities)) > 0.5


# --- what is not started


def test_what_the_twin_does_not_do_is_listed_once_with_its_reason(tmp_path):
    entities = [
        node("rviz2", "rviz2"),
        node("foo", "bar"),
        node("foo", "bar"),
        node("joint_state_publisher", "joint_state_publisher"),
        node("slam_toolbox", "async_slam_toolbox_node"),
        command("ls"),
    ]
    scenario = launched_hinge(tmp_path, *entities).scenario
    mapping = "mapping is not a part of the twin: /map and the transform from map to odom will be missing"
    assert not_started(scenario, Kind.WINDOW) == ("rviz2/rviz2 (the page shows the robots)",)
    assert not_started(scenario) == (
        "foo/bar (it is not a Python program of the workspace: publish its messages by --pub, or run a node by --node)",
        "joint_state_publisher/joint_state_publisher (joint states come from the simulation)",
        f"slam_toolbox/async_slam_toolbox_node ({mapping})",
        "ls (of programs, the twin starts only Python nodes)",
    )


def test_an_executable_that_is_nearly_a_known_one_suggests_it(tmp_path):
    (reason,) = not_started(launched_hinge(tmp_path, node("ros_gz_sim", "creat")).scenario)
    assert reason == "ros_gz_sim/creat ('creat' of ros_gz_sim is unknown; did you mean 'create'?)"


def test_arguments_handlers_and_includes_that_come_to_nothing_are_listed(tmp_path):
    file = write_python(
        tmp_path / "test.launch.py",
        publisher(write_hinge(tmp_path))
        + create("-topic", "robot_description")
        + """IncludeLaunchDescription(os.path.join(get_package_share_directory('absent_pkg'), 'launch', 'x.launch.py')),
        RegisterEventHandler(OnProcessExit(target_action=never, on_exit=[LogInfo(msg='x')])),""",
        "never = Node(package='rviz2', executable='rviz2')",
    )
    launch = launch_file_scenario(file, {"robot_nmae": "x"})
    text = "\n".join(not_started(launch.scenario))
    assert "include " in text
    assert "absent_pkg" in text
    assert "never happens" in text
    assert "argument robot_nmae (no file declares it)" in text


def test_a_spawn_after_a_while_is_there_from_the_start_and_that_is_said(tmp_path):
    create_later = f"TimerAction(period=3.0, actions=[{create('-topic', 'robot_description')}]),"
    launch = launched(tmp_path, publisher(write_hinge(tmp_path)), create_later)
    assert launch.log == ("hinge: it is spawned after 3 s in ROS, but at the start here",)


def test_a_finding_about_a_robot_that_xacro_made_for_a_launch_file_has_xacros_file_and_line(tmp_path):
    text = hinge(extra="\n<transmission/>").replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1)
    robot = write(tmp_path / "hinge.urdf.xacro", text)
    launch = f"""<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="robot_description" value="$(command 'xacro {robot}')"/></node>
<node pkg="ros_gz_sim" exec="create" args="-topic robot_description -name arm"/></launch>"""
    twin = Twin(launch_file_scenario(write(tmp_path / "arm.launch.xml", launch)).scenario)
    (finding,) = (item for item in twin.findings if "transmission" in item.what)
    line = text.splitlines().index("<transmission/></robot>") + 1
    assert (finding.robot, finding.file, finding.lines) == ("arm", str(robot), (line,))


def test_a_description_that_was_left_half_written_in_the_cache_is_written_again(tmp_path):
    launch = launched_hinge(tmp_path)
    (robot,) = launch.scenario.robots
    whole = Path(robot.model).read_text()
    Path(robot.model).write_text(whole[:200])
    assert launched_hinge(tmp_path).scenario == launch.scenario
    assert Path(robot.model).read_text() == whole
