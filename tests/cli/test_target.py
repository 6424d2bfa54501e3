"""What the command line of drake_twin.run asks for."""

from pathlib import Path

import pytest
from launch_files import not_started

from drake_twin.cli.options import parser
from drake_twin.cli.target import build_twin, find_launch_file, find_target, target_name
from drake_twin.description.package_index import share_folder
from drake_twin.errors import InputError
from drake_twin.scenario import Command, ScenarioError

MODELS = share_folder("models")
ARM = MODELS / "arduinobot_description" / "launch" / "gazebo.launch.py"
ROVERS = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"
COMMANDS = "/forward_velocity_controller/commands"

_NAMES = ["a.launch.py", "a_launch.py", "anything.py", "a.launch", "a.launch.xml", "a_launch.yaml", "a.launch.yml"]


def target(*words):
    return find_target(parser().parse_args([*map(str, words)]))


@pytest.fixture
def workspace(tmp_path) -> Path:
    """A workspace with one package, whose launch files bring the arm of this project's models."""
    package = tmp_path / "ws" / "src" / "group" / "my_bringup"
    (package / "launch" / "more").mkdir(parents=True)
    (package / "package.xml").write_text("<package format='3'><name>my_bringup</name></package>")
    (package / "setup.py").write_text("from setuptools import setup\n")
    arm = '<launch><include file="$(find-pkg-share arduinobot_description)/launch/{}"/></launch>'
    (package / "launch" / "arm.launch.xml").write_text(arm.format("gazebo.launch.py"))
    (package / "launch" / "more" / "look.launch.xml").write_text(arm.format("display.launch.py"))
    return tmp_path / "ws"


@pytest.mark.parametrize("name", _NAMES)
def test_what_is_named_like_a_launch_file_is_one(name, tmp_path):
    assert find_launch_file([str(tmp_path / name)], []) == tmp_path / name


@pytest.mark.parametrize(
    ("name", "text", "is_launch"),
    [
        ("bringup.xml", "<?xml version='1.0'?>\n<!-- x -->\n<launch/>", True),
        ("bringup.yaml", "# x\nlaunch:\n- arg: {name: a}\n", True),
        ("robot.xml", "<robot name='r'/>", False),
        ("twin.yaml", "robots: []\n", False),
        ("robot.urdf.xacro", "<robot/>", False),
    ],
)
def test_other_names_are_told_by_what_is_in_the_file(tmp_path, name, text, is_launch):
    (tmp_path / name).write_text(text)
    assert (find_launch_file([str(tmp_path / name)], []) is not None) is is_launch


def test_a_launch_file_sees_in_sys_argv_what_ros2_launch_would_be_told(workspace):
    """Some take their arguments by their number, which follows ``PACKAGE FILE``, or the path."""
    folder = workspace / "src" / "group" / "my_bringup" / "launch"
    text = "import sys\nfrom launch import LaunchDescription\n"
    text += "from launch.actions import IncludeLaunchDescription, LogInfo\n"
    text += "def generate_launch_description():\n    log = LogInfo(msg=' '.join(sys.argv[1:]))\n"
    text += f"    return LaunchDescription([log, IncludeLaunchDescription({str(folder / 'arm.launch.xml')!r})])\n"
    file = folder / "argv.launch.py"
    file.write_text(text)
    options = ("--workspace", workspace, "a:=1")
    assert target("my_bringup", "argv.launch.py", *options).log[0] == "launch my_bringup argv.launch.py a:=1"
    assert target(file, *options).log[0] == f"launch {file} a:=1"


def test_a_package_and_its_launch_file_as_with_ros2_launch(workspace):
    options = ("--workspace", workspace)
    assert [robot.name for robot in target("my_bringup", "arm.launch.xml", *options).scenario.robots] == ["arduinobot"]
    assert target("my_bringup", "look.launch.xml", *options).only_displayed


def test_arguments_may_stand_after_options(workspace):
    words = ("my_bringup", "--workspace", workspace, "arm.launch.xml", "--headless", "robot_name:=ur5e")
    options = parser().parse_args([*map(str, words)])
    assert options.target == ["my_bringup", "arm.launch.xml", "robot_name:=ur5e"]


@pytest.mark.parametrize("inside", [".", "src", "src/group", "src/group/arduinobot_description/launch"])
def test_the_present_workspace_comes_before_the_twins_own_packages(workspace, inside, monkeypatch, capsys):
    own = workspace / "src" / "group" / "arduinobot_description"
    (own / "launch").mkdir(parents=True)
    (own / "package.xml").write_text("<package format='3'><name>arduinobot_description</name></package>")
    rovers = '<launch><include file="$(find-pkg-share rover_gazebo)/launch/main.launch.xml"/></launch>'
    (own / "launch" / "gazebo.launch.xml").write_text(rovers)
    monkeypatch.chdir(workspace / inside)
    found = target("arduinobot_description", "gazebo.launch.xml")
    assert [robot.name for robot in found.scenario.robots] == ["robot_1", "robot_2"]
    printed = capsys.readouterr().err.splitlines()[0]
    assert printed.startswith("launch file: ")
    assert Path(printed.removeprefix("launch file: ")).samefile(own / "launch" / "gazebo.launch.xml")


def test_a_workspace_lies_over_those_after_it(workspace, tmp_path_factory):
    other = tmp_path_factory.mktemp("other") / "src" / "my_bringup"
    other.mkdir(parents=True)
    (other / "package.xml").write_text("<package format='3'><name>my_bringup</name></package>")
    words = ("my_bringup", "arm.launch.xml", "--workspace")
    over = target(*words, workspace, "--workspace", other.parents[1])
    assert [robot.name for robot in over.scenario.robots] == ["arduinobot"]
    with pytest.raises(InputError, match="has no launch file"):
        target(*words, other.parents[1], "--workspace", workspace)


