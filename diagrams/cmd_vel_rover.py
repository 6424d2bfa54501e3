"""A rover that listens to cmd_vel: a diff_drive_controller, its odometry, and where the rover really is.

Run it: python diagrams/cmd_vel_rover.py

Four wheels that do not steer slip sideways in a turn, so the odometry of the wheels turns farther than the rover.
The twin publishes both: the controller's odometry, and the true pose on ground_truth/odom.
"""

from math import atan2

from drake_twin import TwinBuilder

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
WHEELS = {side: [f"rover_{end}_{side}_wheel_joint" for end in ("front", "rear")] for side in ("left", "right")}

twin = (
    TwinBuilder()
    .robot("rover", ROVER, xyz=(0, 0, 0.13), active_controllers=["joint_state_broadcaster"])
    .controller(
        "rover",
        "wheels",
        "diff_drive_controller/DiffDriveController",
        {
            "left_wheel_names": WHEELS["left"],
            "right_wheel_names": WHEELS["right"],
            "wheel_separation": 0.41,
            "wheel_radius": 0.1,
            "base_frame_id": "rover_base_link",
            "cmd_vel_timeout": 0.5,
            "linear": {"x": {"max_velocity": 1.0, "max_acceleration": 2.0}},
        },
    )
    .build()
)


def drive(forward, turn, duration):
    """Publish a command ten times a second, as a teleop node does: the controller brakes when commands cease."""
    end = twin.time + duration
    while twin.time < end - 1e-9:
        twin.publish("/rover/wheels/cmd_vel", {"twist": {"linear": {"x": forward}, "angular": {"z": turn}}})
        twin.advance_to(twin.time + 0.1)


def yaw(odometry):
    rotation = odometry.pose.pose.orientation
    return 2 * atan2(rotation.z, rotation.w)


def show(what):
    reckoned, true = twin.latest("/rover/wheels/odom"), twin.latest("/rover/ground_truth/odom")
    print(
        f"{what:9} odometry: x {reckoned.pose.pose.position.x:6.3f} m, yaw {yaw(reckoned):6.3f} rad;"
        f"  truth: x {true.pose.pose.position.x:6.3f} m, yaw {yaw(true):6.3f} rad"
    )
    return reckoned, true


drive(0.5, 0.0, 3.0)
reckoned, true = show("straight:")
assert abs(reckoned.pose.pose.position.x - true.pose.pose.position.x) < 0.02
drive(0.0, 0.5, 2.0)
reckoned, true = show("turned:")
assert yaw(reckoned) > yaw(true) > 0.1
twin.advance_to(twin.time + 1.5)  # no command: cmd_vel_timeout passes, and the rover stands
assert abs(twin.latest("/rover/ground_truth/odom").twist.twist.angular.z) < 1e-3
