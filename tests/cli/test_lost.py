"""A spawn, a robot or a world that is lost: said first and last, with exit code 2, unless ``--keep-going``."""

import json
import signal
import subprocess
import sys

import pytest
from launch_files import write
from program_runs import LAUNCH_ARM, ROVER, run, summary_of

from drake_twin.calibrate import main as calibrate
from drake_twin.check import main as check
from drake_twin.cli.lost import check_lost
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Weight
from drake_twin.run import main
from drake_twin.sweep import main as sweep

CREATE = '<node pkg="ros_gz_sim" exec="create" args="{}"/>'
CALL = "<executable cmd=\"ros2 service call /spawn_entity {} '{{name: x}}'\"/>"
CONTROL = '<node pkg="controller_manager" exec="ros2_control_node" namespace="other">{}</node>'
PUBLISHER = '<node pkg="robot_state_publisher" exec="robot_state_publisher" namespace="third"/>'
TEXT = '<param name="robot_description" value="{}"/>'
WORLD = '<executable cmd="gz sim -r {}"/>'
WORLD_SDF = "<sdf version='1.9'><world name='w'>\n{}\n</world></sdf>"

LOST = {
    "spawn of no file": (CREATE.format("-name x -file {folder}/absent.urdf"), "ros_gz_sim/create: "),
    "spawn of a broken file": (CREATE.format("-name x -file {folder}/broken.xml"), "this is not well-formed XML"),
    "spawn without a description": (CREATE.format("-name x"), "one of -topic, -file, -string and -param is needed"),
    "spawn by a call of ROS": (CALL.format("gazebo_msgs/srv/SpawnEntity"), "ros2 (of programs, the twin starts only"),
    "spawn by a call of ROS, too": (CALL.format("simulation_interfaces/srv/SpawnEntity"), "ros2 (of programs"),
    "robot without a description": (CONTROL.format("") + PUBLISHER, "it has no robot_description"),
    "robot that is not XML": (CONTROL.format(TEXT.format("robot")), "this is not well-formed XML"),
    "robot of a broken file": (CONTROL.format(TEXT.format("$(file-content {folder}/broken.xml)")), "well-formed"),
    "world without a file": (WORLD.format("{folder}/absent.sdf"), "absent.sdf' does not exist"),
    "world of a broken file": (WORLD.format("{folder}/broken.xml"), "this is not well-formed XML"),
    "world that is a robot": (WORLD.format("{folder}/robot.sdf"), "a world is an SDF file with a <world>"),
}


def launch(folder, element):
    """Writes a launch file with an arm, and the element in its third line."""
    write(folder / "broken.xml", "<robot name='x'><link")
    write(folder / "robot.sdf", "<sdf version='1.9'><model name='m'/></sdf>")
    inside = element.replace("{folder}", str(folder))
    return write(folder / "main.launch.xml", f'<launch>\n<include file="{LAUNCH_ARM}"/>\n{inside}\n</launch>')


@pytest.mark.parametrize(("element", "words"), LOST.values(), ids=LOST)
def test_what_a_launch_file_loses_is_said_first_and_last(tmp_path, capsys, element, words):
    file = launch(tmp_path, element)
    assert main([str(file), "--headless", "--duration", "0.01"]) == 2
    captured = capsys.readouterr()
    assert captured.out.startswith("1 robot, 0.010 s simulated")
    first, *_, last = captured.err.splitlines()
    assert first.startswith("not started: ")
    assert words in first
    assert first.endswith(f"({file.name}:3)")
    assert last.startswith("error: lost although a file asks for it: ")
    assert words in last
    assert f"{file}:3: " in last
    assert last.endswith(" --keep-going accepts it, with exit code 0.")
    assert captured.err.count("error: ") == 1
    assert main([str(file), "--headless", "--duration", "0.01", "--keep-going"]) == 0
    assert capsys.readouterr().err == captured.err.replace(last + "\n", "")


INCLUDES = {
    "absent": ("<include><uri>model://absent</uri></include>", "these models and packages were not found: absent"),
    "broken": ("<include><uri>broken.xml</uri></include>", "broken.xml is not included: "),
    "elsewhere": ("<include><uri>https://fuel.gazebosim.org/1.0/o/models/m</uri></include>", "downloads nothing"),
    "nameless": ("<model><link name='l'/></model>", "the attribute 'name' is missing"),
    "nowhere": ("<model name='m'><pose relative_to='x'/><link name='l'/></model>", "it is left out"),
    "refused": ("<model name='m'><joint name='j' type='ball'/><link name='l'/></model>", "Drake refuses it"),
}


