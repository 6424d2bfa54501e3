"""A rover that listens to cmd_vel, and an arm that follows trajectories."""

from conftest import ARM, ROVER

from drake_twin import TwinBuilder

CMD_VEL = "/robot_1/drive/cmd_vel"
WHEELS_1 = "/robot_1/forward_velocity_controller/commands"
TRAJECTORY = "/arm/trajectory_controller/joint_trajectory"

_DRIVE = """
/**/controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    drive: {type: diff_drive_controller/DiffDriveController}
/**/drive:
  ros__parameters:
    left_wheel_names: [$(var robot_name)_front_left_wheel_joint, $(var robot_name)_rear_left_wheel_joint]
    right_wheel_names: [$(var robot_name)_front_right_wheel_joint, $(var robot_name)_rear_right_wheel_joint]
    wheel_separation: 0.4
    wheel_radius: 0.1
"""

_TRAJECTORIES = """
controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    trajectory_controller: {type: joint_trajectory_controller/JointTrajectoryController}
trajectory_controller:
  ros__parameters:
    joints: [joint_1, joint_2, joint_3]
    command_interfaces: [velocity]
    state_interfaces: [position, velocity]
    gains:
      joint_1: {p: 10.0}
      joint_2: {p: 10.0}
      joint_3: {p: 10.0}
"""


def driven_rovers(folder, count=1) -> TwinBuilder:
    """Rovers with a differential drive."""
    file = folder / "drive.yaml"
    file.write_text(_DRIVE)
    builder = TwinBuilder()
    for index in range(count):
        builder.robot(f"robot_{index + 1}", ROVER, xyz=(0, 2.0 * index, 0.13), controllers=file)
    return builder


def arm_with_trajectories(folder) -> TwinBuilder:
    """An arm whose joints follow trajectories."""
    file = folder / "trajectories.yaml"
    file.write_text(_TRAJECTORIES)
    return TwinBuilder().robot("arm", ARM, controllers=file)
