"""Where node programs come from, and what each sees of the process."""

import os
import sys

import pytest
from conftest import ROVER, rovers
from launch_files import write_package
from node_runs import COMMANDS, HEAD, lines, running, script

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.twin import Twin

PACKAGE_XML = "<package><name>{name}</name><version>0.0.0</version></package>"
SETUP = """
from setuptools import find_packages, setup

package_name = "{name}"
setup(
    name=package_name,
    packages=find_packages(),
    data_files=[("share/" + package_name, ["package.xml"])],
    entry_points={{"console_scripts": ["talk = {name}.talk:main", f"other = {{package_name}}.talk:other"]}},
)
"""
TALK = """
import sys
from {name}.words import WORD
from rclpy.node import Node
import rclpy


class Talk(Node):
    def __init__(self):
        super().__init__("talk")
        self.declare_parameter("loud", False)
        self.declare_parameter("gains.p", 0.0)
        self.declare_parameter("names", ["x"])
        print(WORD, sys.argv[1:], self.get_fully_qualified_name(), __name__)
        print([self.get_parameter(name).value for name in ("loud", "gains.p", "names")])


def main():
    rclpy.init()
    rclpy.spin(Talk())


def other():
    print("other")
    return 3
"""


def python_package(folder, name, word):
    """A package as ``ros2 pkg create --build-type ament_python`` makes them."""
    package = folder / name
    script(package, "package.xml", PACKAGE_XML.format(name=name))
    script(package, "setup.py", SETUP.format(name=name))
    script(package, f"{name}/__init__.py", "")
    script(package, f"{name}/words.py", f"WORD = {word!r}\n")
    script(package, f"{name}/talk.py", TALK.format(name=name))
    return package


def test_a_console_script_of_a_package(tmp_path, capsys):
    python_package(tmp_path, "greeter", "hello")
    builder = rovers(1).package_path(tmp_path)
    builder.node("talk", "a", package="greeter", parameters={"loud": True, "gains.p": 1e-5, "names": ["a", "1"]})
    with builder.build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    told, values = lines(capsys)
    assert told.startswith("hello ['a', '--ros-args', '-p', 'loud:=true', '-p', 'gains.p:=1.0e-05'")
    assert told.endswith(" /talk greeter.talk")
    assert values == "[True, 1e-05, ['a', '1']]"


def test_a_module_of_its_packages_name_is_another(tmp_path, capsys):
    """A module's own folder is not on the path of a console script."""
    package = python_package(tmp_path, "talk", "hello")
    with rovers(1).package_path(tmp_path).node("talk", package="talk").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys)[0].endswith(" /talk talk.talk")
    assert (package / "talk" / "talk.py").is_file()


@pytest.mark.parametrize(
    ("module", "imported"),
    [("solo", ["solo"]), ("deep.sub.talk", ["deep", "deep.sub", "deep.sub.talk"])],
)
def test_the_packages_around_a_module_are_imported_and_each_once(module, imported, tmp_path, capsys):
    """As Python's own import does it."""
    package = tmp_path / "talker"
    script(package, "package.xml", PACKAGE_XML.format(name="talker"))
    entry = f'{{"console_scripts": ["talk = {module}:main"]}}'
    script(package, "setup.py", f'from setuptools import setup\nsetup(name="talker", entry_points={entry})\n')
    for name in imported:
        place = name.replace(".", "/") + ("" if name == module else "/__init__")
        script(package, f"{place}.py", "print(__name__)\n\n\ndef main():\n    print('runs')\n")
    with rovers(1).package_path(tmp_path).node("talk", package="talker").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == [*imported, "runs"]


def test_modules_that_are_installed_beside_a_console_script_are_found(tmp_path, capsys):
    """``lib/PACKAGE`` is the first folder on the path of such a script."""
    package = python_package(tmp_path, "greeter", "hello")
    files = '("lib/" + package_name, glob(package_name + "/*_utils.py"))'
    setup = (package / "setup.py").read_text().replace("data_files=[", f"data_files=[{files}, ")
    (package / "setup.py").write_text(f"from glob import glob\n{setup}")
    script(package, "greeter/word_utils.py", "LOUD = 'HELLO'\n")
    script(package, "greeter/talk.py", "import word_utils\n\n\ndef main():\n    print(word_utils.LOUD)\n")
    with rovers(1).package_path(tmp_path).node("talk", package="greeter").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == ["HELLO"]


