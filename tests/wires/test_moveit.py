"""The bundled arm reaches the goals of MoveIt's double, which uses it as move_group does, over a real wire."""

import os

import pytest
from program_runs import MODELS
from wires.double_runs import double
from wires.outside_node import ABORTED, CANCELED, SUCCEEDED

from drake_twin import TwinBuilder
from drake_twin.wires.dds_wire import DdsWire
from drake_twin.wires.rclpy_wire import RclpyWire

SIMULATION = MODELS / "arduinobot_moveit_config" / "launch" / "simulation.launch.py"
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
ARM = ["joint_1", "joint_2", "joint_3"]
TRAJECTORIES = "joint_trajectory_controller/JointTrajectoryController"
INVALID_GOAL = -1  # of control_msgs/action/FollowJointTrajectory
_GRIPPER_TOLERANCE = 0.01  # rad, of the gripper's controller


def is_executed(found, off):
    """What the trajectory execution manager asks for: it ends well, in time, and where the next one begins."""
    assert (found["accepted"], found["status"], found["error_code"]) == (True, SUCCEEDED, 0)
    assert (found["in_time"], found["next_can_start"]) == (True, True)
    assert found["moved"] > 0.15
    assert found["off"] < off
    assert found["feedback"] > 0


def the_arm_reaches_moveits_goals(wire):
    with TwinBuilder(clock_rate=100).launch(SIMULATION).build() as twin:
        found = double("moveit_double", twin, wire)
    assert found["descriptions"] == 1
    assert found["joints"] == [*ARM, "joint_4", "joint_5"]  # the mimic joint, too, or MoveIt waits for ever
    assert found["controllers"] == {
        "joint_state_broadcaster": ["joint_state_broadcaster/JointStateBroadcaster", "active", [], []],
        "joint_trajectory_controller": [TRAJECTORIES, "active", ARM, ARM],
        "gripper_controller": ["position_controllers/GripperActionController", "active", ["joint_4"], ["joint_4"]],
    }
    for motion in ("reach", "home"):
        is_executed(found[motion], off=1e-3)
        assert not found[motion]["early"]
    for motion in ("close", "open"):
        is_executed(found[motion], off=_GRIPPER_TOLERANCE)
    assert (found["canceled"]["canceling"], found["canceled"]["status"]) == (1, CANCELED)
    assert found["canceled"]["drift"] < 1e-4  # rad
    assert found["preempted"]["first"] == [ABORTED, INVALID_GOAL, "Current goal preempted by new incoming action."]
    is_executed(found["preempted"]["second"], off=1e-3)
    assert (found["partial"], found["unknown"], found["refused_when_inactive"]) == (False, False, False)
    assert (found["switched"], found["switched_back"]) == (True, True)
    assert found["inactive"] == [TRAJECTORIES, "inactive", [], ARM]


def test_the_arm_reaches_moveits_goals_over_dds():
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    the_arm_reaches_moveits_goals(DdsWire(160 + WORKER))


@pytest.mark.ros
def test_the_arm_reaches_moveits_goals_through_rclpy():
    the_arm_reaches_moveits_goals(RclpyWire(170 + WORKER))
