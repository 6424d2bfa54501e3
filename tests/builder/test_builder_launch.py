"""The launch entities as a builder in plain Python."""

from drake_twin import TwinBuilder
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.description.package_index import share_folder
from drake_twin.launch import LaunchDescription

MAIN = share_folder("models") / "rover_gazebo" / "launch" / "main.launch.xml"


BALL = """<robot name="x"><link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def test_a_builder_and_a_launch_file_end_in_the_same_scenario():
    by_file = launch_file_scenario(MAIN).scenario
    assert TwinBuilder().launch(MAIN).scenario() == by_file


def test_entities_in_plain_python_start_what_they_say():
    from drake_twin.launch import DeclareLaunchArgument, LaunchConfiguration, Node

    description = LaunchDescription(
        [
            DeclareLaunchArgument("name", default_value="ball"),
            Node(
                package="ros_gz_sim",
                executable="create",
                arguments=["-name", LaunchConfiguration("name"), "-z", "1.0", "-string", BALL],
            ),
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                arguments=["0", "0", "0", "0", "0", "0", "map", "odom"],
            ),
        ]
    )
    builder = TwinBuilder().launch(description, name="globe")
    builder.robot("rover", "package://rover_description/urdf/rover.urdf.xacro", xyz=(2, 0, 0.13))
    scenario = builder.scenario()
    assert [robot.name for robot in scenario.robots] == ["globe", "rover"]
    assert scenario.robots[0].xyz == (0.0, 0.0, 1.0)
    assert [(frame.parent, frame.child) for frame in scenario.static_transforms] == [("map", "odom")]
    twin = builder.build()
    twin.advance_to(0.1)
    assert twin.robot_state("globe").base_pose[2] < 0.96


def test_a_launched_worlds_step_is_the_builders_unless_it_was_given_one(tmp_path):
    world = tmp_path / "w.sdf"
    world.write_text(
        '<sdf version="1.9"><world name="w"><physics type="ode"><max_step_size>0.002</max_step_size></physics></world>'
        "</sdf>"
    )
    (tmp_path / "a.launch.xml").write_text(
        f'<launch><executable cmd="gz sim -r {world}"/><node pkg="ros_gz_sim" exec="create" args="-name ball -string'
        f" '{BALL.replace(chr(34), '&quot;').replace('<', '&lt;')}'\"/></launch>"
    )
    by_file = launch_file_scenario(tmp_path / "a.launch.xml").scenario
    assert by_file.time_step == 0.002
    assert TwinBuilder().launch(tmp_path / "a.launch.xml").scenario() == by_file
    assert TwinBuilder(time_step=0.005).launch(tmp_path / "a.launch.xml").scenario().time_step == 0.005