def test_scripts_that_cmake_installs_into_one_folder_import_each_other(tmp_path, capsys):
    """Wherever they are in the source: ``lib/PACKAGE`` has them all, but not what is installed below it or nowhere."""
    package = write_package(tmp_path, "tools")
    installs = ["src/say.py", "src/parts/words.py"]
    text = "".join(f"install(PROGRAMS {file} DESTINATION lib/${{PROJECT_NAME}})\n" for file in installs)
    text += "install(FILES src/inner/deep.py DESTINATION lib/${PROJECT_NAME}/deeper)\n"
    script(package, "CMakeLists.txt", f"project(tools)\n{text}")
    script(package, "src/parts/words.py", "LOUD = 'HELLO'\n")
    script(package, "src/inner/deep.py", "")
    script(
        package,
        "src/say.py",
        "import words\nprint(words.LOUD)\ntry:\n    import deep\nexcept ImportError:\n    print('no')\n",
    )
    with rovers(1).package_path(tmp_path).node("say.py", package="tools").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == ["HELLO", "no"]


def test_the_exit_code_of_a_console_script_counts(tmp_path, capsys):
    python_package(tmp_path, "greeter", "hello")
    with rovers(1).package_path(tmp_path).node("other", package="greeter").build() as twin:
        twin.advance_to(0.01)
        (finding,) = twin.findings
        assert finding.what.startswith("node greeter/other: it has ended with exit code 3 (")
    assert lines(capsys) == ["other"]


def test_an_unknown_program_of_a_package(tmp_path):
    python_package(tmp_path, "greeter", "hello")
    with pytest.raises(InputError, match=r"package 'greeter' has no Python program 'walk'"):
        rovers(1).package_path(tmp_path).node("walk", package="greeter").build()


def test_modules_of_one_name_are_apart(tmp_path, capsys):
    for name in ("one", "two"):
        script(tmp_path, f"{name}/helper.py", f"NAME = {name!r}\n")
        script(
            tmp_path,
            f"{name}/main.py",
            "import helper, time\ntime.sleep(0.1)\nimport helper as again\nprint(again.NAME)\n",
        )
    with running(tmp_path / "one/main.py", tmp_path / "two/main.py") as twin:
        twin.advance_to(0.2)
    assert lines(capsys) == ["one", "two"]
    assert "helper" not in sys.modules


def test_the_process_is_as_before(tmp_path, capsys):
    before = sys.argv, sys.path, os.environ, dict(os.environ), sys.stdin
    text = "import os, sys, rclpy\nsys.path.append('/x')\nos.environ['MINE'] = '1'\n"
    text += "print(os.environ['GIVEN'], sys.argv[1])\n"
    file = script(tmp_path, "f.py", text)
    with rovers(1).node(file, "word", environment={"GIVEN": "2"}).build() as twin:
        twin.advance_to(0.01)
        assert "rclpy" not in sys.modules
        with pytest.raises(ModuleNotFoundError):
            __import__("rclpy")
        assert (sys.argv, sys.path, os.environ, dict(os.environ)) == before[:4]
    assert sys.stdin is before[4]
    assert lines(capsys) == ["2 word"]


def test_another_module_of_rclpys_name_is_not_shadowed(tmp_path, capsys, monkeypatch):
    script(tmp_path, "real/rclpy.py", "REAL = True\n")
    monkeypatch.syspath_prepend(str(tmp_path / "real"))
    import rclpy

    try:
        file = script(tmp_path, "node/f.py", "import rclpy\nprint(hasattr(rclpy, 'REAL'), rclpy.ok())\n")
        with running(file) as twin:
            twin.advance_to(0.01)
            import rclpy as again

            assert again is rclpy
            assert rclpy.REAL
        assert lines(capsys) == ["False False"]
    finally:
        sys.modules.pop("rclpy", None)


