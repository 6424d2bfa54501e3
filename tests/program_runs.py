"""Runs of ``drake_twin.run`` in a process of its own or in this one, and what they end with."""

import json
import os
import subprocess
import sys

from drake_twin.description.package_index import share_folder
from drake_twin.run import main

MODELS = share_folder("models")
ROVER = MODELS / "rover_description" / "urdf" / "rover.urdf.xacro"
ARM = MODELS / "arduinobot_description" / "urdf" / "arduinobot.urdf.xacro"
LAUNCH_ARM = MODELS / "arduinobot_description" / "launch" / "gazebo.launch.py"
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


def refused(capsys, *arguments):
    assert main([*map(str, arguments), "--headless", "--duration", "0.1"]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err
