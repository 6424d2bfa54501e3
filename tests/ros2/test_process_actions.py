import pytest
from launch_files import launch_python


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


@pytest.mark.parametrize(
    ("command", "ends"),
    [
        ("ros2 control load_controller --set-state active jsb", True),
        ("ros2 topic pub --once /x std_msgs/msg/Empty", True),
        ("ros2 topic pub -r 10 /x std_msgs/msg/Empty", False),
        ("ros2 topic echo /x", False),
        ("ros2 service call /x std_srvs/srv/Empty", True),
        ("ros2 run gazebo_ros spawn_entity.py -entity r", True),
        ("ros2 run rviz2 rviz2", False),
        ("gz sim -r empty.sdf", False),
        ("gz service -s /world/empty/create", True),
        ("gzserver x.world", False),
        ("bash -c 'sleep 5; echo done'", True),
        ("rviz2", False),
        ("/usr/bin/echo hello", True),
    ],
)
def test_which_commands_do_their_work_and_end(tmp_path, command, ends):
    assert process(tmp_path, f'cmd=["{command}"], shell=True').ends is ends


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
