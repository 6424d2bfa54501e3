"""What ``drake_twin.run`` runs, and how it ends."""

import json
import signal
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request

import pytest
from program_runs import ARM, PUB_1, ROVER, refused, run, summary_of

from drake_twin.description.package_index import share_folder
from drake_twin.run import main


def test_two_rovers_drive_from_any_folder(tmp_path):
    result = run("--robots", 2, "--headless", "--duration", 1, "--summary", "out.json", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert result.stdout.startswith("2 robots, 1.000 s simulated in ")
    robots = json.loads((tmp_path / "out.json").read_text())["robots"]
    assert all(abs(velocity) > 1 for robot in robots.values() for velocity in robot["velocities"])


def test_the_summary_holds_what_it_promises(tmp_path):
    result = summary_of(tmp_path, "--duration", 0.5)
    assert result["sim_time"] == pytest.approx(0.5)
    assert result["steps"] == 500
    assert result["time_step"] == 0.001
    assert result["real_time_factor"] == pytest.approx(result["sim_time"] / result["wall_time"])
    assert list(result["robots"]) == ["robot_1", "robot_2"]
    robot = result["robots"]["robot_1"]
    assert len(robot["joints"]) == len(robot["positions"]) == len(robot["velocities"]) == len(robot["efforts"]) == 4
    assert len(robot["base_pose"]) == 7
    assert result["topics"]["/clock"] == "rosgraph_msgs/msg/Clock"
    assert result["warnings"] == result["not_started"] == []
    assert len(result["state_sha256"]) == 64


def test_two_processes_end_in_the_same_bits(tmp_path):
    hashes = set()
    for index in range(2):
        file = tmp_path / f"{index}.json"
        assert run("--robots", 2, "--headless", "--duration", 2, "--summary", file).returncode == 0
        hashes.add(json.loads(file.read_text())["state_sha256"])
    assert len(hashes) == 1


def test_a_run_through_the_printed_scenario_ends_in_the_same_bits(tmp_path, capsys):
    arguments = ["--robots", "3", *PUB_1, "[2, 2, 2, 2]", "--time-step", "0.002"]
    assert main([*arguments, "--show-scenario"]) == 0
    (tmp_path / "twin.yaml").write_text(capsys.readouterr().out)
    direct = summary_of(tmp_path, *arguments, "--duration", 1)
    saved = summary_of(tmp_path, tmp_path / "twin.yaml", "--duration", 1)
    assert saved["state_sha256"] == direct["state_sha256"]


def test_pub_moves_that_robot_and_no_other(tmp_path):
    robots = summary_of(tmp_path, "--robots", 2, *PUB_1, "[2, 2, 2, 2]", "--duration", 1)["robots"]
    assert robots["robot_1"]["velocities"] == pytest.approx([2] * 4, rel=0.005)
    assert robots["robot_2"]["velocities"] == pytest.approx([0] * 4, abs=1e-6)


def test_pub_takes_data_as_ros2_topic_pub_does(tmp_path):
    robots = summary_of(tmp_path, "--robots", 1, *PUB_1, "{data: [2, 2, 2, 2]}", "--duration", 1)["robots"]
    assert robots["robot_1"]["velocities"] == pytest.approx([2] * 4, rel=0.005)


def test_the_arms_wave(tmp_path):
    robots = summary_of(tmp_path, "--robot", "arduinobot", "--robots", 2, "--duration", 1)["robots"]
    assert robots["robot_1"]["positions"][0] == pytest.approx(0.5, abs=0.02)
    assert robots["robot_2"]["positions"][0] == pytest.approx(-0.5, abs=0.02)


def test_a_robot_file_with_its_arguments(tmp_path):
    result = summary_of(tmp_path, ARM, "use_ros2_control:=false", "--duration", 2)
    assert result["robots"]["arduinobot"]["positions"][2] > 0.5  # it droops


def test_three_of_a_robot_file_in_a_row(tmp_path):
    robots = summary_of(tmp_path, ROVER, "--robots", 3, "--duration", 0.2)["robots"]
    assert list(robots) == ["robot_1", "robot_2", "robot_3"]
    assert robots["robot_3"]["joints"][0] == "robot_3_front_left_wheel_joint"
    assert robots["robot_3"]["base_pose"][1] > robots["robot_2"]["base_pose"][1] > robots["robot_1"]["base_pose"][1]


@pytest.mark.parametrize("name", sorted(file.name for file in share_folder("diagrams").glob("*.yaml")))
def test_the_ready_made_twins_run_from_any_folder(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    assert summary_of(tmp_path, f"diagrams/{name}", "--duration", 0.2)["sim_time"] == pytest.approx(0.2)


def test_an_sdf_robot_runs(tmp_path):
    file = tmp_path / "ball.sdf"
    file.write_text(
        '<sdf version="1.7"><model name="ball"><link name="body"><inertial><mass>1</mass></inertial><collision'
        ' name="c"><geometry><sphere><radius>0.2</radius></sphere></geometry></collision></link></model></sdf>'
    )
    result = summary_of(tmp_path, file, "--duration", 0.5)
    assert result["robots"]["ball"]["base_pose"][2] == pytest.approx(0.2, abs=0.002)


def test_other_peoples_arm_with_its_own_meshes_holds(tmp_path, corpus):
    (file,) = corpus.glob("arduinobot/**/arduinobot.urdf.xacro")
    result = summary_of(tmp_path, file, "--duration", 2)
    assert result["robots"]["arduinobot"]["positions"] == pytest.approx([0] * 5, abs=0.01)
    assert result["not_started"] == []
    assert "/arduinobot/arm_controller/joint_trajectory" in result["topics"]


def test_other_peoples_rover_drives_by_its_own_parameters_file(tmp_path, corpus):
    (file,) = corpus.glob("bumperbot/**/bumperbot.urdf.xacro")
    topic = "/bumperbot/bumperbot_controller/cmd_vel"
    result = summary_of(tmp_path, file, "--pub", topic, "{twist: {linear: {x: 0.1}}}", "--duration", 1)
    robot = result["robots"]["bumperbot"]
    # For the half second that a command holds; the file's limits of ±1 rad/s are not in force without a parameter.
    assert robot["base_pose"][0] == pytest.approx(0.1 * 0.5, rel=0.1)
    (conflict,) = result["not_started"]
    assert "simple_velocity_controller: resource conflict" in conflict


# --- how it ends


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_ends_with_a_summary_and_success(tmp_path, number):
    file = tmp_path / "out.json"
    process = subprocess.Popen(
        [sys.executable, "-m", "drake_twin.run", "--no-browser", "--summary", str(file)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline().startswith("page: http://127.0.0.1:")
    process.send_signal(number)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 0, err
    assert "2 robots" in out
    assert "Traceback" not in err
    assert json.loads(file.read_text())["robots"]


def test_the_printed_address_opens_the_page_and_without_its_key_nothing_else_is_served():
    process = subprocess.Popen(
        [sys.executable, "-m", "drake_twin.run", "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    url = process.stdout.readline().removeprefix("page: ").strip()
    with urllib.request.urlopen(url) as answer:
        assert "<title>drake_twin" in answer.read().decode()
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(url.replace("#", ""))
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 0, err


def test_a_run_is_saved_as_a_page_and_goes_as_it_would_without(tmp_path):
    page = tmp_path / "run.html"
    recorded = summary_of(tmp_path, "--robots", 2, "--duration", 0.5, "--save-html", page)
    plain = summary_of(tmp_path, "--robots", 2, "--duration", 0.5)
    assert recorded["state_sha256"] == plain["state_sha256"]
    text = page.read_text()
    assert text.startswith("<!doctype html>")
    assert len(text) > 1_000_000  # with everything that it needs
    assert 'src="http' not in text


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (["--save-html", "/nowhere/run.html"], "--save-html /nowhere/run.html: no file can be written there"),
        (["--save-html", "run.html", "--watch"], "--save-html records one run: it cannot be combined with --watch"),
    ],
)
def test_a_page_that_cannot_be_saved_is_refused_before_the_run(capsys, arguments, match):
    assert match in refused(capsys, *arguments)


def test_help_shows_every_option(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--help"])
    assert end.value.code == 0
    text = capsys.readouterr().out
    for option in ("--robots", "--headless", "--duration", "--summary", "--pub", "--show-scenario", "--graphviz"):
        assert option in text


def test_the_console_script_runs_the_same_program(tmp_path):
    command = [sys.executable, "-m", "drake_twin", "run", "--headless", "--duration", "0.1"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    unknown = subprocess.run([sys.executable, "-m", "drake_twin", "fly"], capture_output=True, text=True, check=False)
    assert unknown.returncode == 2
    assert "unknown program 'fly'" in unknown.stderr


def test_the_page_listens_at_this_machine_only():
    from drake_twin.cockpit.served_page import ServedPage

    page = ServedPage()
    own = subprocess.run(["ss", "-ltn"], capture_output=True, text=True, check=False)
    port = page.server.access.port
    if own.returncode == 0:
        lines = [line for line in own.stdout.splitlines() if f":{port} " in line]
        assert lines
        assert all(f"127.0.0.1:{port}" in line for line in lines)
    assert page.url.startswith("http://127.0.0.1:")
    page.close()


def test_ctrl_c_while_many_robots_are_built_ends_at_once_and_says_nothing(tmp_path):
    program = """
import os, signal, sys
from drake_twin import progress, run
from drake_twin.cli import build_line
build_line._PATIENCE = 0.0
original, count = progress.tell, 0
def tell(what):
    global count
    count += 1
    if count == 5:
        os.kill(os.getpid(), signal.SIGINT)
    print(what)
    original(what)
progress.tell = tell
sys.exit(run.main(["--robots", "500", "--headless"]))
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 130
    assert result.stderr == ""
    assert len(result.stdout.splitlines()) in (5, 6, 7)  # steps