def test_a_package_as_the_workspace(workspace, monkeypatch):
    monkeypatch.chdir(workspace / "src" / "group" / "my_bringup")
    found = target("my_bringup", "arm.launch.xml", "--workspace", ".")
    assert [robot.name for robot in found.scenario.robots] == ["arduinobot"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["my_bringup", "arn.launch.xml"], "has no launch file 'arn.launch.xml'. Did you mean 'arm.launch.xml'"),
        (["my_bringpu", "arm.launch.xml"], "package 'my_bringpu' was not found in:"),
        (["my_bringup", "arm.launch.xml", "more"], "one scenario or robot file can be run at a time"),
    ],
)
def test_a_package_or_file_that_is_not_there(workspace, words, message):
    with pytest.raises(InputError, match=message):
        target(*words, "--workspace", workspace)


def test_arguments_reach_the_launch_file(tmp_path):
    model = tmp_path / "other.urdf"
    model.write_text('<robot name="other"><link name="world"/></robot>')
    (robot,) = target(ARM, f"model:={model}").scenario.robots
    assert '<robot name="other">' in Path(robot.model).read_text()


def test_arguments_that_the_file_does_not_have_are_listed():
    reason = "argument modle (no file declares it). Did you mean 'model'?"
    assert not_started(target(ARM, "modle:=x").scenario) == (reason,)


def test_required_arguments_without_a_value_are_listed(tmp_path):
    file = tmp_path / "a.launch.xml"
    file.write_text('<launch><arg name="one"/><arg name="two" description="The second"/></launch>')
    with pytest.raises(InputError) as caught:
        target(file)
    assert "one" in str(caught.value)
    assert "two" in str(caught.value)


@pytest.mark.parametrize("option", [("--robots", 2), ("--robot", "rover")])
def test_a_launch_file_says_itself_which_robots_there_are(option):
    with pytest.raises(InputError, match="cannot be combined with --robots or --robot"):
        target(ROVERS, *option)


def test_options_change_what_the_launch_file_says():
    changed = target(ROVERS, "--time-step", 0.002, "--world", "empty.sdf").scenario
    assert (changed.time_step, Path(changed.world.file).name) == (0.002, "empty.sdf")


def publishing(folder: Path, topic: str, data: str = "{data: [1, 0, 0, 0]}") -> Path:
    file = folder / "pub.launch.xml"
    file.write_text(
        f"""<launch><include file="{ARM}"/>
        <node pkg="controller_manager" exec="spawner" args="forward_velocity_controller"/>
        <executable cmd="ros2 topic pub --once {topic} std_msgs/msg/Float64MultiArray '{data}'"/></launch>"""
    )
    return file


def test_what_is_typed_goes_before_what_the_launch_file_publishes(tmp_path):
    file = publishing(tmp_path, COMMANDS)
    assert target(file).scenario.commands == (Command(COMMANDS, (1, 0, 0, 0), optional=True),)
    assert target(file, "--pub", COMMANDS, "[0, 1, 0, 0]").scenario.commands == (Command(COMMANDS, (0, 1, 0, 0)),)
    assert target(file, "--pub", COMMANDS, "{data: [0, 1]}").scenario.commands == (Command(COMMANDS, (0, 1)),)
    assert target(file, "--pub", "/floor", "{data: 2}").scenario.commands[-1] == Command("/floor", {"data": 2})


@pytest.mark.parametrize("value", [0.5, 2, True, "a text"])
def test_a_value_that_is_typed_is_that_of_a_message_with_one_field(tmp_path, value):
    (command,) = target(publishing(tmp_path, COMMANDS), "--pub", "/one", f"{{data: {value}}}").scenario.commands[-1:]
    assert command == Command("/one", {"data": value})


@pytest.mark.parametrize(
    ("topic", "data", "reason"),
    [
        ("/nobody", "{data: [1]}", "nothing listens to '/nobody'"),
        (COMMANDS, "{data: [1]}", "the command has 1 element"),
    ],
)
def test_what_a_launch_file_publishes_in_vain_is_left_out(tmp_path, topic, data, reason):
    twin = build_twin(target(publishing(tmp_path, topic, data)))
    (left_out,) = twin.findings.not_started
    assert left_out.startswith(f"ros2 topic pub {topic} (")
    assert reason in left_out
    assert twin.scenario.commands == ()


def test_what_is_typed_in_vain_is_refused(tmp_path):
    with pytest.raises(InputError, match="nothing listens to '/nobody'") as caught:
        build_twin(target(ARM, "--pub", "/nobody", "[1]"))
    assert not isinstance(caught.value, ScenarioError)


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ((), "rover"),
        (("--robot", "arm"), "arm"),
        (("/a/b.launch.py", "x:=1"), "b"),
        (("my_pkg", "main.launch.xml"), "main"),
        (("/a/.hidden",), "twin"),
        (("/a/b\tc.sdf",), "b_c"),
    ],
)
def test_a_short_name_of_what_runs(words, name):
    assert target_name(parser().parse_args([*words])) == name


def test_a_world_without_robots_says_what_it_lacks_and_nothing_else(tmp_path):
    (tmp_path / "w.sdf").write_text(
        '<sdf version="1.9"><world name="w"><include><uri>model://nowhere_robot</uri></include>'
        '<plugin name="p" filename="libunknown_thing.so"/></world></sdf>'
    )
    with pytest.raises(InputError, match="none of this world's models is there") as refused:
        target(tmp_path / "w.sdf")
    assert "nowhere_robot" in str(refused.value)
    assert "the plugin p" not in str(refused.value)
