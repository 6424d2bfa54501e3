"""What Gazebo's drive plugins amount to in the twin: controllers of ros2_controllers with the plugins' parameters.

Many robots have no ``<ros2_control>`` and are driven by a plugin alone. Each plugin becomes a controller of the type
that does the same, a record of the topics that it uses in place of the controller's own, and of the actuators that it
needs. Sources: ``gazebo_plugins`` of gazebo_ros_pkgs (branch ros2) and ``src/systems`` of gz-sim.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import atan, dist, inf, sin
from typing import Any

from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.gazebo_plugins import PluginReader, plugin_kind, plugin_node_name, ros_topic
from drake_twin.description.planar_joints import ANGULAR_Z, LINEAR_X, LINEAR_Y
from drake_twin.description.robot_description import GazeboPlugin, RobotDescription
from drake_twin.description.wheel_geometry import wheel_centers, wheel_radius

_FOR_EVER = 1e9  # s; Gazebo's plugins have no timeout, and zero means one update to some controllers
_UNKNOWN = 1e12  # the covariance that classic plugins give to what does not move in the plane

JointInterface = tuple[str, str]


@dataclass(frozen=True)
class GazeboDrive:
    """A plugin as a controller.

    Attributes:
        plugin: the plugin.
        controller: the controller that does the same; None when the plugin cannot work.
        topics: the controller's own topic (as its system names the port) → the topic that the plugin uses instead,
            relative to the robot's namespace, or with a leading ``/`` where a remapping puts it elsewhere. A topic of
            the controller that is not here is not published.
        gz_topics: the same in gz's transport, as a ``parameter_bridge`` names it; ``{model}`` stands for the model.
        types: topic of the controller → the ROS type that the plugin or its bridge has there, where it is another one.
        interfaces: (joint, command interface) for each actuator that it needs.
        efforts: joint → the largest effort that the plugin gives it (N·m or N).
        start: joint → the position (rad or m) that the plugin commands at the start.
        true_odometry: whether its odometry is the true pose in the world instead of what the wheels tell.
        not_started: why the plugin cannot work.
        warnings: what of it changes nothing in the twin.
    """

    plugin: GazeboPlugin
    controller: ControllerParameters | None = None
    topics: Mapping[str, str] = field(default_factory=dict)
    gz_topics: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    interfaces: tuple[JointInterface, ...] = ()
    efforts: Mapping[str, float] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    true_odometry: bool = False
    not_started: str | None = None
    warnings: tuple[str, ...] = ()


class _CannotWorkError(Exception):
    """A plugin that Gazebo loads, and that then does nothing."""


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
            drives.append(make(_Plugin(plugin, description, name)))
        except _CannotWorkError as error:
            drives.append(GazeboDrive(plugin, not_started=f"{name} ({plugin.filename}): {error}"))
    return tuple(drives)


class _Plugin(PluginReader):
    """A plugin, the robot it is on, and the name of the controller it becomes."""

    def __init__(self, plugin: GazeboPlugin, description: RobotDescription, name: str):
        super().__init__(plugin, description.file)
        self.description = description
        self.name = name

    def joints(self, tag: str, *, required: bool = True) -> tuple[str, ...]:
        """Joints that the robot has."""
        found = self.texts(tag)
        if required and not found:
            raise _CannotWorkError(f"<{tag}> is missing")
        self.check_joints(found)
        return found

    def check_joints(self, joints: Iterable[str]) -> None:
        """Refuses joints that the robot does not have or that do not move."""
        movable = {joint.name for joint in self.description.movable_joints}
        for joint in joints:
            if joint not in movable:
                raise _CannotWorkError(f"the robot has no movable joint {joint!r}")

    def controller(self, kind: str, parameters: Mapping[str, Any]) -> ControllerParameters:
        """The controller with these parameters."""
        return ControllerParameters(self.name, kind, dict(parameters))

    def ros_topics(self, names: Mapping[str, str | None]) -> dict[str, str]:
        """The controller's topics by the plugin's names, with its remappings; those without a name are left out."""
        return {own: ros_topic(self.plugin, name) for own, name in names.items() if name is not None}

    def gz_topics(self, names: Mapping[str, tuple[str, str]]) -> tuple[dict[str, str], dict[str, str]]:
        """For ROS and for gz: the controller's topics by an element of the plugin, or by gz's name below the model."""
        ros, gz = {}, {}
        for own, (tag, default) in names.items():
            gz[own] = self.text(tag, f"/model/{{model}}/{default}")
            given = gz[own].strip("/")
            ros[own] = given if self.has(tag) else default.rpartition("/")[2]
        ros.pop("tf_odometry", None)  # all robots' transforms go to /tf
        return ros, gz


def _classic_odometry(plugin: _Plugin) -> dict[str, Any]:
    covariance = [plugin.number("covariance_x", 1e-5), plugin.number("covariance_y", 1e-5)]
    covariance += [_UNKNOWN, _UNKNOWN, _UNKNOWN, plugin.number("covariance_yaw", 1e-3)]
    return {
        "odom_frame_id": plugin.text("odometry_frame", "odom"),
        "base_frame_id": plugin.text("robot_base_frame", "base_footprint"),
        "pose_covariance_diagonal": covariance,
        "twist_covariance_diagonal": covariance,
        "enable_odom_tf": plugin.flag("publish_odom_tf", False),
        "use_stamped_vel": False,
    }


def _gz_odometry(plugin: _Plugin) -> dict[str, Any]:
    return {
        "odom_frame_id": plugin.text("frame_id", "odom"),
        "base_frame_id": plugin.text("child_frame_id", plugin.description.root_link),
        "enable_odom_tf": True,
        "use_stamped_vel": False,
    }


def _rate(rate: float) -> float:
    return rate if rate > 0.0 else 1e6  # every update


def _gz_limits(plugin: _Plugin, direction: str = "") -> dict[str, float]:
    """gz's limits of one direction; where it has only one bound, the other is infinite."""
    limits: dict[str, float] = {}
    for what, lower_names in (
        ("velocity", ("min_velocity",)),
        ("acceleration", ("max_acceleration_reverse",)),
        ("jerk", ("min_jerk",)),
    ):
        bounds = []
        for side in ("min", "max"):
            tags = [f"{side}_{direction}_{what}"] if direction else []
            given = [plugin.number(tag, 0.0) for tag in (*tags, f"{side}_{what}") if plugin.has(tag)]
            bounds.append(given[0] if given else None)
        if bounds != [None, None]:
            lower, upper = bounds
            limits |= dict.fromkeys(lower_names, min(-inf if lower is None else lower, 0.0))
            limits[f"max_{what}"] = max(inf if upper is None else upper, 0.0)
    return limits


