"""The result of a run in which a node resets the twin."""

import json

import pytest

from drake_twin.run import main

RESETS = """
import rclpy
from simulation_interfaces.srv import ResetSimulation

rclpy.init()
node = rclpy.create_node("resets")
client = node.create_client(ResetSimulation, "/drake_twin/reset_simulation")


def reset():
    timer.cancel()
    client.call_async(ResetSimulation.Request())


timer = node.create_timer(0.3, reset)
rclpy.spin(node)
"""


def test_the_result_is_about_all_that_was_simulated(tmp_path, capsys):
    (tmp_path / "resets.py").write_text(RESETS)
    file = tmp_path / "summary.json"
    arguments = ["--robots", "1", "--headless", "--duration", "0.5", "--node", str(tmp_path / "resets.py")]
    assert main([*arguments, "--summary", str(file)]) == 0
    assert "1 robot, 0.801 s simulated in " in (out := capsys.readouterr().out)
    assert ", at 0.500 s, state " in out
    summary = json.loads(file.read_text())
    assert summary["sim_time"] == pytest.approx(0.5)
    assert summary["real_time_factor"] == pytest.approx(0.801 / summary["wall_time"])
