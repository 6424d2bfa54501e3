import json
import re
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from conftest import ROVER

from drake_twin.check import Report, _lines, main
from drake_twin.description.package_index import share_folder
from drake_twin.findings import Finding, Kind

ARM = share_folder("models") / "arduinobot_description" / "urdf" / "arduinobot.urdf.xacro"

SICK = """<robot>
  <link name="a"/>
  <link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><safety_controller k_velocity="1"/></joint>
</robot>"""


def report_of(capsys, *arguments, code=0):
    assert main([*map(str, arguments), "--json"]) == code
    return json.loads(capsys.readouterr().out)


def test_a_healthy_robot_runs_as_it_is(capsys):
    assert main([str(ARM)]) == 0
    text = capsys.readouterr().out
    assert "links: 8; joints: 2 fixed, 5 revolute; degrees of freedom: 5" in text
    assert "actuators: joint_1, joint_2, joint_3, joint_4" in text
    assert "command interfaces: position, velocity: joint_1" in text
    assert "verdict: runs as it is" in text


def test_the_report_counts_weighs_and_lists_as_json(capsys):
    robot = report_of(capsys, ROVER)["robot"]
    assert robot["mass"] == pytest.approx(12 + 4 * 1.2)
    assert robot["degrees_of_freedom"] == 10
    assert len(robot["command_interfaces"]) == 4
    meshes = report_of(capsys, ARM)["robot"]["meshes"]
    assert {file.rpartition("/")[2] for file in meshes} >= {"pedestal.stl", "finger.stl"}
    assert all(size > 0 for size in meshes.values())


def test_every_repair_and_everything_ignored_is_listed_with_its_line(capsys, tmp_path):
    (tmp_path / "sick.urdf").write_text(SICK)
    report = report_of(capsys, tmp_path / "sick.urdf")
    assert [(item["rule"], item["lines"]) for item in report["findings"] if item["kind"] == "mended"] == [
        ("robot_without_name", [1]),
        ("joint_without_limits", [4]),
        ("inertia", [3]),
        ("massless_link", [2]),
    ]
    ignored = [(item["what"], item["lines"]) for item in report["findings"] if item["kind"] == "ignored"]
    assert ignored == [("<safety_controller> in <joint>", [4])]
    assert main([str(tmp_path / "sick.urdf")]) == 0
    assert "verdict: runs, mended" in capsys.readouterr().out


def test_the_report_goes_from_what_failed_to_what_is_replaced():
    """The kinds in their order, and those of one kind in the order of the file."""
    found = tuple(Finding(kind, f"{kind.name.lower()} {number}") for number in (1, 2) for kind in reversed(Kind))
    told = list(_lines(Report("r.urdf", True, None, {}, found)))
    kinds = ("failed", "not started", "ignored", "refused by ROS 2", "warning", "mended", "window")
    assert [line.strip().partition(": ")[0] for line in told[1:-1]] == [kind for kind in kinds for _ in (1, 2)]
    assert [re.findall(r" (\d)", line)[-1] for line in told[1:-1]] == ["1", "2"] * 7
    assert told[0] == "r.urdf"
    assert told[-1] == "  verdict: runs, mended"


def test_a_package_that_wants_no_mending_can_say_so(capsys, tmp_path):
    (tmp_path / "sick.urdf").write_text(SICK)
    report_of(capsys, tmp_path / "sick.urdf", "--strict", code=1)
    (tmp_path / "mended.urdf").write_text(SICK.replace('<safety_controller k_velocity="1"/>', ""))
    report_of(capsys, tmp_path / "mended.urdf", "--strict", code=0)
    report_of(capsys, tmp_path / "mended.urdf", "--strict=mended", code=1)
    report_of(capsys, ARM, "--strict", code=0)
    report_of(capsys, ARM, "--strict=mended", code=0)


def test_a_robot_that_does_not_run_says_why_and_fails(capsys, tmp_path):
    (tmp_path / "broken.urdf").write_text("<robot name='r'><link name='a'/><link name='b'/></robot>")
    report = report_of(capsys, tmp_path / "broken.urdf", code=1)
    assert not report["ok"]
    assert "several have no parent: a, b" in report["error"]


def test_a_missing_file_fails(capsys):
    assert main(["/nowhere/robot.urdf"]) == 1
    assert "/nowhere/robot.urdf: the file does not exist" in capsys.readouterr().out


