"""The plan of robots that Gazebo plugins drive, as if ros2_control drove them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Any

from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER
from drake_twin.description.gazebo_drive import (
    ODOMETRY_PUBLISHER,
    PLANAR_MOVE,
    ROLLER_WHEELS,
    GazeboDrive,
    of_model,
)
from drake_twin.description.gazebo_plugins import plugin_node_name
from drake_twin.description.planar_joints import commanded_planar_joints
from drake_twin.description.robot_description import (
    CommandInterface,
    ControlledJoint,
    HardwareSystem,
    Joint,
    RobotDescription,
    StateInterface,
)
from drake_twin.findings import Cause, Finding, Kind
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.scenario import Robot

_UNSTAMPED = "_unstamped"


def usable_drives(drives: Sequence[GazeboDrive], fixed_base: bool) -> tuple[list[GazeboDrive], list[Finding]]:
    """Return the plugins that become controllers, and findings of other plugins and of unused entries."""
    usable: list[GazeboDrive] = []
    findings: list[Finding] = []
    for drive in drives:
        place = drive.plugin.place
        if drive.is_part:
            findings += _unread(drive, plugin_node_name(drive.plugin))
            continue
        if drive.controller is None:
            findings.append(
                Finding.at(
                    Kind.FAILED if drive.has_failed else Kind.NOT_STARTED, f"Gazebo plugin {drive.not_started}", place
                )
            )
            continue
        name = f"Gazebo plugin {drive.controller.name}"
        if drive.controller.type == PLANAR_MOVE and (problem := _planar_problem(drive, drives, fixed_base)):
            what = f"{name} ({drive.plugin.filename}): {problem}"
            findings.append(Finding.at(Kind.NOT_STARTED, what, place))
            continue
        if drive.controller.type == ROLLER_WHEELS and (fixed_base or any(map(_is_planar_move, usable))):
            continue
        usable.append(drive)
        findings += [
            Finding.at(Kind.WARNING, f"{name}: {warning}", place, cause=Cause.PLUGIN) for warning in drive.warnings
        ]
        findings += _unread(drive, drive.controller.name)
    return usable, findings


def _unread(drive: GazeboDrive, name: str) -> list[Finding]:
    """Return a finding for each element of a plugin that is ignored."""
    place, common = drive.plugin.place, f" of Gazebo plugin {name}"
    return [
        Finding.at(Kind.IGNORED, f"<{tag}>{common}", place, common=common, cause=Cause.UNREAD) for tag in drive.unread
    ]


def _is_planar_move(drive: GazeboDrive) -> bool:
    return drive.controller is not None and drive.controller.type == PLANAR_MOVE


def _planar_problem(planar: GazeboDrive, drives: Sequence[GazeboDrive], fixed_base: bool) -> str | None:
    """Return why a plugin cannot move the base over the plane; None if it can."""
    if fixed_base:
        return "it moves the base, which is fixed to the world"
    for other in drives:
        wheels, topics = other.controller, {*planar.topics.values()}
        if wheels and wheels.type != PLANAR_MOVE and not topics.isdisjoint(other.topics.values()):
            return f"it would move the base in addition to {wheels.name}, which drives wheels by the same topics"
    return None


def with_actuators(description: RobotDescription, drives: Sequence[GazeboDrive]) -> RobotDescription:
    """Return the robot with a command interface for each joint that a plugin commands, and the plugin's limits.

    If a plugin commands the base, the robot gets the joints for it.
    """
    interfaces: dict[str, list[str]] = {}
    efforts: dict[str, float] = {}
    velocities: dict[str, float] = {}
    for drive in drives:
        for joint, interface in drive.interfaces:
            interfaces.setdefault(joint, []).append(interface)
        efforts = {**drive.efforts, **efforts}  # of two plugins at a joint the first one has it
        velocities = {**drive.velocities, **velocities}
    if not interfaces:
        return description
    base_joints = tuple(joint for joint in commanded_planar_joints(description.root_link) if joint.name in interfaces)
    commanded = [
        ControlledJoint(joint, tuple(CommandInterface(name) for name in names), _states(description, joint))
        for joint, names in interfaces.items()
    ]
    others = [
        ControlledJoint(joint.name, (), (StateInterface("position"), StateInterface("velocity")))
        for joint in description.movable_joints
        if joint.name not in interfaces and joint.name not in description.controlled_joints
    ]
    system = HardwareSystem("gazebo", "system", "", tuple(commanded + others))
    joints = tuple(_limited(joint, efforts, velocities) for joint in description.joints)
    return replace(description, systems=(*description.systems, system), joints=joints, base_joints=base_joints)


def _states(description: RobotDescription, joint: str) -> tuple[StateInterface, ...]:
    if joint not in description.joints_by_name:
        return ()  # of the base, whose pose is in the odometry
    known = description.controlled_joints.get(joint)
    return known.state_interfaces if known else (StateInterface("position"), StateInterface("velocity"))


def _limited(joint: Joint, efforts: Mapping[str, float], velocities: Mapping[str, float]) -> Joint:
    limits = joint.limits
    if joint.name in efforts:
        limits = replace(limits, effort=min(limits.effort, efforts[joint.name]))
    if joint.name in velocities:
        limits = replace(limits, velocity=min(limits.velocity or inf, velocities[joint.name]))
    return joint if limits is joint.limits else replace(joint, limits=limits)


def with_stamps(drive: GazeboDrive, robot: Robot) -> GazeboDrive:
    """Return a drive that listens to messages with a header, where a bridge has them on its topic."""
    stamped = [
        own
        for own, topic in drive.gz_topics.items()
        if own.endswith(_UNSTAMPED) and f"/{of_model(topic, robot.name).lstrip('/')}" in robot.stamped_topics
    ]
    if not stamped or drive.controller is None:
        return drive
    names = {own: own.removesuffix(_UNSTAMPED) if own in stamped else own for own in (*drive.topics, *drive.gz_topics)}
    parameters = {**drive.controller.parameters, "use_stamped_vel": True}
    return replace(
        drive,
        controller=replace(drive.controller, parameters=parameters),
        topics={names[own]: topic for own, topic in drive.topics.items()},
        gz_topics={names[own]: topic for own, topic in drive.gz_topics.items()},
    )


def drives_by_name(drives: Iterable[GazeboDrive], taken: Mapping[str, Any]) -> dict[str, GazeboDrive]:
    """Return plugins under unused names; of two joint state broadcasters ros2_control's is kept."""
    has_broadcaster = any(item.type == JOINT_STATE_BROADCASTER for item in taken.values())
    found: dict[str, GazeboDrive] = {}
    for drive in drives:
        if drive.controller is None or (has_broadcaster and drive.controller.type == JOINT_STATE_BROADCASTER):
            continue
        name = drive.controller.name
        while name in taken or name in found:
            name += "_plugin"
        found[name] = drive
    return found


