"""Odd input to ``drake_twin.run``, which trial users have stumbled over."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from program_runs import ARM, PUB_1, ROVER, refused, run, summary_of

from drake_twin.run import main


@pytest.mark.parametrize("name", ["clock", "plant", "tf", "scene_graph", "WorldModelInstance"])
def test_a_robot_named_like_a_part_of_the_twin(capsys, tmp_path, name):
    scenario = tmp_path / "twin.yaml"
    scenario.write_text(f"robots:\n  - {{name: {name}, model: {ROVER}}}\n")
    assert f"{scenario}:2: robots.0.name: '{name}' is the name of another part" in refused(capsys, scenario)
    file = tmp_path / "r.urdf"
    file.write_text(f'<robot name="{name}"><link name="world"/></robot>')
    assert main([str(file), "--headless", "--duration", "0.01"]) == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("module", ["pydrake.multibody.plant", "drake_twin.twin.twin"])
def test_ctrl_c_while_it_starts_ends_without_a_traceback(tmp_path, number, module):
    """The signal arrives in the middle of an import, wherever that is."""
    program = f"""
import builtins, os, sys
original = builtins.__import__
def importing(name, *rest, **more):
    if name == {module!r}:
        builtins.__import__ = original
        os.kill(os.getpid(), {int(number)})
    return original(name, *rest, **more)
from drake_twin import run
builtins.__import__ = importing
sys.exit(run.main(["--headless"]))
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert "Traceback" not in result.stderr
    if result.returncode != 130:  # of a machine that is too busy to build the twin soon after the signal
        assert result.returncode == 0
        assert "2 robots, 0.0" in result.stdout


def test_a_cache_that_cannot_be_written_changes_nothing(tmp_path):
    hashes = set()
    for cache in (tmp_path, Path("/proc/nowhere"), Path("relative")):
        file = tmp_path / "out.json"
        result = run(ARM, "--headless", "--duration", 0.2, "--summary", file, XDG_CACHE_HOME=str(cache), HOME="/proc")
        assert result.returncode == 0, result.stderr
        assert result.stderr == ""
        hashes.add(json.loads(file.read_text())["state_sha256"])
    assert len(hashes) == 1


def test_a_free_robot_without_collision_shapes_is_warned_of(tmp_path):
    file = tmp_path / "ghost.urdf"
    file.write_text('<robot name="ghost"><link name="a"><inertial><mass value="1"/></inertial></link></robot>')
    warnings = summary_of(tmp_path, file, "--duration", 0.01)["warnings"]
    assert "ghost: the robot has no collision shape: it falls through the ground" in warnings


def test_substitutions_work_without_xacros_namespace(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="world"/><link name="a"/><joint name="j" type="fixed"><parent link="world"/>'
        '<child link="a"/></joint><gazebo><plugin filename="gz_ros2_control-system" name="x"><parameters>'
        "$(find arduinobot_description)/config/none.yaml</parameters></plugin></gazebo></robot>"
    )
    result = run(file, "--headless", "--duration", 0.1)
    assert "arduinobot_description/config/none.yaml: the file does not exist" in result.stderr
    assert "$(find" not in result.stderr


def test_a_misspelt_xacro_argument_is_warned_of(tmp_path):
    (warning,) = summary_of(tmp_path, ARM, "ros2_control:=false", "--duration", 0.01)["warnings"]
    assert "has no xacro argument 'ros2_control' (it has use_ros2_control)" in warning


def test_limits_that_leave_no_velocity_keep_a_controller_from_starting(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="world"/><link name="a"><inertial><mass value="1"/></inertial></link><joint'
        ' name="j" type="continuous"><parent link="world"/><child link="a"/><limit velocity="2" effort="9"/></joint>'
        '<ros2_control name="s" type="system"><joint name="j"><command_interface name="velocity"><param name="min">5'
        "</param></command_interface></joint></ros2_control></robot>"
    )
    result = summary_of(tmp_path, file, "--duration", 0.1)
    assert "the URDF and <ros2_control> limits of velocity do not overlap" in result["not_started"][0]
    assert result["robots"]["r"]["velocities"] == pytest.approx([0], abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (["--port", "80"], "--port 80: the page's port must be from 1024 to 65535"),
        (["--duration", "1e308"], "--duration 1e+308: the value must be above zero, and 1e+09 at most"),
        (["--time-step", "1e-320"], "s is out of bounds: valid are"),
        (["--time-step", "10"], "10 s is out of bounds: valid are 1e-06 s to 0.1 s"),
        ([*PUB_1, "[" + "9" * 400 + ", 1, 1, 1]"], "the data must be a list of numbers"),
        ([*PUB_1, '"2222"'], "the data must be a list of numbers"),
        ([*PUB_1, "[true, 1, 1, 1]"], "the data must be a list of numbers"),
        (["~nobody/x.urdf"], "the file does not exist"),
        (["x" * 300 + ".urdf"], "this is not a file's name"),
        (["/dev/zero"], "/dev/zero: this is not a file: a robot file is needed"),
        (["/"], "expected a robot file, but this is a folder"),
    ],
    ids=lambda value: value[-1][:20] if isinstance(value, list) else "",
)
def test_an_odd_argument(capsys, arguments, match):
    assert main([*arguments, "--headless", *([] if "--duration" in arguments else ["--duration", "0.1"])]) == 2
    captured = capsys.readouterr()
    assert match in captured.err
    assert captured.err.count("\n") == 1


def test_an_address_that_this_machine_does_not_have():
    result = run("--host", "300.1.1.1", "--duration", 0.1, "--no-browser")
    assert result.returncode == 2
    assert "no page can be served at '300.1.1.1'" in result.stderr


def test_a_summary_that_cannot_be_written_is_a_failure_and_the_result_is_still_printed():
    result = run("--headless", "--duration", 0.1, "--summary", "/dev/full")
    assert result.returncode == 1
    assert "the summary /dev/full cannot be written" in result.stderr
    assert "2 robots" in result.stdout


def test_a_terminal_without_the_letters_of_the_help():
    result = run("--help", PYTHONIOENCODING="ascii")
    assert result.returncode == 0, result.stderr


def test_a_floating_joint_to_the_world_leaves_the_robot_free(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="world"/><link name="a"><inertial><mass value="1"/></inertial><collision><geometry>'
        '<sphere radius="0.1"/></geometry></collision></link><joint name="j" type="floating"><parent link="world"/>'
        '<child link="a"/></joint></robot>'
    )
    robots = summary_of(tmp_path, file, "--robots", 2, "--duration", 0.5)["robots"]
    assert robots["robot_1"]["base_pose"][2] == pytest.approx(0.1, abs=0.002)
    assert robots["robot_2"]["base_pose"][1] > 0.4