def test_a_scenario_says_its_nodes_as_plain_data(tmp_path):
    file = script(tmp_path, "f.py", "")
    builder = rovers(1).node(file, "x", remappings={"a": "b"}, parameters={"p": 2.5}, time=1.0)
    scenario = builder.node("talk", package="greeter").scenario()
    assert scenario.nodes == (
        NodeProgram(str(file), arguments=("x", "--ros-args", "-r", "a:=b", "-p", "p:=2.5"), time=1.0),
        NodeProgram("talk", "greeter"),
    )
    assert ScenarioFile(scenario_to_yaml(scenario), tmp_path / "s.yaml").scenario == scenario


def test_parameters_files(tmp_path, capsys):
    python_package(tmp_path, "greeter", "hello")
    parameters = script(
        tmp_path,
        "p.yaml",
        "/**:\n  ros__parameters: {loud: true, names: [every]}\n"
        "/ns/talk:\n  ros__parameters:\n    gains: {p: 2.0}\n"
        "/other/talk:\n  ros__parameters: {loud: false}\n",
    )
    builder = rovers(1).package_path(tmp_path)
    builder.node("talk", package="greeter", namespace="/ns", parameter_files=[parameters])
    with builder.build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys)[1] == "[True, 2.0, ['every']]"


LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher", namespace="robot_1",
             parameters=[{{"robot_description": {urdf!r}}}]),
        Node(package="gazebo_ros", executable="spawn_entity.py", namespace="robot_1",
             arguments=["-entity", "robot_1", "-topic", "robot_description"]),
        Node(package="greeter", executable="talk", name="my_talk", namespace="robot_1", arguments=["--fast"],
             parameters=[{{"loud": True, "gains": {{"p": 0.5}}}}], remappings=[("a", "b")],
             additional_env={{"COLOR": "red"}}),
        Node(package="greeter", executable="in_cpp"),
        ExecuteProcess(cmd=["python3", {script!r}, "--x"]),
    ])
"""


def test_nodes_of_a_launch_file(tmp_path, capsys):
    from drake_twin.builder.launch_file import launch_file_scenario

    source = tmp_path / "src"
    python_package(source, "greeter", "hello")
    other = script(source, "greeter/scripts/plain.py", "import rclpy\nprint('plain')\n")
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    urdf = f"<robot name='r'><link name='base'><inertial><mass value='1'/>{inertia}</inertial></link></robot>"
    file = script(source, "greeter/launch/all.launch.py", LAUNCH.format(urdf=urdf, script=str(other)))
    scenario = launch_file_scenario(file).scenario
    talk, plain = scenario.nodes
    assert (talk.package, talk.executable, dict(talk.environment)) == ("greeter", "talk", {"COLOR": "red"})
    assert plain == NodeProgram(str(other), arguments=("--x",))
    lost = [item.what for item in scenario.findings if item.kind is Kind.NOT_STARTED]
    advice = "publish its messages by --pub, or run a node by --node"
    assert lost == [f"greeter/in_cpp (it is not a Python program of the workspace: {advice})"]
    with TwinBuilder().launch(file).build() as twin:
        twin.advance_to(0.01)
    first, values, last = lines(capsys)
    assert first.startswith("hello ['--fast', '--ros-args'")
    assert first.endswith(" /robot_1/my_talk greeter.talk")
    assert (values, last) == ("[True, 0.5, ['x']]", "plain")


@pytest.mark.parametrize(
    ("options", "keywords"),
    [
        ("cwd='/'", ["cwd"]),
        ("prefix='xterm -e', respawn='True'", ["prefix"]),
        ("prefix='', respawn=False, emulate_tty=True, respawn_delay=2.0", []),
    ],
)
def test_what_a_launch_file_asks_for_a_node_and_the_twin_does_not_do(tmp_path, options, keywords):
    from drake_twin.builder.launch_file import launch_file_scenario

    python_package(tmp_path, "greeter", "hello")
    text = LAUNCH.format(urdf="<robot name='r'><link name='base'/></robot>", script="")
    text = text.replace('arguments=["--fast"]', options)
    scenario = launch_file_scenario(script(tmp_path, "greeter/launch/all.launch.py", text)).scenario
    found = [item for item in scenario.findings if item.kind is Kind.IGNORED and "greeter/talk" in item.what]
    assert [item.what.partition(" of greeter/talk: ")[0] for item in found] == keywords
    assert all(item.lines == (13,) for item in found)


def test_a_script_that_cmake_installs(tmp_path, capsys):
    package = tmp_path / "tools"
    script(package, "package.xml", PACKAGE_XML.format(name="tools"))
    script(
        package,
        "CMakeLists.txt",
        "project(tools)\ninstall(PROGRAMS\n  scripts/say.py\n  DESTINATION lib/${PROJECT_NAME})\n",
    )
    script(package, "scripts/say.py", "#!/usr/bin/env python3\nfrom near import WORD\nprint(WORD)\n")
    script(package, "scripts/near.py", "WORD = 'near'\n")
    with rovers(1).package_path(tmp_path).node("say.py", package="tools").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == ["near"]


def test_a_node_imports_another_package_of_the_workspace(tmp_path, capsys):
    python_package(tmp_path, "greeter", "hello")
    package = tmp_path / "tools"
    script(package, "package.xml", PACKAGE_XML.format(name="tools"))
    script(package, "CMakeLists.txt", "install(PROGRAMS say.py DESTINATION lib/tools)\n")
    script(package, "say.py", "from greeter.words import WORD\nprint(WORD)\n")
    with rovers(1).package_path(tmp_path).node("say.py", package="tools").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == ["hello"]


def test_interfaces_of_the_workspace(tmp_path, capsys):
    package = tmp_path / "wheel_msgs"
    script(package, "package.xml", PACKAGE_XML.format(name="wheel_msgs"))
    script(package, "msg/Speeds.msg", "uint8 FAST=3\nfloat64 front 1.5\nWheel[] wheels\nstring[2] names\n")
    script(package, "msg/Wheel.msg", "int32 number\nfloat64[] torques\n")
    script(package, "srv/Start.srv", "string what\n---\nbool ok\n")
    script(package, "action/Drive.action", "float64 distance\n---\nwheel_msgs/Wheel last\n---\nfloat64 left\n")
    script(package, "config/x.yaml", "")
    text = """
