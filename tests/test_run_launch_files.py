"""Launch files that ``drake_twin.run`` runs."""

import json
import os
import sys
from pathlib import Path

import pytest
from program_runs import LAUNCH_ARM, MODELS, PUB_1, ROVER, refused, run, summary_of

from drake_twin.run import main

LAUNCH_ROVERS = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"
DISPLAY_ARM = MODELS / "arduinobot_description" / "launch" / "display.launch.py"


def test_the_rovers_launch_file_runs_and_lists_topics_and_controllers():
    result = run(LAUNCH_ROVERS, "--headless", "--duration", 0.1, "--topics", "--controllers")
    assert (result.returncode, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    for line in (
        "/clock [rosgraph_msgs/msg/Clock]",
        "/robot_1/joint_states [sensor_msgs/msg/JointState]",
        "/robot_2/forward_velocity_controller/commands [std_msgs/msg/Float64MultiArray]",
        "/robot_1_robot_description [std_msgs/msg/String]",
        "/tf [tf2_msgs/msg/TFMessage]",
        "/tf_static [tf2_msgs/msg/TFMessage]",
        "/robot_1/controller_manager:",
        "  forward_velocity_controller forward_command_controller/ForwardCommandController active",
    ):
        assert line in lines
    assert lines[-1].startswith("2 robots, 0.100 s simulated in ")


def test_pub_moves_one_of_the_launched_rovers(tmp_path):
    robots = summary_of(tmp_path, LAUNCH_ROVERS, *PUB_1, "[2, 2, 2, 2]", "--duration", 1)["robots"]
    assert robots["robot_1"]["velocities"] == pytest.approx([2] * 4, rel=0.005)
    assert robots["robot_1"]["base_pose"][0] > 0.15
    assert robots["robot_2"]["velocities"] == pytest.approx([0] * 4, abs=1e-6)
    assert robots["robot_2"]["base_pose"][:2] == pytest.approx([0, 2], abs=1e-6)


def test_the_arms_launch_file_runs(tmp_path):
    result = summary_of(tmp_path, LAUNCH_ARM, "--duration", 0.2)
    assert list(result["robots"]) == ["arduinobot"]
    assert {"/joint_states", "/robot_description", "/tf", "/clock"} <= set(result["topics"])
    assert result["not_started"] == []


def test_a_launch_saved_as_a_scenario_ends_in_the_same_bits_as_in_another_process(tmp_path, capsys):
    rovers = [str(LAUNCH_ROVERS), *PUB_1, "[1, 1, 1, 1]"]
    assert main([*rovers, "--show-scenario"]) == 0
    (tmp_path / "twin.yaml").write_text(capsys.readouterr().out)
    summary_of(tmp_path, LAUNCH_ARM, "--duration", 0.1)  # another launch file goes before, in this process
    hashes = {summary_of(tmp_path, *rovers, "--duration", 0.3)["state_sha256"]}
    file = tmp_path / "out.json"
    assert run(tmp_path / "twin.yaml", "--headless", "--duration", 0.3, "--summary", file).returncode == 0
    hashes.add(json.loads(file.read_text())["state_sha256"])
    assert run(*rovers, "--headless", "--duration", 0.3, "--summary", file, cwd=tmp_path).returncode == 0
    hashes.add(json.loads(file.read_text())["state_sha256"])
    assert len(hashes) == 1


def launch_arm(folder: Path, elements: str = "") -> Path:
    file = folder / "arm.launch.xml"
    file.write_text(f'<launch><include file="{LAUNCH_ARM}"/>{elements}</launch>')
    return file


IN_VAIN = "<executable cmd=\"ros2 topic pub --once /nobody std_msgs/msg/Float64MultiArray '{data: [1]}'\"/>"


def test_a_saved_launch_runs_also_where_it_publishes_in_vain(tmp_path, capsys):
    file = launch_arm(tmp_path, IN_VAIN)
    direct = summary_of(tmp_path, file, "--duration", 0.1)
    capsys.readouterr()
    assert main([str(file), "--show-scenario"]) == 0
    (tmp_path / "twin.yaml").write_text(capsys.readouterr().out)
    saved = summary_of(tmp_path, tmp_path / "twin.yaml", "--duration", 0.1)
    assert saved["state_sha256"] == direct["state_sha256"]
    assert saved["not_started"] == direct["not_started"]
    assert "ros2 topic pub /nobody" in saved["not_started"][0]


def test_a_launch_file_leaves_no_trace(tmp_path, capsys):
    file = tmp_path / "nasty.launch.py"
    file.write_text(
        "import os, sys\nfrom launch import LaunchDescription\nfrom launch.actions import IncludeLaunchDescription\n"
        "os.environ['NASTY'] = '1'\nos.environ.pop('HOME', None)\nos.chdir('/')\nsys.path.insert(0, '/nasty')\n"
        "def generate_launch_description():\n"
        f"    return LaunchDescription([IncludeLaunchDescription({str(LAUNCH_ARM)!r})])\n"
    )
    main([str(launch_arm(tmp_path)), "--headless", "--duration", "0.01"])  # what the twin itself loads is loaded

    def traces():
        foreign = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python", "ros_gz_sim")
        loaded = {name for name in sys.modules if name.partition(".")[0] in foreign or "nasty" in name}
        return dict(os.environ), list(sys.path), os.getcwd(), loaded

    before = traces()
    assert main([str(file), "--headless", "--duration", "0.01"]) == 0
    assert traces() == before
    file.write_text(file.read_text().replace("return Launch", "raise ValueError('x')\n    return Launch"))
    assert main([str(file), "--headless", "--duration", "0.01"]) == 2
    assert traces() == before
    assert "ValueError: x" in capsys.readouterr().err


def test_a_display_runs_without_physics_and_publishes_joint_states(tmp_path, capsys):
    result = summary_of(tmp_path, DISPLAY_ARM, "--duration", 0.1, "--echo", "/joint_states")
    assert result["robots"]["arduinobot"]["positions"] == pytest.approx([0] * 5)
    assert [item["what"] for item in result["findings"]] == ["rviz2/rviz2 (the page shows the robots)"]
    assert "name:\n- joint_1\n" in capsys.readouterr().out


def test_echo_prints_messages_and_an_unknown_topic_is_refused(tmp_path, capsys):
    assert main([str(LAUNCH_ARM), "--headless", "--duration", "0.03", "--echo", "/clock"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("clock:\n  sec: 0\n  nanosec: 0\n---\nclock:\n  sec: 0\n  nanosec: 1000000\n---\n")
    assert "nothing is published on '/clok'. Did you mean '/clock'?" in refused(capsys, LAUNCH_ARM, "--echo", "/clok")


def test_show_args_prints_them_and_ends(capsys):
    assert main([str(LAUNCH_ARM), "--show-args"]) == 0
    out = capsys.readouterr().out
    assert "'model':" in out
    assert "Absolute path of the robot's xacro file" in out
    assert "arduinobot.urdf.xacro" in out
    assert "--show-args needs a launch file" in refused(capsys, ROVER, "--show-args")


def test_strict_refuses_what_is_not_started(tmp_path, capsys):
    file = launch_arm(tmp_path, '<node pkg="rviz2" exec="rviz2"/><node pkg="foo" exec="bar"/>')
    assert main([str(file), "--headless", "--duration", "0.1"]) == 0
    assert capsys.readouterr().err == (
        "not started: foo/bar (it is not a Python program of the workspace: publish its messages by --pub, or run a"
        " node by --node)"
        f" ({file.name}:1)\n"
        f"window: rviz2/rviz2 (the page shows the robots) ({file.name}:1)\n"
    )
    assert main([str(file), "--headless", "--duration", "0.1", "--strict"]) == 2
    assert "error: --strict: 1 not started, see above." in capsys.readouterr().err
    assert main([str(LAUNCH_ARM), "--headless", "--duration", "0.1", "--strict"]) == 0


def test_a_simulator_that_starts_paused_runs_all_the_same_without_a_page(tmp_path, capsys):
    file = tmp_path / "paused.launch.py"
    file.write_text(LAUNCH_ARM.read_text().replace(" -v 4 -r empty.sdf ", "empty.sdf"))
    assert summary_of(tmp_path, file, "--duration", 0.1)["sim_time"] == pytest.approx(0.1)
    said = "launch: the simulator starts paused there (gz without -r, gzserver with --pause): it runs all the same\n"
    assert capsys.readouterr().err == said


def test_a_launch_file_that_starts_no_robot_is_one_paragraph(capsys):
    folder = MODELS / "rover_gazebo" / "launch"
    assert "start_world.launch.py: the launch file starts no robot" in refused(capsys, folder / "start_world.launch.py")
    error = refused(capsys, folder / "start_control.launch.py")
    controllers = "joint_state_broadcaster, forward_velocity_controller, drive_controller"
    assert f"starts no robot for its controllers ({controllers})" in error


def test_a_run_tells_a_few_findings_and_all_where_asked_to(tmp_path, capsys):
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    link = f"<link name='l'><inertial><mass value='1'/>{inertia}</inertial></link>"
    odd = "".join(f"<odd{number}/>" for number in range(9))
    (tmp_path / "r.urdf").write_text(f"<robot name='r'>{link}{odd}</robot>")
    told = {}
    for option in ("--headless", "--findings"):
        assert main([str(tmp_path / "r.urdf"), "--headless", "--duration", "0.01", option]) == 0
        told[option] = [line for line in capsys.readouterr().err.splitlines() if "launch:" not in line]
    for option, count in (("--headless", 3), ("--findings", 9)):
        assert [f"<odd{number}>" in "".join(told[option]) for number in range(9)] == [n < count for n in range(9)]
    assert "; and 6 more" in told["--headless"][0]
