import pytest
from launch_files import launch_python, launch_xml

from drake_twin.errors import InputError


def process(folder, arguments, **more):
    return launch_python(folder, f"ExecuteProcess({arguments})", **more).processes[0]


def test_a_command_and_what_it_says(tmp_path):
    started = process(
        tmp_path,
        "cmd=['gz', 'sim', '-r', ['-v', LaunchConfiguration('v')], LaunchConfiguration('world')], name='gz',"
        " output='screen', additional_env={'A': LaunchConfiguration('v')}, cwd='/tmp', shell=False",
        v="4",
        world="empty.sdf",
    )
    assert (started.kind, started.package, started.name) == ("process", None, "gz")
    assert (started.executable, started.arguments) == ("gz", ("sim", "-r", "-v4", "empty.sdf"))
    assert (started.output, started.environment) == ("screen", {"A": "4"})


def test_a_shell_command_is_split_into_words(tmp_path):
    started = process(
        tmp_path, """cmd=["ros2 topic pub /x std_msgs/msg/Float64MultiArray '{data: [1, 2]}' --once"], shell=True"""
    )
    assert started.arguments[-2:] == ("{data: [1, 2]}", "--once")


def test_a_command_that_does_its_work_ends_and_another_keeps_running(tmp_path):
    assert process(tmp_path, 'cmd=["ros2 service call /x std_srvs/srv/Empty"], shell=True').ends
    assert not process(tmp_path, 'cmd=["rviz2"], shell=True').ends


def test_how_a_process_is_watched_changes_nothing_and_is_no_finding(tmp_path):
    options = {"respawn": "true", "respawn_delay": "2.0", "respawn_max_retries": "3", "emulate_tty": "true"}
    options |= {"sigterm_timeout": "5", "sigkill_timeout": "5", "log_cmd": "false", "cached_output": "true"}
    text = " ".join(f'{name}="{value}"' for name, value in options.items())
    launched = launch_xml(tmp_path, f'<executable cmd="echo a" {text}/>')
    assert [item.arguments for item in launched.processes] == [("a",)]
    assert launched.refused_by_ros == ()
    with pytest.raises(InputError, match="twice"):
        launch_xml(tmp_path, '<executable cmd="echo a" twice="true"/>')


def test_a_command_as_one_text_is_taken_letter_by_letter(tmp_path):
    launched = launch_python(tmp_path, "ExecuteProcess(cmd='gz')")
    assert (launched.processes[0].executable, launched.processes[0].arguments) == ("g", ("z",))
    assert launched.log == ("'gz' is one text and not a list of words: ROS takes each letter for a word",)


def test_a_description_of_a_process_is_started_too(tmp_path):
    launched = launch_python(
        tmp_path,
        "ExecuteLocal(process_description=Executable(cmd=['echo', 'a'], arguments=['b']))",
        "from launch.descriptions import Executable",
    )
    assert launched.processes[0].arguments == ("a", "b")
