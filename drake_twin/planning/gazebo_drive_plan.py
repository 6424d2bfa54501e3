"""The plan of robots that Gazebo plugins drive, as if ros2_control drove them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

from drake_twin.description.gazebo_drive import PLANAR_MOVE, ROLLER_WHEELS, GazeboDrive
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


def usable_drives(drives: Sequence[GazeboDrive], fixed_base: bool) -> tuple[list[GazeboDrive], list[Finding]]:
    """Return the plugins that become controllers, and findings of other plugins and of unused entries."""
    usable: list[GazeboDrive] = []
    findings: list[Finding] = []
    for drive in drives:
        place = drive.plugin.place
        if drive.controller is None:
            findings.append(Finding.at(Kind.NOT_STARTED, f"Gazebo plugin {drive.not_started}", place))
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
        common = f" of {name}"
        findings += [
            Finding.at(Kind.IGNORED, f"<{tag}>{common}", place, common=common, cause=Cause.UNREAD)
            for tag in drive.unread
        ]
    return usable, findings


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