def _gazebo_ros_diff_drive(plugin: _Plugin) -> GazeboDrive:
    left, right = plugin.joints("left_joint"), plugin.joints("right_joint")
    pairs = max(int(plugin.number("num_wheel_pairs", 1.0)), 1)
    if len(left) != pairs or len(right) != pairs:
        raise _CannotWorkError(
            f"<num_wheel_pairs> is {pairs}, but there are {len(left)} left and {len(right)} right joints"
        )
    separations = plugin.numbers("wheel_separation")[:pairs] or (0.34,)
    diameters = plugin.numbers("wheel_diameter")[:pairs] or (0.15,)
    for tag, values in (("wheel_separation", separations), ("wheel_diameter", diameters)):
        if min(values) <= 0.0:
            raise plugin.error(f"<{tag}> is {min(values):g}, which is not above zero")
    parameters = _classic_odometry(plugin) | {
        "left_wheel_names": list(left),
        "right_wheel_names": list(right),
        "wheel_separation": separations[0],
        "wheel_radius": 0.5 * diameters[0],
        "cmd_vel_timeout": 0.0,
        "publish_rate": _rate(plugin.number("update_rate", 100.0)),
        "velocity_rolling_window_size": 1,
        "tf_frame_prefix_enable": False,
    }
    acceleration = plugin.number("max_wheel_acceleration", 0.0)  # of the rim, m/s²
    if acceleration > 0.0:
        parameters["linear"] = {"x": {"max_acceleration": acceleration}}
        parameters["angular"] = {"z": {"max_acceleration": 2.0 * acceleration / separations[0]}}
    warnings = []
    if len({*separations}) > 1 or len({*diameters}) > 1:
        warnings.append("its pairs of wheels differ, and all are driven like the first")
    odometry = plugin.flag("publish_odom", False)
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("diff_drive_controller/DiffDriveController", parameters),
        topics=plugin.ros_topics({"cmd_vel_unstamped": "cmd_vel", "odom": "odom" if odometry else None}),
        interfaces=tuple((joint, "velocity") for joint in (*left, *right)),
        efforts=dict.fromkeys((*left, *right), plugin.number("max_wheel_torque", 5.0)),
        true_odometry=int(plugin.number("odometry_source", 1.0)) == 1,
        warnings=tuple(warnings),
    )


