"""What the page shows of a twin, as plain data: its structure, and its present state."""

from collections.abc import Container, Iterable, Mapping
from dataclasses import asdict
from hashlib import sha1
from typing import Any

from drake_twin.cockpit.joint_commands import JointCommands, joint_slider
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.panel import PANEL_KINDS
from drake_twin.cockpit.teleop import Teleop
from drake_twin.twin.twin import Twin

_DIGITS = 6


def structure(twin: Twin, commands: JointCommands, teleop: Teleop, *, only_displayed: bool) -> dict[str, Any]:
    """Return what changes only when robots come and go: robots, controllers, sliders, drives, overlays, panels.

    Args:
        twin: The twin.
        commands: Its sliders.
        teleop: Its drives.
        only_displayed: Whether the robots are displayed without physics.
    """
    return {
        "display_only": only_displayed,
        "overlays": [
            {"name": kind.name, "label": kind.label, "hint": kind.hint, "key": kind.key}
            for kind in OVERLAY_KINDS.values()
        ],
        "panels": list(PANEL_KINDS),
        "robots": [
            {
                "name": plan.name,
                "kind": plan.description.name,
                "joint_states": f"{plan.robot.topic_namespace}/joint_states",
                "controllers": [
                    {"name": item.name, "type": item.type, "problem": item.problem} for item in plan.controllers
                ],
                "groups": [
                    {
                        "topic": group.topic,
                        "type": group.type,
                        "controller": group.controller,
                        "sliders": [asdict(slider) for slider in group.sliders],
                        "home": [
                            twin.entities.start_positions(plan.name).get(item.joint, 0.0) for item in group.sliders
                        ],
                    }
                    for group in commands.groups.values()
                    if group.robot == plan.name and not only_displayed
                ],
                "drives": [
                    {"topic": topic, "controller": controller, "flies": teleop.flies(topic)}
                    for topic, (robot, controller) in teleop.topics.items()
                    if robot == plan.name and not only_displayed
                ],
                "joints": [
                    {
                        "slides": joint.type == "prismatic",
                        "follows": joint.mimic is not None,
                        **asdict(joint_slider(joint)),
                    }
                    for joint in plan.description.movable_joints
                ],
            }
            for plan in twin.built.plans
        ],
    }


def layout_key(twin: Twin) -> str:
    """Return what a browser keeps the shape of the page by: a digest of the names and files of the first robots."""
    first = twin.entities.first_robots
    robots = [(robot.name, robot.model) for robot in twin.scenario.robots if robot.name in first]
    return sha1(repr(robots).encode()).hexdigest()[:12]


def state(
    twin: Twin,
    commands: JointCommands,
    more: Mapping[str, Any],
    looked_at: Container[str] | None = None,
    *,
    with_efforts: bool = True,
) -> dict[str, Any]:
    """Return what changes with time.

    Args:
        twin: The twin.
        commands: Its sliders.
        more: More entries at the top level.
        looked_at: The robots that a page shows; of others it is only told whether they are stopped. None for all.
        with_efforts: Whether to evaluate efforts, for which the plant solves the next step; else they are None.
    """
    robots: dict[str, dict[str, Any]] = {}
    for plan in twin.built.plans:
        robots[plan.name] = {"stopped": twin.control.is_stopped(plan.name)}
        if looked_at is not None and plan.name not in looked_at:
            continue
        at = twin.robot_state(plan.name, with_efforts=with_efforts)
        robots[plan.name] |= {
            "controllers": twin.control.manager(plan.name).states,
            "positions": _rounded(at.positions),
            "velocities": _rounded(at.velocities),
            "efforts": _rounded(at.efforts) if with_efforts else None,
            "pose": _rounded(at.base_pose),
        }
    return {
        "time": round(twin.time, 9),
        "steps": twin.clock.step_count,
        "paused": twin.clock.paused,
        "rate": twin.clock.real_time_rate,
        "time_step": twin.scenario.time_step,
        "robots": robots,
        "commands": {
            topic: _rounded(commands.values(topic))
            for topic, group in commands.groups.items()
            if looked_at is None or group.robot in looked_at
        },
        **more,
    }


def _rounded(values: Iterable[float]) -> list[float]:
    return [round(float(value), _DIGITS) for value in values]
