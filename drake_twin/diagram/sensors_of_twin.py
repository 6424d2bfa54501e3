"""The sensors of all robots in the root diagram, and their topics."""

from collections.abc import Iterable, Mapping, Sequence

from pydrake.systems.framework import DiagramBuilder, System

from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.diagram.robot_sensors import SensorPort, SensorSurroundings, add_other_sensors
from drake_twin.diagram.topics import Topics
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.sensors.sensor_host import SensorHost


def publish_sensors(
    plan: RobotPlan, ports: Iterable[SensorPort], system: System, topics: Topics, time_step: float
) -> None:
    """Publish the topics of a robot's sensors.

    Args:
        plan: The robot.
        ports: The ports of the topics.
        system: The system that has these ports.
        topics: Collects the topics.
        time_step: The physics step (s), the period of a sensor without a rate.
    """
    for item in ports:
        assert item.topic.topic is not None, "a topic without a port"
        rate, sensor = item.plan.rate or 1.0 / time_step, item.plan.place
        port = system.GetOutputPort(item.name)
        topics.publish(item.topic.topic, port, item.topic.type, rate, plan.name, sensor=sensor)


def add_sensors(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plans: Sequence[RobotPlan],
    robots: Mapping[str, RobotDiagram],
    topics: Topics,
    surroundings: SensorSurroundings,
) -> tuple[Finding, ...]:
    """Add all sensors that no controller reads, in one system; return what they cannot measure."""
    host = SensorHost()
    found: dict[str, tuple[SensorPort, ...]] = {}
    findings: list[Finding] = []
    for plan in plans:
        instance = parts.robots[plan.name].instance
        ports, warnings = add_other_sensors(host, plan, instance, surroundings, robots[plan.name].sensors)
        found[plan.name] = ports
        findings += (Finding(Kind.WARNING, text, robot=plan.name) for text in warnings)
    if host.sensors:
        builder.AddNamedSystem("sensors", host)
        for output, port in host.inputs_from(parts.plant, parts.scene_graph):
            builder.Connect(output, port)
        for plan in plans:
            publish_sensors(plan, found[plan.name], host, topics, surroundings.time_step)
    return tuple(findings)
