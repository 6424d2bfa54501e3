"""The plan of a robot's sensors: what each one measures, and its topics, frame and rate in ROS."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from drake_twin.description.robot_description import RobotDescription, Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.description.sensors import sensor_text
from drake_twin.findings import Finding, Kind, at_places
from drake_twin.scenario import Robot
from drake_twin.sensors.noise import SILENT, Noise
from drake_twin.sensors.registry import sensor_class

if TYPE_CHECKING:
    from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic

_ANY_WORLD = "/world/*/"


@dataclass(frozen=True)
class PlannedTopic:
    """A topic of a sensor.

    Attributes:
        own: The name of the sensor's output port.
        type: The ROS message type.
        topic: Its full name in ROS; None if a bridge runs that does not carry it.
        in_gazebo: Its name in Gazebo; empty for one that a plugin publishes on ROS itself. ``*`` stands for any world.
    """

    own: str
    type: str
    topic: str | None
    in_gazebo: str = ""


@dataclass(frozen=True)
class SensorPlan:
    """A sensor that is simulated.

    Attributes:
        sensor: The sensor as the file describes it.
        kind: Its class.
        settings: What its kind has read of its element.
        frame: The ``frame_id`` of its messages.
        rate: The rate of its measurements (Hz); 0 for at every step.
        topics: Its topics.
        noises: Channel → its noise, where it has some.
    """

    sensor: Sensor
    kind: "type[SensorSystem]"
    settings: Any
    frame: str
    rate: float
    topics: tuple[PlannedTopic, ...]
    noises: Mapping[str, Noise] = field(default_factory=dict)

    @property
    def place(self) -> str:
        """The sensor's name below the robot, which no other has."""
        return f"{self.sensor.link or self.sensor.joint}/{self.sensor.name}"

    def as_plain(self) -> dict[str, Any]:
        """Return the sensor as plain data, for JSON."""
        return {
            "name": self.sensor.name,
            "kind": self.sensor.kind,
            "on": self.sensor.link or self.sensor.joint,
            "topics": {topic.topic: topic.type for topic in self.topics if topic.topic is not None},
            "frame": self.frame,
            "rate": self.rate,
            "noise": {name: noise.text for name, noise in self.noises.items()},
        }


def plan_sensors(
    robot: Robot, description: RobotDescription, frame_prefix: str
) -> tuple[tuple[SensorPlan, ...], tuple[Finding, ...]]:
    """Plan the sensors of a robot.

    Args:
        robot: The scenario's entry.
        description: The robot.
        frame_prefix: The prefix of its link names in tf messages.

    Returns:
        The sensors that are simulated, and what became of the others and of what nobody reads.

    Raises:
        InputError: If a value in a sensor's element is invalid.
    """
    plans: list[SensorPlan] = []
    findings: list[Finding] = []
    taken: dict[str, str] = {}
    for sensor in description.sensors:
        what = sensor_text(sensor.name, sensor.kind, sensor.link or sensor.joint, sensor.topic)
        kind = sensor_class(sensor.kind)
        reason = _wrong_place(sensor, kind, description) if kind is not None else "the twin has no such sensor"
        element = SensorElement(sensor)
        settings = None if reason or kind is None else kind.read(element)
        reason = reason or (None if kind is None else kind.problem(settings))
        if kind is None or reason is not None:
            findings.append(Finding.at(Kind.NOT_STARTED, f"{what}: {reason}", sensor.place))
            continue
        findings += at_places(Kind.IGNORED, element.unread())
        plan = _plan(robot, sensor, kind, settings, description, frame_prefix)
        kept = []
        for topic in plan.topics:
            if topic.topic in taken:
                same = f"{what}: sensor {taken[topic.topic]!r} publishes on {topic.topic}, too: the first one does"
                findings.append(Finding.at(Kind.WARNING, same, sensor.place))
                continue
            if topic.topic is not None:
                taken[topic.topic] = sensor.name
            kept.append(topic)
        if robot.bridged is not None and kept and all(topic.topic is None for topic in kept):
            names = ", ".join(topic.in_gazebo for topic in kept)
            findings.append(Finding.at(Kind.WARNING, f"{what}: no bridge carries {names} to ROS", sensor.place))
        plans.append(replace(plan, topics=tuple(kept)))
    return tuple(plans), tuple(findings)


