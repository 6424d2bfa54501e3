"""Doubles of other programs, in a process of their own beside a twin."""

import json
import subprocess
import sys
from pathlib import Path

from wires.ros_client import while_running

from drake_twin.services.graph import connect
from drake_twin.wires.dds_wire import DdsWire

TESTS = Path(__file__).parent.parent


def double(program, twin, wire, *words):
    """Run a double on a wire while a twin runs; return what it found."""
    kind = "dds" if isinstance(wire, DdsWire) else "rclpy"
    command = [sys.executable, "-m", f"wires.{program}", kind, str(wire.domain), *words]
    pipes = {"capture_output": True, "text": True, "cwd": TESTS, "check": False}
    seam = connect(twin, [wire])
    try:
        ran = while_running(twin, lambda: subprocess.run(command, **pipes))
    finally:
        seam.close()
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return json.loads(ran.stdout)