def _diff_drive_system(plugin: _Plugin) -> GazeboDrive:
    left, right = plugin.joints("left_joint"), plugin.joints("right_joint")
    if len(left) != len(right):
        raise _CannotWorkError(f"there are {len(left)} left and {len(right)} right joints")
    parameters = _gz_odometry(plugin) | {
        "left_wheel_names": list(left),
        "right_wheel_names": list(right),
        "wheel_separation": plugin.number("wheel_separation", 1.0),
        "wheel_radius": plugin.number("wheel_radius", 0.2),
        "cmd_vel_timeout": 0.0,
        "publish_rate": _rate(plugin.number("odom_publish_frequency", 50.0)),
        "tf_frame_prefix_enable": not plugin.has("frame_id"),
        "linear": {"x": _gz_limits(plugin, "linear")},
        "angular": {"z": _gz_limits(plugin, "angular")},
    }
    topics, gz_topics = plugin.gz_topics(
        {
            "cmd_vel_unstamped": ("topic", "cmd_vel"),
            "odom": ("odom_topic", "odometry"),
            "tf_odometry": ("tf_topic", "tf"),
        }
    )
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("diff_drive_controller/DiffDriveController", parameters),
        topics=topics,
        gz_topics=gz_topics,
        interfaces=tuple((joint, "velocity") for joint in (*left, *right)),
    )


def _mecanum_drive_system(plugin: _Plugin) -> GazeboDrive:
    wheels = {}
    for there, here in (
        ("front_left", "front_left"),
        ("front_right", "front_right"),
        ("back_right", "rear_right"),
        ("back_left", "rear_left"),
    ):
        wheels[f"{here}_wheel_command_joint_name"], *more = plugin.joints(f"{there}_joint")
        if more:
            raise _CannotWorkError(
                f"there are {1 + len(more)} <{there}_joint>, and the twin drives four mecanum wheels"
            )
    limits = _gz_limits(plugin)
    parameters = (
        _gz_odometry(plugin)
        | wheels
        | {
            "reference_timeout": _FOR_EVER,
            "kinematics": {
                "wheels_radius": plugin.number("wheel_radius", 0.2),
                "sum_of_robot_center_projection_on_X_Y_axis": 0.5
                * (plugin.number("wheel_separation", 1.0) + plugin.number("wheelbase", 1.0)),
            },
            "tf_frame_prefix_enable": not plugin.has("frame_id"),
            "linear": {"x": limits, "y": limits},
            "angular": {"z": limits},
        }
    )
    topics, gz_topics = plugin.gz_topics(
        {
            "reference_unstamped": ("topic", "cmd_vel"),
            "odometry": ("odom_topic", "odometry"),
            "tf_odometry": ("tf_topic", "tf"),
        }
    )
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("mecanum_drive_controller/MecanumDriveController", parameters),
        topics=topics,
        gz_topics=gz_topics,
        interfaces=tuple((joint, "velocity") for joint in wheels.values()),
    )


