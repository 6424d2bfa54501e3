"""What a launch file finds of ROS and Gazebo on a machine that has neither: programs, packages, Python modules."""

import shutil

import pytest
from launch_files import launch_python, value_of, write, write_package

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate


@pytest.mark.parametrize("program", ["gz", "gazebo", "ros2", "rviz2", "xacro"])
def test_a_launch_file_that_looks_for_a_program_finds_it(tmp_path, program):
    before = f"import shutil\nif shutil.which({program!r}) is None: raise RuntimeError('install it first')"
    assert launch_python(tmp_path, "LogInfo(msg='x')", before).log == ("x",)


def test_a_program_of_the_user_comes_before_the_twins(tmp_path, monkeypatch):
    mine = write(tmp_path / "bin" / "gz", "#!/bin/sh\necho mine\n")
    mine.chmod(0o755)
    monkeypatch.setenv("PATH", str(mine.parent), prepend=":")
    before = "import subprocess\nsaid = subprocess.run(['gz'], capture_output=True, text=True).stdout.strip()"
    assert value_of(tmp_path, "said", before) == "mine"
    assert shutil.which("gz") == str(mine)


def test_gazebo_tells_a_version(tmp_path):
    command = "subprocess.run(['gz', 'sim', '--versions'], capture_output=True, text=True).stdout"
    assert "8" in value_of(tmp_path, "said", f"import subprocess\nsaid = {command}")


XML = "<package format='3'><name>robots</name><version>1.2.3</version><depend>a</depend><depend>b</depend></package>"


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("ros2 pkg xml robots -t version", "1.2.3"),
        ("ros2 pkg xml -t depend robots", "a\nb"),
        ("ros2 pkg xml --tag depend robots", "a\nb"),
        ("ros2 pkg xml robots", XML),
        ("ros2 pkg prefix --share robots", "{share}"),
    ],
)
@pytest.mark.parametrize("how", ["Command", "subprocess"])
def test_ros2_answers_about_a_package(tmp_path, command, answer, how):
    share = write_package(tmp_path, "robots")
    write(share / "package.xml", XML)
    run = f"subprocess.run({command!r}.split(), capture_output=True, text=True, cwd={str(tmp_path)!r}).stdout"
    said = f"Command({command!r})" if how == "Command" else "said"
    text = value_of(tmp_path, said, f"import subprocess\nsaid = {run}" if how == "subprocess" else "")
    assert text.strip() == answer.format(share=share)


def test_ros2_says_which_package_it_does_not_find(tmp_path):
    with pytest.raises(InputError, match="nowhere"):
        launch_python(tmp_path, "LogInfo(msg=Command('ros2 pkg xml nowhere'))")


def test_a_query_that_only_gazebo_could_answer_fails(tmp_path):
    run = "subprocess.run(['gz', 'topic', '-l'], capture_output=True).returncode"
    assert value_of(tmp_path, "str(code)", f"import subprocess\ncode = {run}") == "1"


@pytest.mark.parametrize("command", ["gz sdf -p", "ign sdf --print"])
def test_gazebo_prints_a_robot_for_launch_files_that_edit_it(tmp_path, command):
    """Gazebo makes SDF of it. What is edited there, such as the frame of a direction, is edited in a URDF as well."""
    robot = write(tmp_path / "robot.urdf", "<robot name='r'><fdir1>1 0 0</fdir1></robot>")
    run = f"subprocess.run([*{command!r}.split(), {str(robot)!r}], capture_output=True, text=True, check=True).stdout"
    assert value_of(tmp_path, "said", f"import subprocess\nsaid = {run}") == robot.read_text()


def test_another_command_of_ros2_fails(tmp_path):
    run = "subprocess.run(['ros2', 'topic', 'list'], capture_output=True).returncode"
    assert value_of(tmp_path, "str(code)", f"import subprocess\ncode = {run}") == "1"


def test_euler_angles_are_converted_in_a_launch_file(tmp_path):
    before = "from tf_transformations import quaternion_from_euler\nq = quaternion_from_euler(0, 0, 3.141592653589793)"
    assert value_of(tmp_path, "str([round(float(v), 6) for v in q])", before) == "[0.0, 0.0, 1.0, 0.0]"


def test_a_package_beside_a_repository_with_a_src_of_its_own_is_found(tmp_path):
    other = write_package(tmp_path / "src", "worlds")
    own = write_package(tmp_path / "src" / "repository" / "src", "robots")
    text = "from launch import *\nfrom launch.actions import *\n"
    text += "from ament_index_python.packages import get_package_share_directory\n"
    text += "def generate_launch_description():\n"
    text += "    return LaunchDescription([LogInfo(msg=get_package_share_directory('worlds'))])\n"
    launched = evaluate(write(own / "launch" / "a.launch.py", text), {}, PackageIndex())
    assert launched.log == (str(other),)