def leave_one_transform(plans: dict[str, ControllerPlan], chosen: Iterable[str], robot: Robot) -> None:
    """Leave the base's transform to the plugins of Gazebo whose own a bridge takes to ``/tf``.

    Without a bridge for it, gz-sim's OdometryPublisher leaves it to a drive.
    """
    names = [name for name in chosen if name in plans]
    left = [name for name in names if getattr(plans[name].parameters, "enable_odom_tf", False)]
    topics = {name: _transform_topic(plans[name], robot) for name in left}
    bridged = [name for name, topic in topics.items() if topic and robot.remappings.get(topic) == "/tf"]
    for name in [name for name in reversed(left) if name not in bridged]:
        if len(left) > 1 and (plans[name].type == ODOMETRY_PUBLISHER or (bridged and topics[name])):
            plans[name] = replace(plans[name], parameters=replace(plans[name].parameters, enable_odom_tf=False))
            left.remove(name)


def _transform_topic(plan: ControllerPlan, robot: Robot) -> str:
    """Return the topic of Gazebo on which a plugin publishes the base's transform; empty for other controllers."""
    topic = "" if plan.wiring is None else of_model(plan.wiring.gz_topics.get("tf_odometry", ""), robot.name)
    return f"/{topic.lstrip('/')}" if topic else ""