def test_xacro_arguments_reach_the_file(capsys):
    assert report_of(capsys, ARM, "use_ros2_control:=false")["robot"]["actuators"] == []
    assert main([str(ARM), "use_ros2_control"]) == 2


def test_a_package_folder_that_does_not_exist_is_a_wrong_argument(capsys):
    assert main([str(ARM), "--package-path", "/nowhere"]) == 2
    assert main([str(ARM), "--package-path", "~nobody/there"]) == 2
    assert "the package folder does not exist" in capsys.readouterr().err


def test_view_shows_the_robot_in_a_page_until_it_is_told_to_end():
    process = subprocess.Popen(
        [sys.executable, "-m", "drake_twin.check", str(ARM), "--view", "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    url = next(line for line in process.stdout if line.startswith("page: ")).removeprefix("page: ").strip()
    with urllib.request.urlopen(url) as answer:
        assert answer.status == 200
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode in (0, 1), err
    assert "Traceback" not in err


DROPS = [
    '<gazebo reference="a"><sensor name="s" type="thermal_camera"/></gazebo>',
    '<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"/></gazebo>',
    '<transmission name="t"/>',
    '<gazebo reference="a"><dampingFactor>0.5</dampingFactor></gazebo>',
]


@pytest.mark.parametrize("drop", DROPS)
def test_strict_means_the_same_for_check_and_run(capsys, tmp_path, drop):
    from drake_twin.run import main as run

    file = tmp_path / "robot.urdf"
    for text, code in (("", 0), (drop, 1)):
        file.write_text(f'<robot name="r"><link name="a"/>{text}</robot>')
        assert main([str(file), "--strict"]) == code
        assert run([str(file), "--headless", "--duration", "0.01", "--strict"]) == 2 * code
        said = capsys.readouterr().err
        assert bool(re.search("error: --strict: 1 (ignored|not started), see above", said)) == bool(code)
        assert run([str(file), "--headless", "--duration", "0.01"]) == 0
        assert bool(re.search("(ignored|not started): r: ", capsys.readouterr().err)) == bool(code)


WHOLE = [
    *("models/rover_description/urdf/rover.urdf.xacro", "models/arduinobot_description/urdf/arduinobot.urdf.xacro"),
    *("models/rover_gazebo/launch/main.launch.xml", "models/arduinobot_description/launch/gazebo.launch.py"),
    *("models/arduinobot_description/launch/display.launch.py", "diagrams/rover_and_arm.launch.xml"),
    *("diagrams/rovers_in_formation.launch.py", "diagrams/two_arms.yaml", "diagrams/two_rovers.yaml"),
]


@pytest.mark.parametrize("file", WHOLE)
def test_strict_lets_whole_files_pass(file):
    from drake_twin.run import main as run

    root = Path(__file__).parent.parent
    assert run([str(root / file), "--headless", "--duration", "0.01", "--strict=mended"]) == 0


def test_each_sensor_is_listed_with_kind_topic_frame_rate_and_noise(tmp_path, capsys):
    noise = '<imu><angular_velocity><x><noise type="gaussian"><stddev>0.1</stddev></noise></x></angular_velocity></imu>'
    file = tmp_path / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
        ' iyz="0"/></inertial></link><gazebo reference="base">'
        f'<sensor name="i" type="imu"><update_rate>50</update_rate><topic>imu</topic>{noise}</sensor>'
        '<sensor name="a" type="altimeter"/><sensor name="eye" type="thermal"/></gazebo></robot>'
    )
    assert main([str(file)]) == 0
    said = capsys.readouterr().out
    imu = "sensor i (imu) on base: /r/imu (sensor_msgs/msg/Imu), frame r/base/i, 50 Hz"
    assert f"  {imu}, noise: angular_velocity.x: stddev 0.1" in said
    altimeter = "/r/a/altimeter (ros_gz_interfaces/msg/Altimeter), frame r/base/a, every step, noise: none"
    assert f"  sensor a (altimeter) on base: {altimeter}" in said
    assert "  not started: sensor 'eye' of type thermal on 'base': the twin has no such sensor (r.urdf:1)" in said
    assert main([str(file), "--json"]) == 0
    (first, second) = json.loads(capsys.readouterr().out)["robot"]["sensors"]
    assert (first["topics"], first["rate"]) == ({"/r/imu": "sensor_msgs/msg/Imu"}, 50.0)
    assert second["noise"] == {}
