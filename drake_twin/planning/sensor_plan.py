"""The plan of a robot's sensors: what each one measures, and its topics, frame and rate in ROS."""

import re
from collections.abc import Mapping
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription, Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.description.sensors import SENSOR_PLUGINS, sensor_text
from drake_twin.errors import TwinError, described
from drake_twin.findings import Cause, Finding, Kind
from drake_twin.planning.frame_names import misspelt_frame
from drake_twin.scenario import Robot
from drake_twin.sensors.noise import SILENT, Noise
from drake_twin.sensors.registry import SENSORS, sensor_class

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


@dataclass(frozen=True)
class SensorOwner:
    """A robot, or a model of the world, that has sensors.

    Attributes:
        name: Its name in Gazebo; ``OUTER::INNER`` of a model inside another.
        description: It as its file describes it.
        namespace: The namespace of its Gazebo sensors where no bridge runs.
        plugin_namespace: The namespace of the plugins of Gazebo classic.
        frame_prefix: The prefix of its link names in tf messages.
        remappings: Topic → the topic in its place, both in full.
        bridged: Topic in Gazebo → topic in ROS; None where no bridge runs.
        kind: ``robot`` or ``model``.
        is_static: Whether it has no joints in the simulation.
    """

    name: str
    description: RobotDescription
    namespace: str
    plugin_namespace: str = ""
    frame_prefix: str = ""
    remappings: Mapping[str, str] = field(default_factory=dict)
    bridged: Mapping[str, str] | None = None
    kind: str = "robot"
    is_static: bool = False


def plan_sensors(
    robot: Robot, description: RobotDescription, frame_prefix: str
) -> tuple[tuple[SensorPlan, ...], tuple[Finding, ...]]:
    """Plan the sensors of a robot; see `sensor_plans`.

    Args:
        robot: The scenario's entry.
        description: The robot.
        frame_prefix: The prefix of its link names in tf messages.
    """
    namespace = robot.topic_namespace
    return sensor_plans(
        SensorOwner(robot.name, description, namespace, namespace, frame_prefix, robot.remappings, robot.bridged)
    )


def sensor_plans(owner: SensorOwner) -> tuple[tuple[SensorPlan, ...], tuple[Finding, ...]]:
    """Plan the sensors of a robot or of a model of the world.

    Returns:
        The sensors that are simulated, and what became of the others and of what nobody reads.

    Raises:
        InputError: If a value in a sensor's element is invalid.
    """
    plans: list[SensorPlan] = []
    findings: list[Finding] = []
    taken: dict[str, str] = {}
    of_hardware = {sensor.name for system in owner.description.systems for sensor in system.sensors}
    for sensor in owner.description.sensors:
        what = sensor_text(sensor.name, sensor.kind, sensor.link or sensor.joint, sensor.topic)
        is_plugin = sensor.text.startswith("<plugin")
        kind = sensor_class(sensor.kind) if is_plugin == (sensor.kind in SENSOR_PLUGINS) else None
        reason = _wrong_place(sensor, kind, owner) if kind is not None else "the twin has no such sensor"
        element = SensorElement(sensor)
        settings, failure = None, None
        if kind is not None and reason is None:
            settings, reason, failure = _settings(sensor, kind, element)
        if failure is not None:
            findings.append(Finding.at(Kind.FAILED, f"{what}: {failure}", sensor.place))
            continue
        if kind is None or reason is not None:
            findings.append(Finding.at(Kind.NOT_STARTED, f"{what}: {reason}", sensor.place))
            continue
        findings += element.unread()
        if why := misspelt_frame(sensor.frame, owner.description.links):
            findings.append(Finding.at(Kind.WARNING, f"{what}: its frame is {sensor.frame!r}: {why}", sensor.place))
        plan = _plan(owner, sensor, kind, settings)
        if plan.place in {item.place for item in plans}:
            same = f"{what}: a sensor before it has this name, and Gazebo makes only that one"
            findings.append(Finding.at(Kind.NOT_STARTED, same, sensor.place))
            continue
        kept = []
        for topic in plan.topics:
            if topic.topic in taken:
                same = f"{what}: sensor {taken[topic.topic]!r} publishes on {topic.topic}, too: the first one does"
                findings.append(Finding.at(Kind.WARNING, same, sensor.place))
                continue
            if topic.topic is not None:
                taken[topic.topic] = sensor.name
            kept.append(topic)
        is_heard = sensor.name in of_hardware or any(topic.topic is not None for topic in kept)
        if owner.bridged is not None and kept and not is_heard:
            names = ", ".join(topic.in_gazebo for topic in kept)
            common = f": no bridge carries {names} to ROS"
            finding = Finding.at(Kind.WARNING, what + common, sensor.place, common=common, cause=Cause.BRIDGE)
            findings.append(finding)
        plans.append(replace(plan, topics=tuple(kept)))
    return tuple(plans), tuple(findings)


