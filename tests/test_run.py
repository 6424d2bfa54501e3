import json
import os
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

import pytest

from drake_twin.cli.watched_files import Watch
from drake_twin.description.package_index import share_folder
from drake_twin.run import main

MODELS = share_folder("models")
ROVER = MODELS / "rover_description" / "urdf" / "rover.urdf.xacro"
ARM = MODELS / "arduinobot_description" / "urdf" / "arduinobot.urdf.xacro"
PUB_1 = ["--pub", "/robot_1/forward_velocity_controller/commands"]


def run(*arguments, cwd=None, **environment):
    return subprocess.run(
        [sys.executable, "-m", "drake_twin.run", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=os.environ | environment,
        timeout=120,
        check=False,
    )


def summary_of(tmp_path, *arguments):
    file = tmp_path / "summary.json"
    assert main([*map(str, arguments), "--headless", "--summary", str(file)]) == 0
    return json.loads(file.read_text())


# --- what it runs


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
    # Wheels of 33 mm that its <ros2_control> limits to 1 rad/s, for the half second that a command holds.
    assert robot["base_pose"][0] == pytest.approx(0.033 * 1.0 * 0.5, rel=0.25)
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


def test_the_printed_address_opens_the_page_and_without_its_token_nothing_is_served():
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
        urllib.request.urlopen(urllib.parse.urljoin(url, "/"))
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
        (["--save-html", "run.html", "--watch"], "--save-html records one run: it does not go with --watch"),
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
    assert "there is no program 'fly'" in unknown.stderr


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


# --- bad input: one paragraph, exit code 2, no traceback


def refused(capsys, *arguments):
    assert main([*map(str, arguments), "--headless", "--duration", "0.1"]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err


def test_a_missing_file(capsys):
    assert "/nowhere/robot.urdf: there is no such file" in refused(capsys, "/nowhere/robot.urdf")
    assert "nowhere.yaml: the scenario cannot be read" in refused(capsys, "nowhere.yaml")
    assert "package 'nowhere' is in none of:" in refused(capsys, "package://nowhere/a.urdf")


def test_broken_xml_is_named_with_its_line(capsys, tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text('<robot name="r">\n  <link name="a">\n</robot>\n')
    assert f"{file}:3: this is not well-formed XML" in refused(capsys, file)


def test_a_xacro_error_is_named_with_its_file(capsys, tmp_path):
    file = tmp_path / "r.urdf.xacro"
    file.write_text('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${nothing}"/></robot>')
    message = refused(capsys, file)
    assert str(file) in message
    assert "nothing" in message


def test_an_unknown_package_in_a_xacro_file(capsys, tmp_path):
    file = tmp_path / "r.urdf.xacro"
    file.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find no_such_package)/a.xacro"/></robot>'
    )
    assert "package 'no_such_package' is in none of:" in refused(capsys, file)


def test_an_unknown_joint_in_the_parameters_file(capsys, tmp_path):
    original = MODELS / "arduinobot_description" / "config" / "arduinobot_controllers.yaml"
    parameters = tmp_path / "controllers.yaml"
    parameters.write_text(original.read_text().replace("- joint_2", "- joint_22"))
    scenario = tmp_path / "twin.yaml"
    scenario.write_text(f"robots:\n  - {{name: arm, model: {ARM}, controllers: [controllers.yaml]}}\n")
    message = refused(capsys, scenario)
    assert f"{parameters}:16: " in message
    assert "no joint 'joint_22'" in message
    assert "Valid: joint_1, joint_2" in message


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (
            "[1, 2, 3]",
            "the command has 3 elements, but there are 4 command interfaces: robot_1_front_left_wheel_joint/velocity,",
        ),
        ("[1, .nan, 3, 4]", "robot_1_front_right_wheel_joint/velocity is nan, which is not a finite number"),
        ("[1, .inf, 3, 4]", "is inf, which is not a finite number"),
        ("fast", "the data must be a list of numbers"),
        ("[a, b]", "the data must be a list of numbers"),
        ("[1, 2", "the data must be a list of numbers"),
    ],
)
def test_a_wrong_command(capsys, data, match):
    assert match in refused(capsys, *PUB_1, data)


def test_a_command_that_nobody_listens_to(capsys):
    message = refused(capsys, "--pub", "/robot_9/forward_velocity_controller/commands", "[1]")
    assert "nothing listens to '/robot_9/forward_velocity_controller/commands'" in message
    assert "Valid: /robot_1/forward_velocity_controller/commands" in message


