"""The commander of diagrams/commander.py beside a twin: two robots drive, and the recording repeats it."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import rovers
from wires.ros_client import while_running
from wires.zenoh_peer import free_port

from drake_twin.services.graph import connect
from drake_twin.twin.replay import replay
from drake_twin.wires.zenoh_wire import ZenohWire

pytest.importorskip("zenoh")

PROGRAM = Path(__file__).resolve().parents[2] / "diagrams" / "commander.py"
RADIUS = 0.1  # m, of the rover's wheels (models/rover_description/urdf/wheel.xacro)


def test_two_robots_drive_and_the_replay_ends_in_the_same_state():
    """A wheel at 3 (or 6) rad/s on average rolls 2 s · 3 rad/s · radius: sin has no part in the mean over 2 s."""
    port = free_port()
    with rovers(2).build() as twin:
        twin.recorder.begin()
        seam = connect(twin, [ZenohWire(domain=0, port=port)])
        try:
            command = [sys.executable, str(PROGRAM), f"127.0.0.1:{port}"]
            environment = os.environ | {"ROS_DOMAIN_ID": "0"}
            ran = while_running(
                twin,
                lambda: subprocess.run(
                    command, env=environment, capture_output=True, text=True, timeout=100, check=False
                ),
            )
        finally:
            seam.close()
        assert ran.returncode == 0, ran.stderr
        assert ran.stdout.splitlines()[1] == "/robot_2 was driven at 6.0 rad/s on average for 2 s"
        twin.advance_to(twin.time + 0.5)
        for name, distance in (("robot_1", 6 * RADIUS), ("robot_2", 12 * RADIUS)):
            state = twin.robot_state(name)
            assert state.base_pose[0] == pytest.approx(distance, rel=0.1)
            np.testing.assert_allclose(state.velocities, 0, atol=0.05)
            assert list(twin.graph.command(f"/{name}/forward_velocity_controller/commands").data) == [0.0] * 4
        commands = [call for call in twin.recorder.recording().calls if call.name == "publish"]
        assert len(commands) >= 100  # 100 Hz to two robots, some of which meet in one step
        with replay(twin.recorder.recording()) as again:
            assert again.state_sha256() == twin.state_sha256()