def _ackermann_steering_system(plugin: _Plugin) -> GazeboDrive:
    if plugin.flag("steering_only", False) or plugin.flag("use_actuator_msg", False):
        raise _CannotWorkError("<steering_only> and <use_actuator_msg> are not supported")
    steering = (*plugin.joints("right_steering_joint")[:1], *plugin.joints("left_steering_joint")[:1])
    driven, warnings = [], []
    for tag in ("right_joint", "left_joint"):
        joints = plugin.joints(tag)
        fixed = [joint for joint in joints if not _is_below(plugin.description, joint, steering)]
        driven.append((fixed or joints)[0])
        if len(joints) > 1:
            warnings.append(f"of <{tag}> {', '.join(joints)} the twin drives {driven[-1]}, and the others roll")
    parameters = _gz_odometry(plugin) | {
        "traction_joints_names": driven,
        "steering_joints_names": list(steering),
        "reference_timeout": _FOR_EVER,
        "wheelbase": plugin.number("wheel_base", 1.0),
        "traction_wheels_radius": plugin.number("wheel_radius", 0.2),
        "traction_track_width": plugin.number("wheel_separation", 1.0),
        "steering_track_width": plugin.number("kingpin_width", 0.8),
        # gz takes wheel_base / sin(limit) for the smallest turning radius
        "largest_steering_angle": atan(sin(plugin.number("steering_limit", 0.5))),
        "linear": {"x": _gz_limits(plugin)},
        "angular": {"z": _gz_limits(plugin)},
    }
    topics, gz_topics = plugin.gz_topics(
        {
            "reference_unstamped": ("topic", plugin.text("sub_topic", "cmd_vel")),
            "odometry": ("odom_topic", "odometry"),
            "tf_odometry": ("tf_topic", "tf"),
        }
    )
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("ackermann_steering_controller/AckermannSteeringController", parameters),
        topics=topics,
        gz_topics=gz_topics,
        interfaces=(*((joint, "velocity") for joint in driven), *((joint, "position") for joint in steering)),
        warnings=tuple(warnings),
    )


def _gazebo_ros_ackermann_drive(plugin: _Plugin) -> GazeboDrive:
    names = ("front_right_joint", "front_left_joint", "rear_right_joint", "rear_left_joint")
    wheels = tuple(plugin.text(tag, tag) for tag in names)
    steering = tuple(plugin.text(tag, tag) for tag in ("right_steering_joint", "left_steering_joint"))
    plugin.check_joints((*wheels, *steering))
    front_right, front_left, rear_right, rear_left = wheel_centers(plugin.description, wheels)
    radius = wheel_radius(plugin.description, wheels[2])
    if radius is None:
        raise _CannotWorkError(f"the wheel of joint {wheels[2]!r} has no cylinder or sphere to take its radius from")
    wheelbase = dist(0.5 * (front_right + front_left), 0.5 * (rear_right + rear_left))
    speed = plugin.number("max_speed", 20.0)
    parameters = _classic_odometry(plugin) | {
        "traction_joints_names": list(wheels[2:]),
        "steering_joints_names": list(steering),
        "reference_timeout": _FOR_EVER,
        "wheelbase": wheelbase,
        "traction_wheels_radius": radius,
        "traction_track_width": dist(rear_left, rear_right),
        "steering_track_width": dist(front_left, front_right),
        "velocity_rolling_window_size": 1,
        "linear": {"x": {"max_velocity": speed}},
        "largest_steering_angle": plugin.number("max_steer", 0.6),
        "angular_is_steering_angle": True,
    }
    odometry = plugin.flag("publish_odom", False)
    unused = ("publish_distance", "publish_steerangle")
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("ackermann_steering_controller/AckermannSteeringController", parameters),
        topics=plugin.ros_topics({"reference_unstamped": "cmd_vel", "odometry": "odom" if odometry else None}),
        interfaces=(*((joint, "velocity") for joint in wheels[2:]), *((joint, "position") for joint in steering)),
        true_odometry=True,
        warnings=tuple(f"<{tag}> is not supported" for tag in unused if plugin.flag(tag, False)),
    )