def test_a_wrong_command_in_a_scenario_is_named_with_its_line(capsys, tmp_path):
    scenario = tmp_path / "twin.yaml"
    scenario.write_text(
        f"robots:\n  - {{name: r, model: {ROVER}}}\ncommands:\n"
        "  - {topic: /r/forward_velocity_controller/commands, data: [1]}\n"
    )
    assert f"{scenario}:4: commands.0: " in refused(capsys, scenario)


def test_two_robots_of_one_name(capsys, tmp_path):
    scenario = tmp_path / "twin.yaml"
    scenario.write_text(f"robots:\n  - {{name: r, model: {ROVER}}}\n  - {{name: r, model: {ROVER}}}\n")
    assert f"{scenario}:3: robots.1.name: two robots are named 'r'" in refused(capsys, scenario)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (["--robots", "0"], "--robots 0: a twin needs at least one robot"),
        (["--robots", "-1"], "--robots -1: a twin needs at least one robot"),
        (["--robots", "two"], "argument --robots: invalid int value: 'two'"),
        (["--time-step", "-0.001"], "--time-step -0.001: the value must be above zero"),
        (["--time-step", "nan"], "--time-step nan: the value must be above zero"),
        (["--real-time-rate", "0"], "--real-time-rate 0: the value must be above zero"),
        (["--robot", "car"], "--robot car: the twin has no such robot of its own. Valid: rover, arduinobot"),
        (["--summary", "/nowhere/out.json"], "--summary /nowhere/out.json: no file can be written there"),
        (["--port", "0"], "--port 0: the page's port is a number from 1024 to 65535"),
        (["--fly"], "unrecognized arguments: --fly (--help lists the options)"),
        (["a.urdf", "b.urdf"], "one scenario or robot file can be run at a time, but there are a.urdf, b.urdf"),
        (["x:=1"], "x:=1: xacro arguments need a robot file to go to"),
        (["--package-path", "/nowhere"], "/nowhere: the package folder does not exist"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_option(capsys, arguments, match):
    assert match in refused(capsys, *arguments)


def test_a_busy_port():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        result = run("--port", port, "--duration", 0.1, "--no-browser")
    assert result.returncode == 2
    assert f"port {port} of 127.0.0.1 cannot be used" in result.stderr
    assert "Traceback" not in result.stderr


def test_debug_shows_the_traceback():
    result = run("/nowhere/robot.urdf", "--headless", "--debug")
    assert "Traceback" in result.stderr


def test_the_same_warning_about_several_robots_is_printed_once(tmp_path):
    text = ARM.read_text().replace('<material name="steel"><color', '<material name="stel"><color')
    for name in ("arm_links.xacro", "arduinobot.ros2_control.xacro", "arduinobot.gazebo.xacro"):
        (tmp_path / name).write_text((ARM.parent / name).read_text())
    (tmp_path / "arm.urdf.xacro").write_text(text)
    result = run(Path("arm.urdf.xacro"), "--robots", 3, "--headless", "--duration", 0.01, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stderr.count("'steel' is not defined") == 1
    assert "mended: robot_1, robot_2, robot_3: " in result.stderr


# --- what a trial user stumbled over


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
    assert "arduinobot_description/config/none.yaml: there is no such file" in result.stderr
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
        (["--port", "80"], "--port 80: the page's port is a number from 1024 to 65535"),
        (["--duration", "1e308"], "--duration 1e+308: the value must be above zero, and 1e+09 at most"),
        (["--time-step", "1e-320"], "is no step that simulates robots"),
        (["--time-step", "10"], "10 s is no step that simulates robots: valid are 1e-06 s to 0.1 s"),
        ([*PUB_1, "[" + "9" * 400 + ", 1, 1, 1]"], "the data must be a list of numbers"),
        ([*PUB_1, '"2222"'], "the data must be a list of numbers"),
        ([*PUB_1, "[true, 1, 1, 1]"], "the data must be a list of numbers"),
        (["~nobody/x.urdf"], "there is no such file"),
        (["x" * 300 + ".urdf"], "this is not a file's name"),
        (["/dev/zero"], "/dev/zero: a robot file is needed, and this is none"),
        (["/"], "a robot file is needed, and this is a folder"),
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


# --- worlds


CRATE_WORLD = """<sdf version="1.9"><world name="w"><gravity>0 0 -3</gravity>
<physics type="ode"><max_step_size>0.002</max_step_size></physics><gui/>
<include><uri>model://ground_plane</uri></include>
<model name="crate"><pose>3 0 1 0 0 0</pose><link name="l"/></model></world></sdf>"""


@pytest.fixture
def crate_world(tmp_path) -> Path:
    (tmp_path / "crate.world").write_text(CRATE_WORLD)
    return tmp_path / "crate.world"


def test_robots_stand_in_the_world_of_a_file_at_its_own_step(tmp_path, crate_world, capsys):
    result = summary_of(tmp_path, "--robots", 2, "--duration", 0.5, "--world", crate_world)
    assert (result["time_step"], result["steps"]) == (0.002, 250)
    assert all(robot["base_pose"][2] == pytest.approx(0.13, abs=0.01) for robot in result["robots"].values())
    assert result["warnings"] == []
    assert [(item["kind"], item["what"]) for item in result["findings"]] == [("window", "<gui> of the world")]
    assert "window: <gui> of the world (crate.world:2)" in capsys.readouterr().err


def test_a_step_that_is_typed_goes_before_the_worlds(tmp_path, crate_world):
    result = summary_of(tmp_path, ROVER, "--duration", 0.1, "--world", crate_world, "--time-step", 0.001)
    assert result["time_step"] == 0.001


def test_a_world_is_part_of_the_printed_scenario(tmp_path, crate_world, capsys):
    assert main(["--robots", "1", "--world", str(crate_world), "--show-scenario"]) == 0
    text = capsys.readouterr().out
    assert f"world:\n  file: {crate_world}\n" in text
    (tmp_path / "twin.yaml").write_text(text.replace(str(crate_world), "crate.world"))
    assert summary_of(tmp_path, tmp_path / "twin.yaml", "--duration", 0.1)["time_step"] == 0.002


@pytest.mark.parametrize(
    ("name", "what"), [("gone.world", "there is no world file"), ("shapes.sdf", "only some are built in")]
)
def test_a_world_that_is_not_there_ends_in_a_paragraph(tmp_path, capsys, name, what):
    assert main(["--robots", "1", "--headless", "--duration", "1", "--world", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert what in error
    assert "Traceback" not in error


# --- launch files

LAUNCH_ROVERS = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"
LAUNCH_ARM = MODELS / "arduinobot_description" / "launch" / "gazebo.launch.py"
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
    assert out.startswith("clock:\n  sec: 0\n  nanosec: 0\n---\nclock:\n  sec: 0\n  nanosec: 10000000\n---\n")
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
        "not started: foo/bar (the twin runs no nodes: publish its messages by --pub or Twin.publish)"
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
    said = "launch: the simulator starts paused there (gz without -r): it runs all the same\n"
    assert capsys.readouterr().err == said


def test_a_launch_file_that_starts_no_robot_is_one_paragraph(capsys):
    folder = MODELS / "rover_gazebo" / "launch"
    assert "start_world.launch.py: the launch file starts no robot" in refused(capsys, folder / "start_world.launch.py")
    error = refused(capsys, folder / "start_control.launch.py")
    assert "starts no robot for its controllers (joint_state_broadcaster, forward_velocity_controller)" in error


# --- --watch, with the edits made where the loop looks for them

LINK = '<link name="world"/>'
GOOD, BETTER, BROKEN = f'<robot name="good">{LINK}</robot>', f'<robot name="better">{LINK}</robot>', "<robot"


@pytest.fixture
def watching(tmp_path, monkeypatch):
    """Runs a launch file with --watch; at each look of the loop the robot file becomes the next text."""
    robot, launch = tmp_path / "r.urdf", tmp_path / "r.launch.xml"
    robot.write_text(GOOD)
    launch.write_text(
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
        f'<param name="robot_description" value="$(command \'cat {robot}\')"/></node>'
        f'<node pkg="ros_gz_sim" exec="create" args="-file {robot}"/></launch>'
    )
    edits: list[tuple[Path, str]] = []

    class EditedWatch(Watch):
        def breaks_off(self):
            if edits:
                file, text = edits.pop(0)
                file.write_text(text)
            self.broken_off_by = self.changed()
            return self.is_broken_off

    monkeypatch.setattr("drake_twin.run.Watch", EditedWatch)

    def watched(*texts, arguments=()):
        edits[:] = [item if isinstance(item, tuple) else (robot, item) for item in texts]
        return summary_of(tmp_path, launch, "--watch", "--duration", 0.2, *arguments)

    watched.launch = launch
    return watched


def test_a_changed_file_starts_the_twin_anew(watching, capsys):
    result = watching(BETTER)
    assert list(result["robots"]) == ["better"]
    assert result["sim_time"] == pytest.approx(0.2)
    assert f"changed: {watching.launch.parent / 'r.urdf'}\n" in capsys.readouterr().err


@pytest.mark.parametrize("broken", [BROKEN, "", '<robot name="r"><link name="a"/><link name="a"/></robot>'])
def test_a_broken_edit_keeps_the_last_good_twin(watching, capsys, broken):
    assert list(watching(BETTER, broken)["robots"]) == ["better"]
    error = capsys.readouterr().err
    assert error.count("changed: ") == 2
    assert "\nerror: " in error
    assert error.endswith("The last good twin goes on.\n")
    assert "Traceback" not in error


def test_an_edit_after_a_broken_one_is_taken(watching):
    assert list(watching(BROKEN, BETTER)["robots"]) == ["better"]


def test_a_broken_launch_file_keeps_the_last_good_twin_and_is_still_watched(watching, capsys):
    good = watching.launch.read_text()
    result = watching((watching.launch, "<launch><fly/></launch>"), (watching.launch, good + "\n"), BETTER)
    assert list(result["robots"]) == ["better"]
    assert f"error: {watching.launch}:1: " in capsys.readouterr().err


def test_an_edit_that_strict_refuses_keeps_the_last_good_twin(watching, capsys):
    more = watching.launch.read_text().replace("</launch>", '<node pkg="foo" exec="bar"/></launch>')
    assert list(watching((watching.launch, more), arguments=["--strict"])["robots"]) == ["good"]
    assert "error: --strict: 1 not started, see above" in capsys.readouterr().err


def test_a_new_twin_echoes_the_topic_again(watching, capsys):
    watching(BETTER, arguments=["--echo", "/robot_description"])
    assert 'data: <robot name="better">' in capsys.readouterr().out


def test_a_new_twin_keeps_the_time_control_and_watches_what_was_not_read_again(tmp_path):
    from drake_twin import run as program
    from drake_twin.cli import options as run_options
    from drake_twin.cli.target import build_twin, find_target

    options = run_options.parser().parse_args([str(LAUNCH_ARM), "--headless"])
    mesh = tmp_path / "read_once_and_cached.stl"
    target = find_target(options)
    twin = build_twin(target)
    twin.paused, twin.real_time_rate = True, 3.0
    new_twin, _, watch = program._again(twin, target, options, Watch({mesh: None}))
    assert new_twin is not twin
    assert (new_twin.paused, new_twin.real_time_rate) == (True, 3.0)
    assert {mesh, LAUNCH_ARM} <= set(watch.files)


def test_a_recording_under_watch_is_of_the_twin_that_runs_at_the_end(watching, tmp_path):
    watching(BETTER, arguments=["--record", tmp_path / "run.json"])
    again = summary_of(tmp_path, "--replay", tmp_path / "run.json", "--duration", 0.1)
    assert list(again["robots"]) == ["better"]


# --- saved states and recordings


def test_a_saved_state_goes_on_as_if_it_had_not_been_saved(tmp_path):
    whole = summary_of(tmp_path, "--robots", 2, "--duration", 2)
    summary_of(tmp_path, "--robots", 2, "--duration", 0.7, "--save-state", tmp_path / "state.json")
    rest = summary_of(tmp_path, "--load-state", tmp_path / "state.json", "--duration", 1.3)
    assert rest["sim_time"] == pytest.approx(2.0)
    assert rest["state_sha256"] == whole["state_sha256"]


def test_a_recorded_run_is_replayed(tmp_path):
    done = summary_of(tmp_path, "--robots", 1, "--duration", 1, "--record", tmp_path / "run.json")
    again = summary_of(tmp_path, "--replay", tmp_path / "run.json", "--duration", 0.001)
    assert again["sim_time"] == pytest.approx(1.001)
    assert again["steps"] == done["steps"] + 1


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--load-state", "gone.json"], "no saved state can be read"),
        (["--replay", "gone.json"], "no recording can be read"),
        (["--load-state", "a.json", "--replay", "b.json"], "do not go together"),
        (["--load-state", "a.json", "--robots", "2"], "it goes without a target"),
        (["--load-state", "a.json", "--engine", "cenic"], "goes on as it was saved"),
        (["--replay", "a.json", "--pub", "/a", "[1]"], "do not go with it"),
        (["--robots", "1", "--save-state", "/nowhere/state.json"], "no file can be written there"),
    ],
)
def test_saved_states_that_cannot_be_are_refused(capsys, options, reason):
    assert reason in refused(capsys, *options)


def test_ctrl_c_while_many_robots_are_built_ends_at_once_and_says_nothing(tmp_path):
    program = """
import os, signal, sys
from drake_twin import progress, run
run._PATIENCE = 0.0
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
    assert result.stdout.splitlines()[-1] in ("reading robot_6 (6 of 500)", "reading robot_7 (7 of 500)")
