"""The plugins of Gazebo classic and gz-sim that command single joints or publish their states, as controllers."""

from dataclasses import replace
from math import inf
from typing import Any

from drake_twin.description.gazebo_drive import (
    ACTUATORS,
    JOINT_CONTROLLER,
    JOINT_PID,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    Servo,
    as_rate,
    gazebo_plugin,
)


@gazebo_plugin("libgazebo_ros_joint_state_publisher.so")
def gazebo_ros_joint_state_publisher(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``libgazebo_ros_joint_state_publisher.so`` to a joint_state_broadcaster."""
    joints = plugin.joints("joint_name")
    topics = plugin.ros_topics({"joint_states": "joint_states"})
    return _joint_states(plugin, joints, plugin.number("update_rate", 100.0), topics, {})


@gazebo_plugin("gz-sim-joint-state-publisher-system")
def joint_state_publisher_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-joint-state-publisher-system`` to a joint_state_broadcaster."""
    joints = plugin.joints("joint_name", required=False)
    _, gz_topics = plugin.gz_topics({"joint_states": ("topic", "joint_state")})
    topics = {"joint_states": plugin.text("topic", "joint_states").strip("/")}
    return _joint_states(plugin, joints, plugin.number("update_rate", 0.0), topics, gz_topics)


def _joint_states(
    plugin: DrivePlugin, joints: tuple[str, ...], rate: float, topics: dict[str, str], gz_topics: dict[str, str]
) -> GazeboDrive:
    joints = joints or tuple(joint.name for joint in plugin.description.movable_joints)
    parameters = {"joints": list(joints), "interfaces": ["position", "velocity"], "update_rate": as_rate(rate)}
    kind = "joint_state_broadcaster/JointStateBroadcaster"
    return plugin.drive(kind, parameters, topics=topics, gz_topics=gz_topics)


@gazebo_plugin("gz-sim-joint-position-controller-system")
def joint_position_controller_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-joint-position-controller-system`` to a controller of positions, with its PID as servo.

    With ``<use_velocity_commands>`` the joint moves at ``<cmd_max>``, and is there at once.
    """
    drive = _joint_commands(plugin, "position", "joint/{joint}/{index}/cmd_pos")
    if not plugin.flag("use_velocity_commands", False):
        servo = _servo(plugin.number("p_gain", 1.0), plugin.number("d_gain", 0.01))
        return _with_pid(plugin, drive, servo, i_gain=0.1)
    fastest = plugin.number("cmd_max", 1000.0)
    if fastest <= 0.0:
        raise CannotWorkError(f"<cmd_max> is {fastest:g}, which is not a velocity to move at")
    return replace(
        drive,
        servos=dict.fromkeys(drive.interfaces, Servo()),
        velocities={joint: fastest for joint, _ in drive.interfaces},
    )


@gazebo_plugin("gz-sim-joint-controller-system")
def joint_controller_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-joint-controller-system`` to a controller of velocities, with its PID if it commands forces."""
    drive = _joint_commands(plugin, "velocity", "joint/{joint}/cmd_vel")
    if not plugin.flag("use_force_commands", False):
        if first := plugin.number("initial_velocity", 0.0):
            parameters = {"joints": [joint for joint, _ in drive.interfaces], "initial_velocity": first}
            drive = replace(drive, controller=plugin.controller(JOINT_CONTROLLER, parameters))
        return replace(drive, servos=dict.fromkeys(drive.interfaces, Servo()))
    drive = _with_pid(plugin, drive, _servo(plugin.number("p_gain", 1.0)))
    derivative = plugin.number("d_gain", 0.0)
    unused = f"<d_gain> of {derivative:g} is not simulated"
    return replace(drive, warnings=(*drive.warnings, unused)) if derivative else drive


@gazebo_plugin("gz-sim-apply-joint-force-system")
def apply_joint_force_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-apply-joint-force-system`` to a controller of efforts."""
    return _joint_commands(plugin, "effort", "joint/{joint}/cmd_force")


@gazebo_plugin("gz-sim-joint-trajectory-controller-system")
def joint_trajectory_controller_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-joint-trajectory-controller-system`` to a joint_trajectory_controller, with its PIDs as servos.

    Gains stand in the file in the order of the joints. A joint without any has none and is not driven, as in gz-sim.
    """
    named = plugin.joints("joint_name", required=False)
    joints = named or tuple(joint.name for joint in plugin.description.movable_joints)

    def of_joints(tag: str, default: float = 0.0) -> tuple[float, ...]:
        given = plugin.numbers(tag)[: len(joints)]
        return (*given, *[default] * (len(joints) - len(given)))

    proportional, derivative = of_joints("position_p_gain"), of_joints("position_d_gain")
    of_velocity = of_joints("velocity_p_gain")
    limits = zip(of_joints("position_cmd_min"), of_joints("position_cmd_max", -1.0), strict=True)
    efforts = {
        joint: effort for joint, bounds in zip(joints, limits, strict=True) if (effort := _largest(*bounds)) < inf
    }
    starts = of_joints("initial_position")
    unused = ("position_i_gain", "velocity_i_gain", "velocity_d_gain", "position_cmd_offset", "velocity_cmd_offset")
    for tag in ("position_i_min", "position_i_max", "velocity_i_min", "velocity_i_max"):
        plugin.has(tag)
    parameters = {
        "joints": list(joints),
        "command_interfaces": ["position"],
        "state_interfaces": ["position", "velocity"],
    }
    return plugin.drive(
        "joint_trajectory_controller/JointTrajectoryController",
        parameters,
        {"joint_trajectory": ("topic", "joint_trajectory")},
        interfaces=tuple((joint, "position") for joint in joints),
        efforts=efforts,
        servos={
            (joint, "position"): _servo(p, d + v)
            for joint, p, d, v in zip(joints, proportional, derivative, of_velocity, strict=True)
        },
        start={joint: start for joint, start in zip(joints, starts, strict=True) if start},
        warnings=tuple(f"<{tag}> is not simulated" for tag in unused if any(plugin.numbers(tag))),
    )


def _servo(proportional: float, derivative: float = 0.0) -> Servo:
    if not (proportional >= 0.0 and 0.0 <= derivative < inf):
        gains = f"{proportional:g} and {derivative:g}"
        raise CannotWorkError(f"its proportional and derivative gains are {gains}: a joint would run away")
    return Servo(proportional, derivative)


def _largest(lowest: float, highest: float) -> float:
    """Return the largest effort of a PID: the smaller of its two bounds, as Drake has one for both directions.

    It is infinite where the range is empty, which means no limit to gz-math.
    """
    if highest < lowest:
        return inf
    bounds = [abs(bound) for bound in (lowest, highest) if bound]
    if not bounds:
        raise CannotWorkError("its range of efforts is zero")
    return min(bounds)


# Updates of an integral part (Hz) where its gain is the proportional one (per second): between two of them it changes
# by 1 % of the proportional part. Each costs some 50 µs.
_FINENESS = 100.0
_LOWEST_RATE = 10.0


def _with_pid(plugin: DrivePlugin, drive: GazeboDrive, servo: Servo, *, i_gain: float = 0.0) -> GazeboDrive:
    """Return a drive with the servo of its PID, and with a controller of its integral part and its offset.

    Args:
        plugin: The plugin.
        drive: The drive.
        servo: Its servo.
        i_gain: The integral gain that the plugin has by default.
    """
    lowest, highest = plugin.number("cmd_min", -1000.0), plugin.number("cmd_max", 1000.0)
    largest = _largest(lowest, highest)
    warnings = []
    if largest < inf and lowest != -highest:
        warnings.append(f"efforts from {lowest:g} to {highest:g} are limited to {largest:g} in both directions")
    gain, offset = plugin.number("i_gain", i_gain), plugin.number("cmd_offset", 0.0)
    parameters: dict[str, Any] = {
        "joints": [joint for joint, _ in drive.interfaces],
        "interface": drive.interfaces[0][1],
        "i_gain": gain,
        "i_max": plugin.number("i_max", 1.0),
        "i_min": plugin.number("i_min", -1.0),
        "cmd_offset": offset,
    }
    if gain:
        relative = abs(gain) / max(servo.proportional or 0.0, abs(gain))
        parameters["update_rate"] = round(max(_FINENESS * relative, _LOWEST_RATE))
    adds = gain or offset
    return replace(
        drive,
        controller=plugin.controller(JOINT_PID, parameters) if adds else drive.controller,
        servos=dict.fromkeys(drive.interfaces, servo),
        efforts={joint: largest for joint, _ in drive.interfaces} if largest < inf else {},
        warnings=(*drive.warnings, *warnings),
    )


def _joint_commands(plugin: DrivePlugin, interface: str, default_topic: str) -> GazeboDrive:
    joints = plugin.joints("joint_name")
    number, warnings = (None, ()) if interface == "effort" else _actuator_number(plugin)
    default = default_topic.format(joint=joints[0], index=plugin.text("joint_index", "0"))
    below = plugin.text("sub_topic", "actuators" if number is not None else default)
    gz = f"/model/{{model}}/{below}" if number is None or plugin.has("sub_topic") else f"/{below}"
    gz = plugin.text("topic", gz)
    start = plugin.number("initial_position", 0.0) if interface == "position" else 0.0
    kind = f"{interface}_controllers/JointGroup{interface.title()}Controller"
    return plugin.drive(
        kind,
        {"joints": list(joints)},
        topics={"commands": gz.strip("/") if plugin.has("topic") else below},
        gz_topics={"commands": gz},
        types={"commands": "std_msgs/msg/Float64" if number is None else ACTUATORS},
        elements={} if number is None else {"commands": (interface, number)},
        interfaces=tuple((joint, interface) for joint in joints),
        start=dict.fromkeys(joints, start) if start else {},
        warnings=warnings,
    )


def _actuator_number(plugin: DrivePlugin) -> tuple[int | None, tuple[str, ...]]:
    """Return the element of an ``Actuators`` message that commands the plugin, and what is wrong with that."""
    is_asked = plugin.flag("use_actuator_msg", False)
    has_number = plugin.has("actuator_number")
    if is_asked and not has_number:  # as in gz-sim
        return None, ("<use_actuator_msg> without <actuator_number>: the commands are single numbers",)
    if not is_asked:
        return None, ()
    number = plugin.number("actuator_number", 0.0)
    if number < 0 or number != int(number):
        raise CannotWorkError(f"<actuator_number> is {number:g}, which is not an index")
    return int(number), ()
