"""Python programs of the user's that a launch file starts."""

import pytest
from launch_files import write, write_package

from drake_twin.description.package_index import PackageIndex
from drake_twin.findings import Place
from drake_twin.from_launch.launched_nodes import launched_node, needs_terminal, spawns
from drake_twin.ros2.launched import LaunchedProcess
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.node_program import Respawn

SETUP = "from setuptools import setup\nsetup(name='mine', entry_points={'console_scripts': ['run = mine.a:main']})\n"


@pytest.fixture
def packages(tmp_path):
    package = write_package(tmp_path, "mine")
    write(package / "setup.py", SETUP)
    write(package / "mine" / "__init__.py", "")
    write(package / "mine" / "a.py", "import rclpy\ndef main(): ...\n")
    return PackageIndex([tmp_path])


def node(package="mine", executable="run", kind="node", **more):
    return LaunchedProcess(kind, executable, Place("a.launch.py", 7), package, **more)


def started(process, packages):
    findings = []
    return launched_node(process, packages, findings), findings


def test_a_node_of_a_package_is_its_program_with_ros_arguments(packages):
    process = node(
        name="n",
        namespace="/robot_1",
        parameters=({"rate": 5},),
        remappings=(("cmd", "other"),),
        arguments=("-v",),
        environment={"A": "1", "B": None},
        start_time=2.5,
    )
    found, _ = started(process, packages)
    assert (found.executable, found.package, found.time, found.environment) == ("run", "mine", 2.5, {"A": "1"})
    words = " ".join(found.arguments)
    assert words.startswith("-v --ros-args ")
    assert all(word in words for word in ("__node:=n", "__ns:=/robot_1", "cmd:=other", "rate:=5"))


def test_the_root_namespace_needs_no_argument(packages):
    assert started(node(), packages) == (NodeProgram("run", "mine"), [])


@pytest.mark.parametrize(
    "process", [node(executable="walk"), node("theirs"), node(None), node(kind="component"), node(kind="world")]
)
def test_what_is_no_python_program_of_a_package_is_no_node(packages, process):
    assert started(process, packages) == (None, [])


def test_a_component_that_the_twin_has_itself_is_a_node(packages):
    component = node("image_proc", "image_proc::RectifyNode", "component", name="r", namespace="/camera")
    found, _ = started(component, packages)
    assert (found.package, found.executable) == ("image_proc", "image_proc::RectifyNode")
    assert "__ns:=/camera" in found.arguments
    assert started(node("image_proc", "image_proc::DebayerNode", "component"), packages) == (None, [])


def test_a_program_that_the_twin_has_itself_needs_no_package(packages):
    found, _ = started(node("topic_tools", "relay"), packages)
    assert (found.package, found.executable) == ("topic_tools", "relay")


@pytest.mark.parametrize("words", [("python3", "{}", "-v"), ("/usr/bin/python3.11", "{}", "-v"), ("{}", "-v")])
def test_a_script_that_uses_rclpy_is_a_node_with_its_own_arguments(packages, tmp_path, words):
    script = write(tmp_path / "s.py", "#!/usr/bin/env python3\nimport rclpy\n")
    first, *others = (word.format(script) for word in words)
    found, _ = started(LaunchedProcess("process", first, Place("f"), arguments=tuple(others)), packages)
    assert found == NodeProgram(str(script), arguments=("-v",))


def test_other_commands_are_no_nodes(packages, tmp_path):
    plain = write(tmp_path / "s.py", "#!/usr/bin/env python3\nprint()\n")
    for words in (("python3", str(plain)), ("python3",), ("python3", "s.py"), ("ls", "-l")):
        process = LaunchedProcess("process", words[0], Place("f"), arguments=words[1:])
        assert started(process, packages) == (None, [])


def test_what_the_twin_never_does_for_a_node_is_said(packages):
    _, findings = started(node(not_done=("cwd",)), packages)
    text = "cwd of mine/run: a node starts in the working folder of the run"
    assert [(item.what, item.lines) for item in findings] == [(text, (7,))]


def test_how_a_process_is_started_again_is_passed_on(packages):
    found, findings = started(node(respawn=(2.0, 3)), packages)
    assert (found.respawn, findings) == (Respawn(2.0, 3), [])


def test_a_program_spawns_if_its_source_names_the_service(packages, tmp_path):
    program, file = NodeProgram("run", "mine"), tmp_path / "a.launch.py"
    assert not spawns(program, packages, file)
    write(tmp_path / "mine" / "mine" / "a.py", "from gazebo_msgs.srv import SpawnEntity\ndef main(): ...\n")
    assert spawns(program, packages, file)
    assert spawns(NodeProgram(str(write(tmp_path / "s.py", "SpawnEntity"))), packages, file)
    assert not spawns(NodeProgram(str(tmp_path / "gone.py")), packages, file)


def test_only_the_nodes_of_keyboards_need_a_terminal():
    assert [needs_terminal(node(name, name)) for name in ("teleop_twist_keyboard", "twist_mux")] == [True, False]
    assert needs_terminal(node("turtlesim", "turtle_teleop_key"))
