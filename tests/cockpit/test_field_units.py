"""The units of numbers in messages, against the comments of ROS's own definitions."""

import pytest

from drake_twin.cockpit.field_units import unit_at
from drake_twin.messages.interface_types import make

SLIDES = {"wheel": False, "lift": True}


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        ("position[wheel]", "rad"),
        ("position[lift]", "m"),
        ("position[1]", "m"),
        ("velocity[wheel]", "rad/s"),
        ("velocity[lift]", "m/s"),
        ("effort[wheel]", "N·m"),
        ("effort[lift]", "N"),
        ("position[stranger]", ""),
        ("header.stamp.sec", "s"),
        ("no.such", ""),
    ],
)
def test_joint_states_have_the_units_of_their_joints(path, unit):
    names = ["wheel", "lift", "stranger"]
    message = make(
        "sensor_msgs/msg/JointState", {"name": names, "position": [1.0] * 3, "velocity": [1.0] * 3, "effort": [1.0] * 3}
    )
    assert unit_at(message, path, SLIDES) == unit


@pytest.mark.parametrize(
    ("type_", "path", "unit"),
    [
        ("nav_msgs/msg/Odometry", "pose.pose.position.x", "m"),
        ("nav_msgs/msg/Odometry", "pose.pose.orientation.w", ""),
        ("nav_msgs/msg/Odometry", "twist.twist.linear.x", "m/s"),
        ("nav_msgs/msg/Odometry", "twist.twist.angular.z", "rad/s"),
        ("sensor_msgs/msg/Imu", "linear_acceleration.z", "m/s²"),
        ("sensor_msgs/msg/Imu", "angular_velocity.z", "rad/s"),
        ("geometry_msgs/msg/WrenchStamped", "wrench.force.x", "N"),
        ("geometry_msgs/msg/WrenchStamped", "wrench.torque.x", "N·m"),
        ("sensor_msgs/msg/BatteryState", "voltage", "V"),
        ("sensor_msgs/msg/Temperature", "temperature", "°C"),
        ("sensor_msgs/msg/NavSatFix", "latitude", "°"),
    ],
)
def test_the_fields_of_common_messages(type_, path, unit):
    assert unit_at(make(type_, {}), path, SLIDES) == unit
