import pytest
from launch_files import launch_python, launch_xml

from drake_twin.errors import InputError
from drake_twin.ros2.built_in_packages import world_of_gz_args


def world(folder, package, launch_file, **arguments):
    pairs = "".join(f'<arg name="{name}" value="{value}"/>' for name, value in arguments.items())
    launched = launch_xml(folder, f'<include file="$(find-pkg-share {package})/launch/{launch_file}">{pairs}</include>')
    return launched.processes[0]


@pytest.mark.parametrize(
    ("gz_args", "expected"),
    [
        ("", (None, True)),
        ("empty.sdf", ("empty.sdf", True)),
        (" -v 4 -r empty.sdf ", ("empty.sdf", False)),
        ("-r -s -v4 /a/b.sdf", ("/a/b.sdf", False)),
        ("-rs w.sdf --physics-engine x", ("w.sdf", False)),
        ("-v -r w.sdf", ("w.sdf", False)),
        ("-r --verbose=2 -z 100 w.sdf --headless-rendering", ("w.sdf", False)),
    ],
)
def test_what_gz_is_asked_for(gz_args, expected):
    start = world_of_gz_args(gz_args)
    assert (start.world, start.paused) == expected


@pytest.mark.parametrize(
    ("package", "file"), [("ros_gz_sim", "gz_sim.launch.py"), ("ros_ign_gazebo", "ign_gazebo.launch.py")]
)
def test_including_gz_starts_a_world(tmp_path, package, file):
    process = world(tmp_path, package, file, gz_args="-r empty.sdf", unrelated="x")
    assert (process.kind, process.what) == ("world", f"{package}/{file}")
    assert (process.world.simulator, process.world.world, process.world.paused) == ("gz", "empty.sdf", False)
    assert process.world.arguments["gz_args"] == "-r empty.sdf"
    assert "unrelated" not in process.world.arguments


def test_including_classic_gazebo_starts_a_world(tmp_path):
    process = world(
        tmp_path, "gazebo_ros", "gazebo.launch.py", world="/w.world", pause="true", gui="false", verbose="true"
    )
    start = process.world
    assert (start.simulator, start.world, start.paused) == ("classic", "/w.world", True)
    assert world(tmp_path, "gazebo_ros", "gzserver.launch.py").world.world is None


def test_a_window_alone_starts_nothing(tmp_path):
    assert (
        launch_xml(tmp_path, '<include file="$(find-pkg-share gazebo_ros)/launch/gzclient.launch.py"/>').processes == ()
    )


def test_a_launch_argument_of_the_same_name_reaches_the_world_as_in_ros(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<arg name="world" default="/mine.world"/>
        <include file="$(find-pkg-share gazebo_ros)/launch/gazebo.launch.py"/>""",
    )
    assert launched.processes[0].world.world == "/mine.world"


def test_spawning_through_a_launch_file_is_a_create_node(tmp_path):
    process = world(
        tmp_path, "ros_gz_sim", "gz_spawn_model.launch.py", file="/r.sdf", entity_name="r", x="1.5", yaw="2"
    )
    assert process.what == "ros_gz_sim/create"
    assert process.arguments == ("-file", "/r.sdf", "-name", "r", "-x", "1.5", "-Y", "2", "-allow_renaming=false")
    assert process.ends


def test_actions_of_ros_gz_sim(tmp_path):
    launched = launch_python(
        tmp_path,
        "GzServer(world_sdf_file=LaunchConfiguration('w')), RosGzBridge(bridge_name='b', config_file='/c.yaml'),"
        "LogInfo(msg=LaunchConfiguration('bridge_name', default='no trace'))",
        "from ros_gz_sim.actions import GzServer\nfrom ros_gz_bridge.actions import RosGzBridge",
        w="/w.sdf",
    )
    server, bridge = launched.processes
    assert server.world.world == "/w.sdf"
    assert (bridge.what, bridge.name, bridge.parameters) == (
        "ros_gz_bridge/parameter_bridge",
        "b",
        ({"config_file": "/c.yaml"},),
    )
    assert launched.log == ("no trace",)


def test_a_launch_file_that_a_built_in_package_lacks_is_refused(tmp_path):
    with pytest.raises(
        InputError, match=r"xml:2: package 'ros_gz_sim' is built in, and has no launch file 'gz.launch.py'"
    ):
        launch_xml(tmp_path, '<include file="$(find-pkg-share ros_gz_sim)/launch/gz.launch.py"/>')


def test_built_in_packages_are_not_absent(tmp_path):
    launched = launch_xml(tmp_path, '<log message="$(find-pkg-share ros_gz_sim)"/>')
    assert launched.absent_packages == ()
