"""The bundled rover reaches a goal of Nav2's double, which uses it as Nav2 does, over a real wire."""

import os

import pytest
import yaml
from program_runs import MODELS
from wires.double_runs import double

from drake_twin import TwinBuilder
from drake_twin.wires.dds_wire import DdsWire
from drake_twin.wires.rclpy_wire import RclpyWire

SIMULATION = MODELS / "rover_navigation" / "launch" / "simulation.launch.py"
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
GOAL = (4.2, 0.8)  # m, the end of the double's path


def the_rover_reaches_nav2s_goal(wire):
    """The wheels' odometry alone would miss it: the scan's beams must end on the map's walls all the way."""
    with TwinBuilder(clock_rate=100).launch(SIMULATION).build() as twin:
        found = double("nav2_double", twin, wire, "5")
        base = twin.robot_state("rover").base_pose
        wheels = twin.robot_state("rover").velocities
    assert found["reached"]
    assert found["chain"] == ["rover_lidar", "rover_base_link", "rover_odom"]  # map → rover_odom is the double's
    assert (found["twice"], found["backwards"]) == ([], [])
    assert found["odometry"] == [["rover_odom", "rover_base_link"]]
    assert found["fastest"] == pytest.approx(0.4, abs=0.02)
    assert found["last"] == pytest.approx(0.0, abs=1e-3)
    assert found["periods"] == [0.1]
    assert found["used"] == found["scans"]  # none waits for a transform that does not come
    assert found["fits"] > 0.95
    assert found["nearest"] > 0.3  # m, from the lidar to the pillar
    assert (base[0], base[1]) == (pytest.approx(GOAL[0], abs=0.25), pytest.approx(GOAL[1], abs=0.25))
    assert (base[0], base[1]) == pytest.approx((found["pose"]["x"], found["pose"]["y"]), abs=0.05)
    assert max(abs(speed) for speed in wheels) < 1e-3


def test_the_rover_reaches_nav2s_goal_over_dds():
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    the_rover_reaches_nav2s_goal(DdsWire(150 + WORKER))


def test_commands_without_a_stamp_as_enable_stamped_cmd_vel_false_sends_them(tmp_path):
    """To the first corner of the path only, at (1, -0.5) m."""
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    file = tmp_path / "drive.yaml"
    parameters = {"enable_odom_tf": True, "use_stamped_vel": False}
    file.write_text(yaml.safe_dump({"/**/drive_controller": {"ros__parameters": parameters}}))
    with TwinBuilder(clock_rate=100).launch(SIMULATION, drive_parameters=str(file)).build() as twin:
        words = ("2", "/rover/drive_controller/cmd_vel_unstamped", "geometry_msgs/msg/Twist")
        found = double("nav2_double", twin, DdsWire(150 + WORKER), *words)
        base = twin.robot_state("rover").base_pose
    assert (found["reached"], found["used"] == found["scans"]) == (True, True)
    assert (base[0], base[1]) == pytest.approx((1.0, -0.5), abs=0.25)


@pytest.mark.ros
def test_the_rover_reaches_nav2s_goal_through_rclpy():
    the_rover_reaches_nav2s_goal(RclpyWire(170 + WORKER))
