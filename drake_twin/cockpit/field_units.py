"""The units of the numbers in ROS messages, as the comments of their definitions and REP 103 say them."""

from collections.abc import Mapping
from typing import Any

from drake_twin.cockpit.message_fields import names_in, parts_of, position_of

_M, _RAD, _S = "m", "rad", "s"
_XYZ = ("x", "y", "z")
# Of each type: field → the unit of what is in it. The fields around a number are asked from the inside out.
_UNITS: Mapping[str, Mapping[str, str]] = {
    "builtin_interfaces/msg/Time": {"sec": _S, "nanosec": "ns"},
    "builtin_interfaces/msg/Duration": {"sec": _S, "nanosec": "ns"},
    "geometry_msgs/msg/Accel": {"linear": "m/s²", "angular": "rad/s²"},
    "geometry_msgs/msg/Inertia": {
        **dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "kg·m²"),
        "m": "kg",
        "com": _M,
    },
    "geometry_msgs/msg/Point": dict.fromkeys(_XYZ, _M),
    "geometry_msgs/msg/Point32": dict.fromkeys(_XYZ, _M),
    "geometry_msgs/msg/Pose2D": {"x": _M, "y": _M, "theta": _RAD},
    "geometry_msgs/msg/Transform": {"translation": _M},
    "geometry_msgs/msg/Twist": {"linear": "m/s", "angular": "rad/s"},
    "geometry_msgs/msg/Wrench": {"force": "N", "torque": "N·m"},
    "sensor_msgs/msg/BatteryState": {
        **dict.fromkeys(("voltage", "cell_voltage"), "V"),
        **dict.fromkeys(("temperature", "cell_temperature"), "°C"),
        **dict.fromkeys(("charge", "capacity", "design_capacity"), "A·h"),
        "current": "A",
    },
    "sensor_msgs/msg/FluidPressure": {"fluid_pressure": "Pa", "variance": "Pa²"},
    "sensor_msgs/msg/Illuminance": {"illuminance": "lx"},
    "sensor_msgs/msg/Imu": {"angular_velocity": "rad/s", "linear_acceleration": "m/s²"},
    "sensor_msgs/msg/LaserScan": {
        **dict.fromkeys(("angle_min", "angle_max", "angle_increment"), _RAD),
        **dict.fromkeys(("time_increment", "scan_time"), _S),
        **dict.fromkeys(("range_min", "range_max", "ranges"), _M),
    },
    "sensor_msgs/msg/MagneticField": {"magnetic_field": "T"},
    "sensor_msgs/msg/NavSatFix": {"latitude": "°", "longitude": "°", "altitude": _M},
    "sensor_msgs/msg/Range": {"field_of_view": _RAD, **dict.fromkeys(("min_range", "max_range", "range"), _M)},
    "sensor_msgs/msg/Temperature": {"temperature": "°C"},
}
_OF_JOINTS = {  # field → the units for a joint that turns, and for one that slides
    **dict.fromkeys(("position", "positions"), (_RAD, _M)),
    **dict.fromkeys(("velocity", "velocities"), ("rad/s", "m/s")),
    **dict.fromkeys(("acceleration", "accelerations"), ("rad/s²", "m/s²")),
    **dict.fromkeys(("effort", "efforts"), ("N·m", "N")),
}
_JOINT_TYPES = (
    "sensor_msgs/msg/JointState",
    "trajectory_msgs/msg/JointTrajectoryPoint",
)


def unit_at(message: Any, path: str, slides: Mapping[str, bool]) -> str:
    """Return the unit of a number in a message; empty if it has none, or none that is known.

    Args:
        message: A ROS message.
        path: The number's path, such as ``twist.twist.linear.x`` or ``velocity[wheel]``.
        slides: Joint → whether it is prismatic; the others of these turn.
    """
    for names in reversed(_around(message, path)):
        type_, field, element = names
        if type_ in _JOINT_TYPES and field in _OF_JOINTS:
            return _OF_JOINTS[field][slides[element]] if element in slides else ""
        if field in _UNITS.get(type_, {}):
            return _UNITS[type_][field]
    return ""


def _around(message: Any, path: str) -> list[tuple[str, str, str]]:
    """Return the fields on the way to a number: the message's type, the field, and its element's name."""
    found: list[tuple[str, str, str]] = []
    value, names = message, list[str]()
    for field, index in parts_of(path):
        names = names_in(value) or names
        try:
            if field:
                found.append((getattr(value, "__msgtype__", ""), field, ""))
                value = getattr(value, field)
            else:
                place = position_of(index, names)
                if found and len(names) == len(value):
                    found[-1] = (*found[-1][:2], names[place])
                value = value[place]
        except (AttributeError, IndexError, KeyError, TypeError, ValueError):
            return []
    return found
