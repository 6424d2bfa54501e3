"""Input that ``drake_twin.run`` refuses: one paragraph, exit code 2, no traceback."""

import socket
from pathlib import Path

import pytest
from program_runs import ARM, MODELS, PUB_1, ROVER, refused, run


def test_a_missing_file(capsys):
    assert "/nowhere/robot.urdf: the file does not exist" in refused(capsys, "/nowhere/robot.urdf")
    assert "nowhere.yaml: the scenario cannot be read" in refused(capsys, "nowhere.yaml")
    assert "package 'nowhere' was not found in:" in refused(capsys, "package://nowhere/a.urdf")


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
    assert "package 'no_such_package' was not found in:" in refused(capsys, file)


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
        (["--robot", "car"], "--robot car: unknown robot. Valid: rover, arduinobot"),
        (["--summary", "/nowhere/out.json"], "--summary /nowhere/out.json: no file can be written there"),
        (["--port", "0"], "--port 0: the page's port must be from 1024 to 65535"),
        (["--fly"], "unrecognized arguments: --fly (--help lists the options)"),
        (["a.urdf", "b.urdf"], "only one scenario or robot file can be run at a time, not a.urdf, b.urdf"),
        (["x:=1"], "x:=1: xacro arguments need a robot file"),
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
