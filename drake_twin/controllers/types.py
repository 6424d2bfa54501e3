"""The controller types of ros2_controllers that the twin has."""

from collections.abc import Mapping
from importlib import import_module

from drake_twin.controllers.controller import Controller

JOINT_STATE_BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"

# Type as in a parameters file → module below drake_twin.systems and class, imported when a robot has one.
CONTROLLER_TYPES: Mapping[str, tuple[str, str]] = {
    "forward_command_controller/ForwardCommandController": (
        "forward_command_controller",
        "ForwardCommandController",
    ),
    "forward_command_controller/MultiInterfaceForwardCommandController": (
        "forward_command_controller",
        "MultiInterfaceForwardCommandController",
    ),
    "joint_trajectory_controller/JointTrajectoryController": (
        "joint_trajectory_controller",
        "JointTrajectoryController",
    ),
    "velocity_controllers/JointGroupVelocityController": (
        "forward_command_controller",
        "JointGroupVelocityController",
    ),
    "position_controllers/JointGroupPositionController": (
        "forward_command_controller",
        "JointGroupPositionController",
    ),
    "effort_controllers/JointGroupEffortController": (
        "forward_command_controller",
        "JointGroupEffortController",
    ),
    "position_controllers/GripperActionController": (
        "gripper_action_controller",
        "PositionGripperActionController",
    ),
    "effort_controllers/GripperActionController": (
        "gripper_action_controller",
        "EffortGripperActionController",
    ),
    "parallel_gripper_action_controller/GripperActionController": (
        "gripper_action_controller",
        "ParallelGripperActionController",
    ),
    "pid_controller/PidController": ("pid_controller", "PidController"),
    "imu_sensor_broadcaster/IMUSensorBroadcaster": ("imu_sensor_broadcaster", "IMUSensorBroadcaster"),
    "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": (
        "force_torque_sensor_broadcaster",
        "ForceTorqueSensorBroadcaster",
    ),
    "diff_drive_controller/DiffDriveController": ("diff_drive_controller", "DiffDriveController"),
    "mecanum_drive_controller/MecanumDriveController": ("mecanum_drive_controller", "MecanumDriveController"),
    "tricycle_controller/TricycleController": ("tricycle_controller", "TricycleController"),
    "ackermann_steering_controller/AckermannSteeringController": (
        "ackermann_steering_controller",
        "AckermannSteeringController",
    ),
    "bicycle_steering_controller/BicycleSteeringController": (
        "bicycle_steering_controller",
        "BicycleSteeringController",
    ),
    "tricycle_steering_controller/TricycleSteeringController": (
        "tricycle_steering_controller",
        "TricycleSteeringController",
    ),
    "gazebo_ros/PlanarMove": ("planar_move_controller", "PlanarMoveController"),
}


def controller_class(kind: str) -> type[Controller] | None:
    """The class of a controller type; None for a type that the twin does not have."""
    if kind not in CONTROLLER_TYPES:
        return None
    module, name = CONTROLLER_TYPES[kind]
    found: type[Controller] = getattr(import_module(f"drake_twin.controllers.{module}"), name)
    return found
