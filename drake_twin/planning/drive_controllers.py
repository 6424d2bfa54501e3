"""The controllers that Gazebo plugins become: their names, topics and transforms."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER
from drake_twin.description.gazebo_drive import ODOMETRY_PUBLISHER, GazeboDrive, of_model
from drake_twin.planning.controller_plan import ControllerPlan, Wiring
from drake_twin.scenario import Robot

_UNSTAMPED = "_unstamped"


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


def wiring_of(drive: GazeboDrive) -> Wiring:
    """Return the topics of a plugin's controller."""
    return Wiring(drive.topics, drive.gz_topics, drive.types, drive.elements, drive.true_odometry)


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
