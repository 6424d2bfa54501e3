"""An arm with six joints, and the parameters of upstream's tests of admittance_controller."""

from math import nan, pi
from typing import Any

from drake_twin.description.robot_description import HardwareSensor, HardwareSystem, Joint, Pose, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout

JOINTS = tuple(f"joint{number}" for number in range(1, 7))
_AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
_ORIGINS = ((0.0, 0.0, 0.4), (0.03, 0.0, 0.0), (0.0, 0.0, 0.3), (0.0, 0.0, 0.04), (0.32, 0.0, 0.0), (0.08, 0.0, 0.0))
_LINKS = ("base_link", *(f"link_{number}" for number in range(1, 7)))
_WRENCH = {f"{vector}.{axis}": nan for vector in ("force", "torque") for axis in "xyz"}

ARM = RobotDescription(
    name="arm",
    links=(*_LINKS, "tool0"),
    joints=(
        *(
            Joint(name, "revolute", parent, child, Pose(origin), axis=axis)
            for name, parent, child, origin, axis in zip(JOINTS, _LINKS, _LINKS[1:], _ORIGINS, _AXES, strict=False)
        ),
        Joint("flange", "fixed", "link_6", "tool0", Pose((0.05, 0.0, 0.0), (0.0, pi / 2, 0.0))),
    ),
    systems=(HardwareSystem("hardware", "system", "", sensors=(HardwareSensor("ft_sensor_name", _WRENCH),)),),
)
LAYOUT = StateLayout(
    size=12,
    positions={name: index for index, name in enumerate(JOINTS)},
    velocities={name: 6 + index for index, name in enumerate(JOINTS)},
    efforts={},
)

# test_params.yaml:91
ADMITTANCE: dict[str, Any] = {
    "joints": list(JOINTS),
    "command_interfaces": ["position"],
    "state_interfaces": ["position"],
    "chainable_command_interfaces": ["position", "velocity"],
    "kinematics": {
        "plugin_name": "kinematics_interface_kdl/KinematicsInterfaceKDL",
        "plugin_package": "kinematics_interface",
        "base": "base_link",
        "tip": "tool0",
        "alpha": 0.0005,
    },
    "ft_sensor": {"name": "ft_sensor_name", "frame": {"id": "link_6"}, "filter_coefficient": 0.005},
    "control": {"frame": {"id": "tool0"}},
    "fixed_world_frame": {"frame": {"id": "base_link"}},
    "gravity_compensation": {"frame": {"id": "tool0"}, "CoG": {"pos": [0.1, 0.0, 0.0], "force": 23.0}},
    "admittance": {
        "selected_axes": [True] * 6,
        "mass": [5.5, 6.6, 7.7, 8.8, 9.9, 10.10],
        "damping_ratio": [2.828427] * 6,
        "stiffness": [214.1, 214.2, 214.3, 214.4, 214.5, 214.6],
    },
}