def _wrong_place(sensor: Sensor, kind: "type[SensorSystem]", description: RobotDescription) -> str | None:
    """Return why a sensor of a kind cannot be where it is; None if it can."""
    known = description.links if kind.on == "link" else tuple(description.joints_by_name)
    name = sensor.link if kind.on == "link" else sensor.joint
    if name in known:
        return None
    other = sensor.joint if kind.on == "link" else sensor.link
    if not name and other:
        return f"such a sensor is on a {kind.on}, and this is not one"
    return f"the robot has no {kind.on} {name!r}" if name else f"it names no {kind.on}"


def _plan(
    robot: Robot,
    sensor: Sensor,
    kind: "type[SensorSystem]",
    settings: Any,
    description: RobotDescription,
    frame_prefix: str,
) -> SensorPlan:
    scope = (robot.name, sensor.joint or sensor.gazebo_link, sensor.name)
    frame = sensor.frame or kind.default_frame(sensor, settings, "/".join(scope))
    if frame in description.links:
        frame = frame_prefix.lstrip("/") + frame
    noises = {name: noise for name, noise in kind.noises(settings).items() if noise != SILENT}
    default = gazebo_default(robot.name, sensor, kind.gz_topic or sensor.kind)
    base = default if sensor.topic in ("", "__default_topic__") else f"/{valid_topic(sensor.topic)}"
    topics = tuple(_topic(robot, sensor, item) for item in kind.topics(sensor, settings, base))
    return SensorPlan(sensor, kind, settings, frame, kind.rate(sensor, settings), topics, noises)


def gazebo_default(robot: str, sensor: Sensor, last: str) -> str:
    """Return the topic that Gazebo gives a sensor without ``<topic>``; ``*`` stands for the world's name."""
    on = f"link/{sensor.gazebo_link}" if sensor.link else f"joint/{sensor.joint}"
    return f"{_ANY_WORLD}model/{robot}/{on}/sensor/{sensor.name}/{last}"


def valid_topic(topic: str) -> str:
    """Return a topic as Gazebo's transport takes it (``TopicUtils::AsValidTopic``), without its leading slash."""
    return re.sub("@|~|//|:=", "", topic.replace(" ", "_")).strip("/")


def _topic(robot: Robot, sensor: Sensor, item: "SensorTopic") -> PlannedTopic:
    below = f"{robot.topic_namespace}/"
    if item.is_ros:
        name = item.name if item.name.startswith("/") else below + item.name
        return PlannedTopic(item.own, item.type, robot.remapped(name))
    if robot.bridged is None:
        short = re.sub(r"^/world/\*/model/.*?/(?:link|joint)/.*?/sensor/", "", item.name)
        return PlannedTopic(item.own, item.type, robot.remapped(below + short.strip("/")), item.name)
    return PlannedTopic(item.own, item.type, bridged_name(item.name, robot.bridged), item.name)


def bridged_name(in_gazebo: str, bridged: Mapping[str, str]) -> str | None:
    """Return the ROS topic that a bridge publishes a Gazebo topic on; None if it does not carry it."""
    return next((ros for gz, ros in bridged.items() if is_same_topic(in_gazebo, gz)), None)


def is_same_topic(in_gazebo: str, name: str) -> bool:
    """Tell whether a Gazebo topic, of any world where it begins with ``/world/*/``, has a name."""
    if in_gazebo.startswith(_ANY_WORLD):
        head, _, rest = name.removeprefix("/world/").partition("/")
        return name.startswith("/world/") and bool(head) and rest == in_gazebo.removeprefix(_ANY_WORLD)
    return in_gazebo == name