import os
from ament_index_python.packages import get_package_share_directory
from wheel_msgs.action import Drive
from wheel_msgs.msg import Speeds, Wheel
from wheel_msgs.srv import Start

speeds = Speeds(wheels=[Wheel(number=2, torques=[1.0])])
print(speeds.FAST, speeds.front, speeds.wheels[0].number, list(speeds.wheels[0].torques), speeds.names)
print(Start.Request(what="x").what, Start.Response().ok, Drive.Result().last.number, Drive.Goal(distance=2.0).distance)
print(Speeds.get_fields_and_field_types()["wheels"])
for wrong in ({"front": 1}, {"wheels": [3]}, {"nothing": 1}, {"names": ["a"]}):
    try:
        Speeds(**wrong)
    except AssertionError:
        print("AssertionError")
print(os.path.exists(get_package_share_directory("wheel_msgs") + "/config/x.yaml"))
"""
    script(package, "CMakeLists.txt", "install(PROGRAMS say.py DESTINATION lib/wheel_msgs)\n")
    script(package, "say.py", text)
    with rovers(1).package_path(tmp_path).node("say.py", package="wheel_msgs").build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == [
        "3 1.5 2 [1.0] ['', '']",
        "x False 0 2.0",
        "sequence<wheel_msgs/Wheel>",
        *["AssertionError"] * 4,
        "True",
    ]


def test_a_replay_needs_no_node(tmp_path):
    from drake_twin.twin.replay import replay

    file = script(
        tmp_path,
        "drive.py",
        f"""
class My(Node):
    def __init__(self):
        super().__init__("drive")
        self.publisher = self.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
        self.create_timer(0.1, lambda: self.publisher.publish(Float64MultiArray(data=[1.0, 2.0, 1.0, 2.0])))
