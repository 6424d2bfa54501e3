import contextlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import CORPUS
from launch_files import launch_python, launch_xml, write_python

from drake_twin.description.package_index import PackageIndex, share_folder
from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate, evaluate_description

MODELS = share_folder("models")
CORPUS_FILES = sorted(
    path for pattern in ("**/*launch*.py", "**/*.launch.xml", "**/*.launch.yaml") for path in CORPUS.glob(pattern)
)


def test_an_argument_typed_by_the_user_beats_the_default(tmp_path):
    entities = """DeclareLaunchArgument("robot", default_value="rover"),
        Node(package="p", executable="e", name=LaunchConfiguration("robot")),"""
    assert launch_python(tmp_path, entities).processes[0].full_name == "/rover"
    assert launch_python(tmp_path, entities, robot="arm").processes[0].full_name == "/arm"


def test_all_required_arguments_without_a_value_are_named_at_once(tmp_path):
    entities = """DeclareLaunchArgument("map", description="the map's file"),
        DeclareLaunchArgument("robot"), DeclareLaunchArgument("speed", default_value="1"),"""
    with pytest.raises(InputError) as error:
        launch_python(tmp_path, entities, robot="r")
    assert "needs values for its arguments: map (the map's file). Give each as name:=value" in str(error.value)
    with pytest.raises(InputError, match=r"map \(the map's file\), robot"):
        launch_python(tmp_path, entities)


def test_a_value_that_is_none_of_the_choices_is_refused(tmp_path):
    entities = 'DeclareLaunchArgument("mode", default_value="real", choices=["real", "mock"])'
    with pytest.raises(InputError, match=r"test.launch.py:\d+: the argument 'mode' is 'mook'.*Did you mean 'mock'"):
        launch_python(tmp_path, entities, mode="mook")


def test_arguments_that_no_file_declares_are_reported(tmp_path):
    launched = launch_python(tmp_path, 'DeclareLaunchArgument("robot", default_value="r")', robot="a", robt="b")
    assert launched.undeclared_arguments == {"robt": "robot"}


def test_a_launch_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="the launch file does not exist"):
        evaluate(tmp_path / "none.launch.py")


def test_every_process_knows_its_file_and_line(tmp_path):
    launched = launch_xml(tmp_path, '<node pkg="p" exec="e"/>\n<node pkg="p" exec="f"/>')
    assert [str(process.place) for process in launched.processes] == [
        f"{tmp_path}/test.launch.xml:2",
        f"{tmp_path}/test.launch.xml:3",
    ]


def test_two_files_in_one_process_give_what_two_processes_give(tmp_path):
    first = write_python(
        tmp_path / "first.launch.py",
        """SetEnvironmentVariable("GZ_SIM_RESOURCE_PATH", "/first"), DeclareLaunchArgument("a", default_value="1"),
        Node(package="p", executable="e", name=LaunchConfiguration("a")),""",
        before="import sys\nsys.path.insert(0, '/somewhere')\nos.environ['SEEN'] = '1'",
    )
    second = write_python(
        tmp_path / "second.launch.py",
        """Node(package="p", executable="f", name=EnvironmentVariable("SEEN", default_value="not_seen"),
             arguments=[LaunchConfiguration("a", default="none"), AnonName("x")]),""",
    )
    rover = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"
    code = (
        "import sys\nfrom drake_twin.ros2.evaluate import evaluate\n"
        "for file in sys.argv[1:]:\n    print(repr(evaluate(file)))"
    )

    def run(*files):
        command = [sys.executable, "-c", code, *map(str, files)]
        root = Path(__file__).parents[2]
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=root).stdout.splitlines()

    together = run(first, second, rover)
    assert together == [*run(first), *run(second), *run(rover)]
    assert "not_seen" in together[1]


def test_a_description_built_in_plain_python_is_evaluated():
    from drake_twin.launch import DeclareLaunchArgument, LaunchConfiguration, LaunchDescription, Node

    description = LaunchDescription(
        [
            DeclareLaunchArgument("name", default_value="rover"),
            Node(package="p", executable="e", name=LaunchConfiguration("name")),
        ]
    )
    launched = evaluate_description(description, {"name": "arm"})
    assert launched.processes[0].full_name == "/arm"
    assert launched.processes[0].place.file == __file__


def test_an_entity_that_does_not_exist_is_no_attribute_of_the_room():
    with pytest.raises(ImportError):
        from drake_twin.launch import NoSuchEntity  # noqa: F401


def test_reading_the_room_loads_neither_the_simulator_nor_the_message_types():
    code = (
        "import sys, drake_twin.ros2.evaluate as e; e.evaluate(sys.argv[1]);"
        "print([name for name in ('pydrake', 'rosbags', 'numpy') if name in sys.modules])"
    )
    file = MODELS / "arduinobot_description" / "launch" / "gazebo.launch.py"
    command = [sys.executable, "-c", code, str(file)]
    root = Path(__file__).parents[2]
    assert subprocess.run(command, capture_output=True, text=True, check=True, cwd=root).stdout.strip() == "[]"


def test_all_that_is_absent_is_named_in_one_paragraph(tmp_path):
    entities = """
        IncludeLaunchDescription(os.path.join(get_package_share_directory("nav2_bringup"), "launch", "x.launch.py")),
        Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[
            {"robot_description": Command(["xacro ", FindPackageShare("ur_description"), "/urdf/ur.urdf.xacro"])}]),"""
    with pytest.raises(InputError) as error:
        launch_python(tmp_path, entities)
    assert "Absent packages: nav2_bringup, ur_description. Name the folders that hold them" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_package_that_is_only_asked_for_is_no_error(tmp_path):
    launched = launch_python(
        tmp_path,
        'LogInfo(msg=os.path.join(get_package_share_directory("none_such"), "rviz", "view.rviz"))',
    )
    assert launched.absent_packages == ("none_such",)
    assert launched.log == ("/package-not-found/none_such/rviz/view.rviz",)


@pytest.mark.skipif(not CORPUS_FILES, reason="the folder shared/corpus holds no launch files")
@pytest.mark.parametrize("file", CORPUS_FILES, ids=lambda file: str(file.relative_to(CORPUS)))
def test_a_launch_file_of_other_people_is_evaluated_or_refused_in_words(file):
    before = dict(os.environ), list(sys.path), os.getcwd()
    with contextlib.suppress(InputError):  # in words; anything else escapes
        evaluate(file, {}, PackageIndex([CORPUS]))
    assert (dict(os.environ), list(sys.path), os.getcwd()) == before
