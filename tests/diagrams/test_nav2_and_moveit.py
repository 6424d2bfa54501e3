"""The checklist of diagrams/nav2_and_moveit.py: with rclpy's stand-in beside a twin, whole where ROS 2 is sourced."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from nodes.node_runs import script
from program_runs import MODELS

from drake_twin import TwinBuilder

PROGRAM = Path(__file__).resolve().parents[2] / "diagrams" / "nav2_and_moveit.py"
SERVERS = Path(__file__).resolve().parents[1] / "wires" / "planning_servers.py"
LOOKS = """
import importlib.util
import rclpy

spec = importlib.util.spec_from_file_location("checklist", {program!r})
program = importlib.util.module_from_spec(spec)
spec.loader.exec_module(program)
program.PATIENCE = 5.0  # s of the simulation
rclpy.init()
checklist = program.Checklist(rclpy.create_node("checklist", parameter_overrides=program.SIM_TIME))
program.{look}(checklist)
print(f"{{checklist.failed}} of {{checklist.count}} failed")
"""

LACKS = """
import importlib.util

spec = importlib.util.spec_from_file_location("checklist", {program!r})
program = importlib.util.module_from_spec(spec)
spec.loader.exec_module(program)
program.PACKAGES = {{"nav2": "a_missing_one", "moveit": "moveit_msgs"}}
program.check_packages(program.PARTS)
"""


def looked(tmp_path, capsys, package, look, without=()):
    """What the checklist says of a bundled simulation, without some of its controllers."""
    file = script(tmp_path, "look.py", LOOKS.format(program=str(PROGRAM), look=look))
    with TwinBuilder().launch(MODELS / package / "launch" / "simulation.launch.py").node(file).build() as twin:
        twin.control.manager(twin.robots[0]).switch_controller(deactivate=without)
        while not (said := capsys.readouterr().out.splitlines()) or not said[-1].endswith("failed"):
            twin.advance_to(twin.time + 1.0)
            assert twin.time < 200
    return said


def test_the_rovers_interfaces_are_as_nav2_wants_them(tmp_path, capsys):
    said = looked(tmp_path, capsys, "rover_navigation", "look_at_the_rover")
    assert said[-1] == "0 of 6 failed", said


def test_the_arms_interfaces_are_as_moveit_wants_them(tmp_path, capsys):
    said = looked(tmp_path, capsys, "arduinobot_moveit_config", "look_at_the_arm")
    assert said[-1] == "0 of 6 failed", said


def test_what_is_not_as_it_should_be_is_named(tmp_path, capsys):
    without = ["joint_state_broadcaster"]
    said = looked(tmp_path, capsys, "arduinobot_moveit_config", "look_at_the_arm", without)
    assert [line for line in said if line.startswith("FAIL")] == [
        "FAIL /joint_states has all joints, the mimic one among them",
        "FAIL list_controllers has three active controllers",
    ]
    assert said[-1] == "2 of 6 failed"


def test_without_ros_it_says_what_to_source(tmp_path):
    ran = subprocess.run([sys.executable, "-I", PROGRAM], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr == "error: no rclpy: source a ROS 2 first, as with `source /opt/ros/jazzy/setup.bash`\n"


def test_a_package_that_is_missing_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    file = script(tmp_path, "lacks.py", LACKS.format(program=str(PROGRAM)))
    with (
        TwinBuilder().launch(MODELS / "rover_navigation" / "launch" / "simulation.launch.py").node(file).build() as twin
    ):
        twin.advance_to(0.1)
    text = "error: this ROS 2 lacks a_missing_one: `sudo apt install ros-jazzy-a-missing-one`\n"
    assert text in capsys.readouterr().err


@pytest.mark.ros
def test_each_interface_with_doubles_of_the_servers(tmp_path):
    """With Nav2's own client, where it is installed; a program in place of ``ros2`` starts the doubles."""
    double = tmp_path / "ros2"
    double.write_text(f'#!/bin/sh\nexec {sys.executable} {SERVERS} "$2"\n')
    double.chmod(0o755)
    domain = 190 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
    environment = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "ROS_DOMAIN_ID": str(domain)}
    parts = subprocess.run(
        [sys.executable, PROGRAM],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert parts.returncode == 0, parts.stdout + parts.stderr
    assert parts.stdout.splitlines()[-1] == "28 of 28 are as they should be"