@pytest.mark.parametrize(("element", "words"), INCLUDES.values(), ids=INCLUDES)
def test_a_model_that_a_world_lacks_is_a_finding(tmp_path, capsys, element, words):
    write(tmp_path / "broken.xml", "<sdf><model")
    file = write(tmp_path / "w.sdf", WORLD_SDF.format(element))
    assert main([str(ROVER), "--robots", "1", "--world", str(file), "--headless", "--duration", "0.01"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line


def test_a_run_that_loses_nothing_and_one_that_lacks_a_mesh_end_with_0(tmp_path):
    mesh = "<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>a.stl</uri></mesh></geometry></visual>"
    file = write(tmp_path / "w.sdf", WORLD_SDF.format(f"{mesh}</link></model>"))
    found = summary_of(tmp_path, ROVER, "--robots", 1, "--world", file, "--duration", 0.01)["findings"]
    assert [item["weight"] for item in found] == ["looks"]


def test_what_is_lost_stays_lost_in_a_saved_scenario_and_in_a_picture(tmp_path, capsys):
    file = launch(tmp_path, LOST["spawn of no file"][0])
    assert main([str(file), "--show-scenario"]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: lost although")
    saved = write(tmp_path / "saved.yaml", captured.out)
    assert main([str(saved), "--headless", "--duration", "0.01"]) == 2
    assert f"{file}:3: ros_gz_sim/create" in capsys.readouterr().err.splitlines()[-1]
    assert main([str(file), "--graphviz", str(tmp_path / "diagram.dot")]) == 2
    assert (tmp_path / "diagram.dot").is_file()
    assert main([str(file), "--show-scenario", "--keep-going"]) == 0


def test_files_of_a_run_that_loses_something_are_written_and_strict_refuses_it(tmp_path, capsys):
    file = launch(tmp_path, LOST["world without a file"][0])
    summary = tmp_path / "summary.json"
    result = run(file, "--headless", "--duration", 0.01, "--summary", summary)
    assert result.returncode == 2
    assert "lost" in [item["weight"] for item in json.loads(summary.read_text())["findings"]]
    assert main([str(file), "--headless", "--duration", "0.01", "--strict", "--keep-going"]) == 2
    assert capsys.readouterr().err.endswith("error: --strict: 1 not started, see above.\n")


def test_a_check_a_sweep_and_a_run_agree(tmp_path, capsys):
    inertial = "<inertial><mass>1</mass></inertial><collision name='c'><geometry><sphere><radius>1</radius></sphere>"
    link = f"<link name='l'>{inertial}</geometry></collision></link>"
    robot = f"<sdf version='1.9'><model name='r'>{link}\n<include><uri>model://absent</uri></include></model></sdf>"
    file = write(tmp_path / "r.sdf", robot)
    assert check([str(file)]) == 2
    captured = capsys.readouterr()
    assert captured.out.endswith("verdict: runs, without what is lost\n")
    assert f"{file}:2: these models and packages were not found: absent" in captured.err
    assert check([str(file), "--keep-going"]) == 0
    table = tmp_path / "table.csv"
    words = [str(file), "--duration", "0.01", "--workers", "1", "--out", str(table)]
    capsys.readouterr()
    assert sweep(words) == 2
    assert f"{file}:2: these models and packages were not found: absent" in capsys.readouterr().err
    assert not table.exists()
    assert sweep([*words, "--keep-going"]) == 0
    assert table.exists()


def test_a_calibration_does_not_begin_with_a_robot_that_is_lost(tmp_path, capsys):
    file = launch(tmp_path, LOST["spawn of no file"][0])
    words = [str(file), "--fit", "arduinobot.joint_1.damping=0.1:1", "--log", str(tmp_path / "absent.json")]
    assert calibrate(words) == 2
    assert capsys.readouterr().err.startswith("error: lost although a file asks for it: ")
    assert calibrate([*words, "--keep-going"]) == 2
    assert "absent.json" in capsys.readouterr().err


def test_a_run_that_is_stopped_by_hand_says_what_is_lost(tmp_path):
    file = launch(tmp_path, LOST["spawn of no file"][0])
    command = [sys.executable, "-m", "drake_twin.run", str(file), "--headless", "--echo", "/clock"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert " s simulated in " in out
    assert err.splitlines()[-1].startswith("error: lost although a file asks for it: ")


def test_of_many_lost_things_a_few_are_told():
    lost = [Finding(Kind.IGNORED, f"m{number}", file="w.sdf", lines=(number,), weight=Weight.LOST) for number in (1, 2)]
    with pytest.raises(InputError, match=r"asks for it: w.sdf:1: m1; w.sdf:2: m2\. --keep-going"):
        check_lost([*lost, *lost, Finding(Kind.FAILED, "other")], keep_going=False)
    many = [Finding(Kind.IGNORED, f"m{number}", weight=Weight.LOST) for number in range(9)]
    with pytest.raises(InputError, match="asks for it: m0; m1; m2; m3; and 5 more, see --findings"):
        check_lost(many, keep_going=False)
