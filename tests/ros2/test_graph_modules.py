"""Launch files that import modules of ROS's running graph."""

import pytest
from launch_files import launch_python

from drake_twin.errors import InputError

IMPORTS = """
import rclpy
from rclpy.node import Node as GraphNode
from controller_manager_msgs.srv import SwitchController
from gazebo_msgs.srv import SpawnEntity
from geometry_msgs.msg import PoseStamped
from my_robot_msgs.action import Dock
from osrf_pycommon.terminal_color import ansi
from moveit_configs_utils import MoveItConfigsBuilder
from launch.substitutions import SubstitutionFailure

class Mine(GraphNode):
    def done(self, future: rclpy.task.Future, handle: "rclpy.action.server.ServerGoalHandle" = None):
        pass

    handle: rclpy.action.server.ServerGoalHandle
"""
NODE = "Node(package='p', executable='e')"


def test_an_import_never_fails(tmp_path):
    assert launch_python(tmp_path, NODE, IMPORTS).processes[0].what == "p/e"


def test_a_message_can_be_made(tmp_path):
    before = (
        IMPORTS
        + """
pose = PoseStamped()
pose.header.frame_id = "map"
request = SwitchController.Request(strictness=2)
rclpy.init()
rclpy.logging.get_logger("launch").info("made")
"""
    )
    node = "Node(package='p', executable=pose.header.frame_id + ansi('red'), name=f'n{request.strictness}')"
    (process,) = launch_python(tmp_path, node, before).processes
    assert (process.executable, process.name) == ("map", "n2")


def test_a_node_of_a_graph_is_refused_in_words(tmp_path):
    with pytest.raises(InputError, match=r"uses .*Mine, which needs a running ROS"):
        launch_python(tmp_path, NODE, IMPORTS + "Mine('x')")


def test_a_misspelt_module_is_still_refused(tmp_path):
    with pytest.raises(InputError, match="needs the Python module my_robot_helpers"):
        launch_python(tmp_path, NODE, "import my_robot_helpers")


def test_a_failing_substitution_can_be_caught(tmp_path):
    before = (
        IMPORTS
        + """
def chosen(context):
    found = []
    for substitution in (LaunchConfiguration("none"), Command("false"), Command("no_such_program")):
        try:
            substitution.perform(context)
        except SubstitutionFailure as error:
            found.append(Node(package="p", executable=type(error).__name__))
    return found
"""
    )
    launched = launch_python(tmp_path, "OpaqueFunction(function=chosen)", before)
    names = [process.executable for process in launched.processes]
    assert names == ["SubstitutionFailure", "SubstitutionFailure", "AbsentFailure"]


@pytest.mark.parametrize("command", ["['ros2', 'run', 'p', 'set_up.bash']", "['bash', 'wait.sh']"])
def test_a_script_that_is_not_run_has_ended(tmp_path, command):
    launched = launch_python(
        tmp_path,
        f"RegisterEventHandler(OnProcessExit(target_action=script, on_exit=[{NODE}])), script",
        f"script = ExecuteProcess(cmd={command})",
    )
    assert launched.processes[-1].what == "p/e"
    assert launched.unfired_handlers == ()
