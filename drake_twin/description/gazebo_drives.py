"""What Gazebo's drive plugins amount to in the twin: controllers of ros2_controllers with the plugins' parameters.

Many robots have no ``<ros2_control>`` and are driven by a plugin alone. Each plugin becomes a controller of the type
that does the same, a record of the topics that it uses in place of the controller's own, and of the actuators that it
needs. Sources: ``gazebo_plugins`` of gazebo_ros_pkgs (branch ros2) and ``src/systems`` of gz-sim.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from drake_twin.description.classic_drives import (
    gazebo_ros_ackermann_drive,
    gazebo_ros_diff_drive,
    gazebo_ros_planar_move,
)
from drake_twin.description.gazebo_drive import CannotWorkError, DrivePlugin, GazeboDrive
from drake_twin.description.gazebo_plugins import plugin_kind, plugin_node_name
from drake_twin.description.gz_drives import (
    ackermann_steering_system,
    diff_drive_system,
    mecanum_drive_system,
    velocity_control_system,
)
from drake_twin.description.robot_description import GazeboPlugin, RobotDescription


def is_drive(plugin: GazeboPlugin) -> bool:
    """Whether a plugin is of a kind that becomes a controller."""
    return plugin_kind(plugin) in _MAKERS


def gazebo_drives(description: RobotDescription) -> tuple[GazeboDrive, ...]:
    """The controllers that a robot's Gazebo plugins amount to; plugins of other kinds are left out.

    Raises:
        InputError: a value in a plugin that is no number, or neither true nor false, with file and line.
    """
    drives: list[GazeboDrive] = []
    names: set[str] = set()
    for plugin in description.plugins:
        make = _MAKERS.get(plugin_kind(plugin))
        if make is None:
            continue
        name = base = plugin_node_name(plugin)
        number = 1
        while name in names:
            number += 1
            name = f"{base}_{number}"
        names.add(name)
        try:
            reader = DrivePlugin(plugin, description, name)
            drive = make(reader)
            drives.append(replace(drive, unread=reader.unread))
        except CannotWorkError as error:
            drives.append(GazeboDrive(plugin, not_started=f"{name} ({plugin.filename}): {error}"))
    return tuple(drives)


def _joint_state_publisher(plugin: DrivePlugin) -> GazeboDrive:
    is_gz = not plugin.plugin.filename.startswith("libgazebo_ros")
    joints = plugin.joints("joint_name", required=not is_gz)
    joints = joints or tuple(joint.name for joint in plugin.description.movable_joints)
    parameters = {"joints": list(joints), "interfaces": ["position", "velocity"]}
    if is_gz:
        _, gz_topics = plugin.gz_topics({"joint_states": ("topic", "joint_state")})
        topics = {"joint_states": plugin.text("topic", "joint_states").strip("/")}
    else:
        topics, gz_topics = plugin.ros_topics({"joint_states": "joint_states"}), {}
    rate = plugin.number("update_rate", 0.0 if is_gz else 100.0)
    return GazeboDrive(
        plugin.plugin,
        plugin.controller(
            "joint_state_broadcaster/JointStateBroadcaster",
            parameters | ({"update_rate": int(rate)} if rate >= 1.0 else {}),
        ),
        topics=topics,
        gz_topics=gz_topics,
    )


def _joint_command_system(interface: str, default_topic: str) -> Callable[[DrivePlugin], GazeboDrive]:
    def make(plugin: DrivePlugin) -> GazeboDrive:
        if plugin.flag("use_actuator_msg", False):
            raise CannotWorkError("<use_actuator_msg> is not supported")
        joints = plugin.joints("joint_name")
        default = plugin.text("sub_topic", default_topic.format(joint=joints[0], index=plugin.text("joint_index", "0")))
        gz = plugin.text("topic", f"/model/{{model}}/{default}")
        ros = gz.strip("/") if plugin.has("topic") else default
        gains = [tag for tag in ("p_gain", "i_gain", "d_gain", "use_force_commands") if plugin.has(tag)]
        warnings = [f"<{tag}> is not used: the twin chooses the joint's gains" for tag in gains]
        start = plugin.number("initial_position", 0.0) if interface == "position" else 0.0
        return GazeboDrive(
            plugin.plugin,
            plugin.controller(
                f"{interface}_controllers/JointGroup{interface.title()}Controller", {"joints": list(joints)}
            ),
            topics={"commands": ros},
            gz_topics={"commands": gz},
            types={"commands": "std_msgs/msg/Float64"},
            interfaces=tuple((joint, interface) for joint in joints),
            start=dict.fromkeys(joints, start) if start else {},
            warnings=tuple(warnings),
        )

    return make


_MAKERS: Mapping[str, Callable[[DrivePlugin], GazeboDrive]] = {
    "gazebo_ros_diff_drive": gazebo_ros_diff_drive,
    "diff-drive-system": diff_drive_system,
    "mecanum-drive-system": mecanum_drive_system,
    "ackermann-steering-system": ackermann_steering_system,
    "gazebo_ros_ackermann_drive": gazebo_ros_ackermann_drive,
    "gazebo_ros_planar_move": gazebo_ros_planar_move,
    "velocity-control-system": velocity_control_system,
    "gazebo_ros_joint_state_publisher": _joint_state_publisher,
    "joint-state-publisher-system": _joint_state_publisher,
    "joint-position-controller-system": _joint_command_system("position", "joint/{joint}/{index}/cmd_pos"),
    "joint-controller-system": _joint_command_system("velocity", "joint/{joint}/cmd_vel"),
}