def _settings(sensor: Sensor, kind: "type[SensorSystem]", element: SensorElement) -> tuple[Any, str | None, str | None]:
    """Return a sensor's own settings, why it is not simulated, and how the code of another package has failed."""
    try:
        settings = kind.read(element)
        return settings, kind.problem(settings), None
    except TwinError:
        raise
    except Exception as error:
        if not SENSORS.is_of_others(sensor.kind):
            raise
        return None, None, described(error)


def _wrong_place(sensor: Sensor, kind: "type[SensorSystem]", owner: SensorOwner) -> str | None:
    """Return why a sensor of a kind cannot be where it is; None if it can."""
    if kind.on == "joint" and owner.is_static:
        return "the model is static: it has no joints"
    known = owner.description.links if kind.on == "link" else tuple(owner.description.joints_by_name)
    name = sensor.link if kind.on == "link" else sensor.joint
    if name in known:
        return None
    other = sensor.joint if kind.on == "link" else sensor.link
    if not name and other:
        return f"such a sensor is on a {kind.on}, and this is not one"
    return f"the {owner.kind} has no {kind.on} {name!r}" if name else f"it names no {kind.on}"


def _plan(owner: SensorOwner, sensor: Sensor, kind: "type[SensorSystem]", settings: Any) -> SensorPlan:
    scope = (*owner.name.split("::"), sensor.joint or sensor.gazebo_link, sensor.name)
    frame = sensor.frame or kind.default_frame(sensor, settings, "/".join(scope))
    if frame in owner.description.links:
        frame = owner.frame_prefix + frame
    noises = {name: noise for name, noise in kind.noises(settings).items() if noise != SILENT}
    default = gazebo_default(owner.name, sensor, kind.gz_topic or sensor.kind)
    base = default if sensor.topic in ("", "__default_topic__") else f"/{valid_topic(sensor.topic)}"
    topics = tuple(_topic(owner, item) for item in kind.topics(sensor, settings, base))
    return SensorPlan(sensor, kind, settings, frame, kind.rate(sensor, settings), topics, noises)


def gazebo_default(owner: str, sensor: Sensor, last: str) -> str:
    """Return the topic that Gazebo gives a sensor without ``<topic>``; ``*`` stands for the world's name."""
    on = f"link/{sensor.gazebo_link}" if sensor.link else f"joint/{sensor.joint}"
    model = owner.replace("::", "/model/")
    return f"/{valid_topic(f'{_ANY_WORLD}model/{model}/{on}/sensor/{sensor.name}/{last}')}"


def valid_topic(topic: str) -> str:
    """Return a topic as Gazebo's transport takes it (``TopicUtils::AsValidTopic``), without its leading slash."""
    return re.sub("@|~|//|:=", "", topic.replace(" ", "_")).strip("/")


def _topic(owner: SensorOwner, item: "SensorTopic") -> PlannedTopic:
    if item.is_ros:
        name = item.name if item.name.startswith("/") else f"{owner.plugin_namespace}/{item.name}"
        return PlannedTopic(item.own, item.type, owner.remappings.get(name, name))
    if owner.bridged is None:
        short = re.sub(r"^/world/\*/model/.*?/(?:link|joint)/.*?/sensor/", "", item.name)
        name = f"{owner.namespace}/{short.strip('/')}"
        return PlannedTopic(item.own, item.type, owner.remappings.get(name, name), item.name)
    return PlannedTopic(item.own, item.type, bridged_name(item.name, owner.bridged), item.name)


def bridged_name(in_gazebo: str, bridged: Mapping[str, str]) -> str | None:
    """Return the ROS topic that a bridge publishes a Gazebo topic on; None if it does not carry it."""
    return next((ros for gz, ros in bridged.items() if is_same_topic(in_gazebo, gz)), None)


def is_same_topic(in_gazebo: str, name: str) -> bool:
    """Tell whether a Gazebo topic, of any world where it begins with ``/world/*/``, has a name."""
    if in_gazebo.startswith(_ANY_WORLD):
        head, _, rest = name.removeprefix("/world/").partition("/")
        return name.startswith("/world/") and bool(head) and rest == in_gazebo.removeprefix(_ANY_WORLD)
    return in_gazebo == name
