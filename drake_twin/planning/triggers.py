"""The topics in ROS of what publishes messages when it hears one."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import (
    PERFORMER_DETECTOR,
    PERFORMERS,
    TOUCH_PLUGIN,
    TRIGGERED_PUBLISHER,
    of_model,
)
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import is_same_topic
from drake_twin.planning.topics import controller_topic, with_bridges_of
from drake_twin.planning.world_sensors import ModelPlan

if TYPE_CHECKING:
    from drake_twin.description.touches import TouchDetector
    from drake_twin.description.triggers import Trigger, TriggeredMessage, TriggeredRequest
    from drake_twin.description.world_file import WorldFile
    from drake_twin.planning.performers import Detection

_STAMPED, _TWIST = "geometry_msgs/msg/TwistStamped", "geometry_msgs/msg/Twist"
_NUMBERS, _NUMBER = "std_msgs/msg/Float64MultiArray", "std_msgs/msg/Float64"


@dataclass(frozen=True)
class OwnedTrigger:
    """A trigger of a robot or of the world.

    Attributes:
        owner: The robot; empty for the world.
        number: Its number among those of its owner, from 0.
        trigger: The trigger, with topics of ROS.
        topics: The topics in ROS that it hears: several where several robots have the one of gz.
    """

    owner: str
    number: int
    trigger: "Trigger"
    topics: tuple[str, ...]


def plan_noticing(
    plans: Sequence[RobotPlan], models: Sequence[ModelPlan], world_file: "WorldFile | None", bridged: Mapping[str, str]
) -> "Detection | None":
    """Return what notices performers and touches, as `drake_twin.planning.performers` plans it; None without any."""
    kinds = {PERFORMERS, PERFORMER_DETECTOR, TOUCH_PLUGIN}
    is_asked = world_file is not None and any(plugin.type in kinds for plugin in world_file.plugins)
    if not is_asked and not any(plan.detectors or plan.touches for plan in plans):
        return None
    from drake_twin.planning.performers import plan_detection

    return plan_detection(plans, models, world_file, bridged)


def plan_triggers(
    plans: Iterable[RobotPlan],
    models: Iterable[ModelPlan],
    world_file: "WorldFile | None",
    bridged: Mapping[str, str],
) -> tuple[OwnedTrigger, ...]:
    """Return what publishes messages, with the topics in ROS of the drives and sensors that gz's topics are those of.

    Other topics have the name that a bridge gives them, or the same one in ROS.

    Args:
        plans: The robots.
        models: The models of the world that have sensors.
        world_file: The content of the world file.
        bridged: Topic in gz → topic in ROS.
    """
    plans, models = tuple(plans), tuple(models)
    plugins = () if world_file is None else world_file.plugins
    of_world = [plugin.parameters for plugin in plugins if plugin.type == TRIGGERED_PUBLISHER]
    touches = [(plugin.parameters, plugin.model) for plugin in plugins if plugin.type == TOUCH_PLUGIN]
    of_world += _enabling(touches)
    owned = [("", number, trigger) for number, trigger in enumerate(of_world)]
    for plan in plans:
        of_plan = [*plan.triggers, *_enabling((item, plan.name) for item in plan.touches)]
        owned += [(plan.name, number, trigger) for number, trigger in enumerate(of_plan)]
    if not owned:
        return ()
    touches += [(item, plan.name) for plan in plans for item in plan.touches]
    spaces = {of_model(detector.topic, model) for detector, model in touches}
    worlds = set() if world_file is None else {world_file.name, *_stem(world_file)}
    known = [*_of_drives(plans), *_of_sensors(plans), *_of_sensors(models)]
    bridged = with_bridges_of(plans, bridged)

    def in_ros(topic: str) -> tuple[str, ...]:
        found = dict.fromkeys(ros for gz, ros in known if is_same_topic(gz, topic))
        return tuple(found) or (bridged.get(topic, topic),)

    def planned(owner: str, number: int, trigger: "Trigger") -> OwnedTrigger:
        heard = in_ros(of_model(trigger.topic, owner))
        told = (
            replace(item, topic=topic) for item in trigger.messages for topic in in_ros(of_model(item.topic, owner))
        )
        requests = tuple(_owned(_checked(item, worlds, spaces), owner, heard[0]) for item in trigger.requests)
        trigger = replace(trigger, topic=heard[0], messages=tuple(told), requests=requests)
        return OwnedTrigger(owner, number, trigger, heard)

    return tuple(planned(*item) for item in owned)


def _enabling(touches: "Iterable[tuple[TouchDetector, str]]") -> "Iterator[Trigger]":
    """Yield what enables detectors of touches, of a model each."""
    for detector, model in touches:
        from drake_twin.description.triggers import enabling_triggers

        yield from enabling_triggers(detector, of_model(detector.topic, model))


def _stem(world_file: "WorldFile") -> Iterator[str]:
    """Yield the name that services of the twin have for a world."""
    if world_file.file is not None:
        yield world_file.file.name.partition(".")[0]


def _checked(item: "TriggeredRequest", worlds: set[str], spaces: set[str]) -> "TriggeredRequest":
    """Return a request, without what it asks for where its world or its TouchPlugin is not in the twin."""
    from drake_twin.description.touches import EnableTouch

    if isinstance(item.request, EnableTouch) and item.request.topic not in spaces:
        return replace(item, request=None, problem=f"the twin has no service {item.service}")
    if not (item.request and item.world and worlds) or item.world in worlds:
        return item
    return replace(item, request=None, problem=f"{item.service}: the world is not called {item.world!r}")


def _owned(item: "TriggeredRequest", owner: str, topic: str) -> "TriggeredRequest":
    """Return a request with the robot that drops a model, and the topic that asks for it, where it does that."""
    from drake_twin.description.breadcrumbs import Deploy

    request = item.request
    return replace(item, request=replace(request, owner=owner, topic=topic)) if isinstance(request, Deploy) else item


def about_triggers(
    triggers: Iterable[OwnedTrigger], published: Mapping[str, str], heard: Mapping[str, str]
) -> Iterator[Finding]:
    """Yield a finding for each topic of a trigger that has another type in the twin, and each unknown service.

    Args:
        triggers: The triggers.
        published: Topic → its ROS type, of what the twin publishes.
        heard: Topic → its ROS type, of what controllers listen to.
    """
    for item in triggers:
        trigger = item.trigger
        topics = item.topics if trigger.type else ()
        known = [(topic, trigger.type, published.get(topic, heard.get(topic, trigger.type))) for topic in topics]
        known += [
            (message.topic, message.type, heard[message.topic])
            for message in trigger.messages
            if message.topic in heard and not _is_like(heard[message.topic], message.type)
        ]
        for topic, own, other in known:
            if own != other:
                what = f"Gazebo plugin {trigger.name}: {topic} is {other} here, and not {own}"
                yield replace(Finding.at(Kind.WARNING, what, trigger.place), robot=item.owner)
        for request in trigger.requests:
            if request.problem:
                what = f"Gazebo plugin {trigger.name}: it does not call a service: {request.problem}"
                yield replace(Finding.at(Kind.NOT_STARTED, what, trigger.place), robot=item.owner)


def as_type(kind: str, message: "TriggeredMessage") -> Any:
    """Return a message's fields as those of the type that a topic has."""
    if kind == message.type or not _is_like(kind, message.type):
        return message.fields
    return {"twist": message.fields} if kind == _STAMPED else [message.fields.get("data", 0.0)]


def _is_like(kind: str, other: str) -> bool:
    return kind == other or (kind, other) in ((_STAMPED, _TWIST), (_NUMBERS, _NUMBER))


def _of_drives(plans: Iterable[RobotPlan]) -> Iterator[tuple[str, str]]:
    for plan in plans:
        for controller in plan.controllers:
            names = {} if controller.wiring is None else controller.wiring.gz_topics
            for own, name in names.items():
                if (topic := controller_topic(plan, controller, own)) is not None:
                    yield f"/{of_model(name, plan.name).strip('/')}", topic


def _of_sensors(plans: Iterable[RobotPlan | ModelPlan]) -> Iterator[tuple[str, str]]:
    for plan in plans:
        for sensor in plan.sensors:
            for topic in sensor.topics:
                if topic.topic is not None and topic.in_gazebo:
                    yield topic.in_gazebo, topic.topic
