"""A robot of one hinge with two controllers, and launch files that bring it into the world."""

from pathlib import Path

from launch_files import write, write_python

from drake_twin.builder.launch_file import LaunchedTwin, launch_file_scenario

_LINK = (
    '<link name="{}"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)

CONTROLLERS = """\
/**:
  controller_manager:
    ros__parameters:
      update_rate: 100
      states: {type: joint_state_broadcaster/JointStateBroadcaster}
      velocity: {type: velocity_controllers/JointGroupVelocityController}
  velocity:
    ros__parameters:
      joints: [hinge]
"""

RENAMED = """\
controller_manager:
  ros__parameters:
    extra: {type: joint_state_broadcaster/JointStateBroadcaster}
"""


def hinge(controllers: Path | None = None, *, name: str = "hinge", plugin: str = "", extra: str = "") -> str:
    """The URDF of an arm on a base that is fixed in the world.

    Args:
        controllers: the parameters file that its plugin names; None for no plugin.
        name: the robot's name.
        plugin: further elements of the plugin.
        extra: further elements of the robot.
    """
    gazebo = (
        ""
        if controllers is None
        else '<gazebo><plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">'
        f"<parameters>{controllers}</parameters>{plugin}</plugin></gazebo>"
    )
    return f"""<robot name="{name}"><link name="world"/>{_LINK.format("base")}{_LINK.format("arm")}
<joint name="mount" type="fixed"><parent link="world"/><child link="base"/></joint>
<joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit velocity="5" effort="50"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="hinge"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>
{gazebo}{extra}</robot>"""


def write_hinge(folder: Path, name: str = "hinge", **options: str) -> Path:
    """Writes the robot and its controllers' file; returns the URDF's path."""
    controllers = write(folder / "controllers.yaml", CONTROLLERS)
    return write(folder / f"{name}.urdf", hinge(controllers, name=name, **options))


def publisher(file: Path, **options: object) -> str:
    """A robot_state_publisher of a URDF file, as an entity of a Python launch file."""
    more = "".join(f", {name}={value!r}" for name, value in options.items())
    return (
        "Node(package='robot_state_publisher', executable='robot_state_publisher',"
        f" parameters=[{{'robot_description': open({str(file)!r}).read()}}]{more}),"
    )


def create(*arguments: object, **options: object) -> str:
    """A ros_gz_sim/create node."""
    return node("ros_gz_sim", "create", *arguments, **options)


def spawner(*arguments: object, **options: object) -> str:
    """A spawner of controllers."""
    return node("controller_manager", "spawner", *arguments, **options)


def node(package: str, executable: str, *arguments: object, **options: object) -> str:
    """Any node with its arguments."""
    more = "".join(f", {name}={value!r}" for name, value in options.items())
    return f"Node(package={package!r}, executable={executable!r}, arguments={[*map(str, arguments)]!r}{more}),"


def command(*words: object, **options: object) -> str:
    """An ExecuteProcess."""
    more = "".join(f", {name}={value!r}" for name, value in options.items())
    return f"ExecuteProcess(cmd={[*map(str, words)]!r}{more}),"


def gz(gz_args: str) -> str:
    """An include of ros_gz_sim's launch file."""
    return (
        "IncludeLaunchDescription(os.path.join(get_package_share_directory('ros_gz_sim'), 'launch',"
        f" 'gz_sim.launch.py'), launch_arguments={{'gz_args': {gz_args!r}}}.items()),"
    )


def launched(folder: Path, *entities: str, before: str = "") -> LaunchedTwin:
    """The scenario of a Python launch file with these entities."""
    return launch_file_scenario(write_python(folder / "test.launch.py", "\n".join(entities), before))


def launched_hinge(folder: Path, *entities: str) -> LaunchedTwin:
    """The same, with the hinge in the world, described and spawned."""
    return launched(folder, publisher(write_hinge(folder)), create("-topic", "robot_description"), *entities)
