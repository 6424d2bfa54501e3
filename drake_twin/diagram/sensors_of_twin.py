"""The sensors of all robots in the root diagram, and their topics."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from pydrake.multibody.tree import world_model_instance
from pydrake.systems.framework import DiagramBuilder, System

from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.diagram.robot_sensors import SensorPort, SensorSurroundings, add_other_sensors
from drake_twin.diagram.topics import PublishedTopic, Topics
from drake_twin.findings import Finding, Kind
from drake_twin.messages.draft import Draft, LaterDraft
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.world_sensors import ModelPlan
from drake_twin.sensors.sensor_host import SensorHost
from drake_twin.systems.plant_reading import Reading


def publish_sensors(owner: str, ports: Iterable[SensorPort], system: System, topics: Topics, time_step: float) -> None:
    """Publish the topics of sensors.

    Args:
        owner: The name of their robot, or of their model of the world.
        ports: The ports of the topics.
        system: The system that has these ports.
        topics: Collects the topics.
        time_step: The physics step (s), the period of a sensor without a rate.
    """
    for item in ports:
        assert item.topic.topic is not None, "a topic without a port"
        delay = item.system.delay
        topics.publish(
            PublishedTopic(
                item.topic.topic,
                item.topic.type,
                system.GetOutputPort(item.name),
                item.plan.rate or 1.0 / time_step,
                owner,
                sensor=item.plan.place,
                drafter=None if delay is None else partial(_ask, item),
                delay=delay,
            )
        )


def _ask(item: SensorPort, reading: Reading) -> Draft:
    """Begin to measure for a topic of a sensor with a delay."""
    context = item.system.host.GetMyContextFromRoot(reading.root_context)
    return LaterDraft(item.system.ask(item.topic.own, context))


def add_sensors(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plans: Sequence[RobotPlan],
    models: Sequence[ModelPlan],
    robots: Mapping[str, RobotDiagram],
    topics: Topics,
    surroundings: SensorSurroundings,
) -> tuple[Finding, ...]:
    """Add all sensors of robots and models of the world that no controller reads, in one system.

    Returns:
        What became of the models' sensors, and what the sensors cannot measure.
    """
    host = SensorHost()
    found: dict[str, tuple[SensorPort, ...]] = {}
    findings: list[Finding] = []
    for plan in plans:
        instance = parts.robots[plan.name].instance
        ports, warnings = add_other_sensors(host, plan, instance, surroundings, robots[plan.name].sensors)
        found[plan.name] = ports
        findings += (Finding(Kind.WARNING, text, robot=plan.name) for text in warnings)
    for model in models:
        anchors = parts.anchors.get(model.name)
        static = world_model_instance()
        instance = static if anchors is not None else parts.plant.GetModelInstanceByName(model.name)
        found[model.name], warnings = add_other_sensors(host, model, instance, surroundings, (), anchors)
        findings += (*model.findings, *(Finding(Kind.WARNING, f"{model.name}: {text}") for text in warnings))
    if host.sensors:
        builder.AddNamedSystem("sensors", host)
        for output, port in host.inputs_from(parts.ports, parts.scene_graph):
            builder.Connect(output, port)
        if host.wind_input is not None and not isinstance(surroundings.wind, tuple):
            builder.Connect(surroundings.wind.get_wind_info_output_port(), host.wind_input)
        for owner, ports in found.items():
            publish_sensors(owner, ports, host, topics, surroundings.time_step)
    return tuple(findings)