""",
    )
    with running(file) as twin:
        twin.recorder.begin()
        twin.advance_to(1.0)
        recording, expected = twin.recorder.recording(), twin.state_sha256()
    file.unlink()
    with replay(recording) as again:
        assert again.state_sha256() == expected
        assert len(recording.calls) == 9


def test_a_replay_does_what_a_node_has_asked_for(tmp_path, capsys):
    """Services: controllers are switched, and time is reset."""
    from drake_twin.twin.replay import replay

    file = script(
        tmp_path,
        "asks.py",
        f"""
import time
import rclpy
from controller_manager_msgs.srv import SwitchController
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Empty

rclpy.init()
node = rclpy.create_node("asks")
publisher = node.create_publisher(Float64MultiArray, "{COMMANDS}", 1)


def call(kind, name, **fields):
    future = node.create_client(kind, name).call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future)


def switch(**fields):
    call(SwitchController, "/robot_1/controller_manager/switch_controller", strictness=2, **fields)
    time.sleep(0.1)


for speed in (1.0, 2.0):
    publisher.publish(Float64MultiArray(data=[speed] * 4))
    time.sleep(0.2)
    switch(deactivate_controllers=["forward_velocity_controller"])
    switch(activate_controllers=["forward_velocity_controller"])
    publisher.publish(Float64MultiArray(data=[-speed] * 4))
    call(Empty, "/reset_simulation")
print("asked")
publisher.publish(Float64MultiArray(data=[1.0, 2.0, 3.0, 4.0]))
""",
    )
    with running(file) as twin:
        twin.recorder.begin()
        for _ in range(3):
            twin.advance_to(0.5)
        assert twin.findings == ()
        recording, expected = twin.recorder.recording(), twin.state_sha256()
    assert lines(capsys) == ["asked"]
    file.unlink()
    with replay(recording) as again:
        assert again.state_sha256() == expected
        assert again.time == 0.5


TWO = """
import rclpy, sys
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray


class Two(Node):
    def __init__(self):
        super().__init__("two_" + sys.argv[1])
        self.names = {"left", "right", "front", "back"}
        self.publisher = self.create_publisher(Float64MultiArray, "/robot_1/forward_velocity_controller/commands", 10)
        self.create_timer(0.05, self.drive)

    def drive(self):
        self.publisher.publish(Float64MultiArray(data=[float(sys.argv[1])] * 4))


rclpy.init()
rclpy.spin(Two())
"""


def test_two_timers_on_one_instant_are_repeatable(tmp_path):
    """The command of the program that started later is the last: it counts, in each run, with any hash seed."""
    import subprocess

    file = script(tmp_path, "two.py", TWO)
    program = (
        "from drake_twin.builder.twin_builder import TwinBuilder\n"
        f"builder = TwinBuilder().robot('robot_1', {ROVER!r}, xyz=(0, 0, 0.13))\n"
        f"twin = builder.node({str(file)!r}, '1').node({str(file)!r}, '2').build()\n"
        "twin.advance_to(0.5)\n"
        "command = twin.graph.command('/robot_1/forward_velocity_controller/commands')\n"
        "print(twin.state_sha256(), command.data.tolist())\n"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
            timeout=120,
        ).stdout
        for seed in ("0", "1", "2")
    }
    assert len(found) == 1
    assert found.pop().split(" ", 1)[1] == "[2.0, 2.0, 2.0, 2.0]\n"


@pytest.mark.parametrize("text", ["os.read(reading, 1)", "while True: count += 1"], ids=["waits", "computes"])
def test_a_program_that_ends_outside_of_the_simulation_takes_back_what_it_has(tmp_path, text):
    reading, writing = os.pipe()
    head = f"import os\nreading, count = {reading}, 0\n{HEAD}rclpy.init()\nnode = rclpy.create_node('brief')\n"
    file = script(tmp_path, "f.py", f"{head}kept = node.create_publisher(String, 'news', 1)\n{text}\n")
    with Twin(rovers(1).node(file).scenario()) as twin:
        nodes = Nodes(twin, patience=0.1)
        twin.advance_to(0.002)
        (program,) = nodes.programs
        os.write(writing, b"1")
        while not program.main.has_ended:
            twin.advance_to(twin.time + 0.01)
        assert (program.exit_code, nodes.graph.publications) == (0 if "read" in text else -9, {})
        nodes.close()
    os.close(reading)
    os.close(writing)