def _gazebo_ros_planar_move(plugin: _Plugin) -> GazeboDrive:
    parameters = _classic_odometry(plugin) | {
        "publish_rate": _rate(plugin.number("publish_rate", 20.0)),
        "enable_odom_tf": plugin.flag("publish_odom_tf", True),
    }
    odometry = plugin.flag("publish_odom", True)
    return GazeboDrive(
        plugin.plugin,
        plugin.controller(PLANAR_MOVE, parameters),
        topics=plugin.ros_topics({"cmd_vel_unstamped": "cmd_vel", "odom": "odom" if odometry else None}),
        interfaces=PLANAR_INTERFACES,
        true_odometry=True,
    )


def _velocity_control_system(plugin: _Plugin) -> GazeboDrive:
    parameters = _gz_odometry(plugin) | {"enable_odom_tf": False}
    topics, gz_topics = plugin.gz_topics({"cmd_vel_unstamped": ("topic", "cmd_vel")})
    unused = ("link_name", "initial_linear", "initial_angular")
    return GazeboDrive(
        plugin.plugin,
        plugin.controller(PLANAR_MOVE, parameters),
        topics=topics,
        gz_topics=gz_topics,
        interfaces=PLANAR_INTERFACES,
        true_odometry=True,
        warnings=tuple(f"<{tag}> is not supported" for tag in unused if plugin.has(tag)),
    )


def _joint_state_publisher(plugin: _Plugin) -> GazeboDrive:
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


def _joint_command_system(interface: str, default_topic: str) -> Callable[[_Plugin], GazeboDrive]:
    def make(plugin: _Plugin) -> GazeboDrive:
        if plugin.flag("use_actuator_msg", False):
            raise _CannotWorkError("<use_actuator_msg> is not supported")
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


def _is_below(description: RobotDescription, joint: str, others: Iterable[str]) -> bool:
    """Whether a joint hangs on the link that one of the others moves."""
    joint_of = {each.child: each for each in description.joints}
    found = joint_of.get(description.joints_by_name[joint].parent)
    while found is not None:
        if found.name in others:
            return True
        found = joint_of.get(found.parent)
    return False


PLANAR_MOVE = "gazebo_ros/PlanarMove"  # the twin's own type: ros2_controllers has nothing like it
PLANAR_INTERFACES: tuple[JointInterface, ...] = (
    (LINEAR_X, "velocity"),
    (LINEAR_Y, "velocity"),
    (ANGULAR_Z, "velocity"),
)

_MAKERS: Mapping[str, Callable[[_Plugin], GazeboDrive]] = {
    "gazebo_ros_diff_drive": _gazebo_ros_diff_drive,
    "diff-drive-system": _diff_drive_system,
    "mecanum-drive-system": _mecanum_drive_system,
    "ackermann-steering-system": _ackermann_steering_system,
    "gazebo_ros_ackermann_drive": _gazebo_ros_ackermann_drive,
    "gazebo_ros_planar_move": _gazebo_ros_planar_move,
    "velocity-control-system": _velocity_control_system,
    "gazebo_ros_joint_state_publisher": _joint_state_publisher,
    "joint-state-publisher-system": _joint_state_publisher,
    "joint-position-controller-system": _joint_command_system("position", "joint/{joint}/{index}/cmd_pos"),
    "joint-controller-system": _joint_command_system("velocity", "joint/{joint}/cmd_vel"),
}
