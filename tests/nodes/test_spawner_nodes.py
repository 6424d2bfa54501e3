"""Launch files whose robot is spawned by a node of the workspace, which asks the simulator's service for it."""

import pytest
from node_runs import lines, script
from test_programs import PACKAGE_XML

from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.errors import InputError

SETUP = """from setuptools import setup
setup(name="carts", packages=["carts"], entry_points={"console_scripts": ["spawner = carts.spawner:main"]})
"""
SPAWNER = """
import rclpy
from {types} import SpawnEntity

def main():
    rclpy.init()
    node = rclpy.create_node("spawner")
    client = node.create_client(SpawnEntity, {service!r})
    while not client.wait_for_service(timeout_sec=1.0):
        node.get_logger().info("waiting")
    request = SpawnEntity.Request()
{fill}
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future)
    print("success", future.result().success)
    rclpy.shutdown()
"""
CART = (
    "<robot name='cart'><link name='base'><inertial><mass value='2'/><inertia ixx='0.02' iyy='0.02' izz='0.02' ixy='0'"
    " ixz='0' iyz='0'/></inertial><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link></robot>"
)
CLASSIC = f"""    request.name, request.xml = "cart", {CART!r}
    request.initial_pose.position.x, request.initial_pose.position.z = 1.5, 0.1"""
GZ = f"""    factory = request.entity_factory
    factory.name, factory.sdf = "cart", {CART!r}
    factory.pose.position.x, factory.pose.position.z = 1.5, 0.1"""
LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd={simulator!r}), Node(package="carts", executable="spawner")])
"""


def package(folder, simulator, spawner):
    script(folder, "carts/package.xml", PACKAGE_XML.format(name="carts"))
    script(folder, "carts/setup.py", SETUP)
    script(folder, "carts/carts/__init__.py", "")
    script(folder, "carts/carts/spawner.py", spawner)
    return script(folder, "carts/launch/all.launch.py", LAUNCH.format(simulator=simulator))


@pytest.mark.parametrize(
    ("simulator", "types", "service", "fill"),
    [
        (["gzserver", "-s", "libgazebo_ros_factory.so"], "gazebo_msgs.srv", "/spawn_entity", CLASSIC),
        (["gz", "sim", "-r", "empty.sdf"], "ros_gz_interfaces.srv", "/world/empty/create", GZ),
    ],
)
def test_a_node_of_the_package_spawns_the_robot(tmp_path, capsys, simulator, types, service, fill):
    file = package(tmp_path, simulator, SPAWNER.format(types=types, service=service, fill=fill))
    scenario = launch_file_scenario(file).scenario
    assert (scenario.robots, [node.executable for node in scenario.nodes]) == ((), ["spawner"])
    with TwinBuilder().launch(file).build() as twin:
        assert twin.robots == ()
        twin.advance_to(0.5)
        assert twin.robots == ("cart",)
        assert twin.robot_state("cart").base_pose[:3] == pytest.approx((1.5, 0, 0.1), abs=1e-3)
        twin.entities.delete("cart")
        twin.advance_to(0.6)
        assert twin.robots == ()
    assert lines(capsys) == ["success True"]


def test_a_launch_file_whose_nodes_spawn_nothing_still_lacks_a_robot(tmp_path):
    file = package(tmp_path, ["gzserver"], "import rclpy\n\ndef main():\n    rclpy.init()\n")
    with pytest.raises(InputError, match="the launch file starts no robot"):
        launch_file_scenario(file)


NODES_ONLY = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([Node(package="turtlesim", executable="turtlesim_node"), {more}])
"""


def test_a_launch_file_of_nodes_alone_needs_no_robot(tmp_path):
    """ROS's tutorials are such: a talker and a listener, or turtlesim and a node that drives its turtles."""
    file = tmp_path / "turtles.launch.py"
    file.write_text(NODES_ONLY.format(more='Node(package="turtlesim", executable="mimic")'))
    with TwinBuilder().launch(file).build() as twin:
        twin.advance_to(0.1)
        assert (twin.robots, twin.more_findings) == ((), [])
        assert "/turtle1/pose" in dict(twin.more_topics.topics())


@pytest.mark.parametrize(
    "more",
    [
        'Node(package="robot_state_publisher", executable="robot_state_publisher")',
        'Node(package="controller_manager", executable="spawner", arguments=["drive"])',
        'Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"])',
        'ExecuteProcess(cmd=["gz", "sim", "-r", "empty.sdf"])',
    ],
)
def test_nodes_do_not_stand_in_for_a_robot_that_is_asked_for(tmp_path, more):
    file = tmp_path / "turtles.launch.py"
    file.write_text(NODES_ONLY.format(more=more))
    with pytest.raises(InputError, match="the launch file starts no robot"):
        launch_file_scenario(file)
