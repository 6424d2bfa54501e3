import pytest
from launch_files import launch_python, launch_xml, write, write_package, write_python

from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate


def refused(folder, *args, **kwargs):
    with pytest.raises(InputError) as error:
        launch_python(folder, *args, **kwargs)
    return str(error.value)


def test_a_python_error_shows_the_traceback_of_the_file_alone(tmp_path):
    text = refused(tmp_path, "OpaqueFunction(function=start)", before="def start(context):\n    return 1 / 0\n")
    assert text.startswith(f"{tmp_path}/test.launch.py: the launch file's code fails\nTraceback")
    assert "return 1 / 0" in text
    assert text.endswith("ZeroDivisionError: division by zero.")
    assert "drake_twin" not in text.replace(str(tmp_path), "")


def test_one_line_on_top_says_which_include_led_there(tmp_path):
    write_python(tmp_path / "inner.launch.py", "undefined_name")
    write(tmp_path / "middle.launch.xml", '<launch>\n\n<include file="$(dirname)/inner.launch.py"/></launch>')
    with pytest.raises(InputError) as error:
        launch_xml(tmp_path, '<include file="$(dirname)/middle.launch.xml"/>')
    first = str(error.value).splitlines()[0]
    assert first == (
        f"{tmp_path}/inner.launch.py: the launch file's code fails, included by {tmp_path}/middle.launch.xml:3,"
        f" which is included by {tmp_path}/test.launch.xml:2"
    )
    assert "NameError: name 'undefined_name' is not defined" in str(error.value)


def test_an_error_in_a_function_of_an_included_file_names_the_include_too(tmp_path):
    write_python(tmp_path / "inner.launch.py", "OpaqueFunction(function=lambda context: {}['x'])")
    with pytest.raises(InputError, match=r"code fails, included by .*test.launch.xml:2\n"):
        launch_xml(tmp_path, '<include file="$(dirname)/inner.launch.py"/>')


def test_what_is_not_python_is_refused_with_its_line(tmp_path):
    file = write(tmp_path / "x.launch.py", "import os\nif:\n")
    with pytest.raises(InputError, match=r"x.launch.py:2: this is not Python: invalid syntax"):
        evaluate(file)


def test_a_name_that_ros_modules_lack_is_refused_with_file_line_and_choice(tmp_path):
    text = refused(tmp_path, "", before="from launch.actions import ExecuteProces")
    assert text.startswith(f"{tmp_path}/test.launch.py:13: launch.actions has no 'ExecuteProces' that the twin knows.")
    assert "Did you mean 'ExecuteProcess'?" in text


def test_a_module_that_ros_does_not_have_is_refused(tmp_path):
    assert "needs the Python module launch.nonsense, which is not there" in refused(
        tmp_path, "", before="import launch.nonsense"
    )


@pytest.mark.parametrize("module", ["launch_xml.parser", "launch.launch_description_sources.any_launch_file_utilities"])
def test_a_module_that_the_twin_has_no_stand_in_for_is_absent(tmp_path, module):
    text = refused(tmp_path, "", before=f"from {module} import x")
    assert f"needs the Python module {module}, which is not there" in text


def test_a_file_without_generate_launch_description_is_refused(tmp_path):
    with pytest.raises(InputError, match="has a function generate_launch_description"):
        evaluate(write(tmp_path / "x.launch.py", "x = 1\n"))


def test_a_file_that_gives_something_else_is_refused(tmp_path):
    with pytest.raises(InputError, match="returns 5, which is not a LaunchDescription"):
        evaluate(write(tmp_path / "x.launch.py", "def generate_launch_description():\n    return 5\n"))


def test_something_in_the_list_that_is_no_action_is_refused(tmp_path):
    assert "a launch description holds actions, and 'spawner' (a str) is not one" in refused(tmp_path, "'spawner'")


def test_an_environment_variable_that_is_not_set_is_named_with_the_line(tmp_path):
    text = refused(tmp_path, "LogInfo(msg=os.environ['TURTLE_MODEL'])")
    assert "test.launch.py:17: the launch file reads the environment variable 'TURTLE_MODEL', which is not set" in text


def test_the_variables_of_a_sourced_ros_are_there(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "humble")
    monkeypatch.delenv("GAZEBO_MODEL_PATH", raising=False)
    launched = launch_python(
        tmp_path, "LogInfo(msg=os.environ['ROS_DISTRO'] + '|' + os.environ['GAZEBO_MODEL_PATH'] + '|')"
    )
    assert launched.log == ("jazzy||",)


def test_a_file_may_read_the_command_line(tmp_path):
    launched = launch_python(
        tmp_path, "LogInfo(msg=next(w for w in sys.argv if ':=' in w))", before="import sys", model="x"
    )
    assert launched.log == ("model:=x",)


def test_standard_input_stays_connected(tmp_path, monkeypatch):
    import io

    monkeypatch.setattr("sys.stdin", io.StringIO("rover\n"))
    assert launch_python(tmp_path, "LogInfo(msg=input('Which robot? '))").log == ("rover",)


def test_what_a_file_prints_is_no_result_of_the_program(tmp_path, capsys):
    launch_python(tmp_path, "LogInfo(msg='x')", before="print('hello')")
    assert capsys.readouterr() == ("", "hello\n")


def test_a_file_that_ends_the_program_is_refused(tmp_path):
    assert "the launch file ends the program (exit code 3)" in refused(tmp_path, "", before="raise SystemExit(3)")


def test_open_finds_an_authors_own_path_by_the_package_in_it(tmp_path):
    package = write_package(tmp_path, "robots")
    write(package / "config" / "name.txt", "rover")
    launched = launch_python(tmp_path, "LogInfo(msg=open('/home/me/ws/src/robots/config/name.txt').read())")
    assert launched.log == ("rover",)


def test_a_file_may_load_another_as_a_module(tmp_path):
    write(tmp_path / "common.launch.py", "NAME = 'rover'\n")
    launched = launch_python(
        tmp_path,
        "LogInfo(msg=common.NAME)",
        before="from launch.launch_description_sources.python_launch_file_utilities import"
        " load_python_launch_file_as_module\n"
        "common = load_python_launch_file_as_module(os.path.join(os.path.dirname(__file__), 'common.launch.py'))",
    )
    assert launched.log == ("rover",)


def test_dataclasses_with_postponed_annotations_work(tmp_path):
    file = write(
        tmp_path / "x.launch.py",
        "from __future__ import annotations\nfrom dataclasses import dataclass\nfrom launch import LaunchDescription\n"
        "@dataclass\nclass Arguments:\n    name: str = 'a'\n"
        "def generate_launch_description():\n    return LaunchDescription([])\n",
    )
    assert evaluate(file).processes == ()
