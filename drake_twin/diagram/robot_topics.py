"""The topics of a robot: those of its controllers and of its joint states."""

from functools import partial
from typing import Any

from pydrake.systems.framework import Context, Diagram

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.odometry_frames import TF_ODOMETRY
from drake_twin.controllers.periodic_controller import PeriodicController
from drake_twin.diagram.plant import RobotInPlant
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.diagram.sensors_of_twin import publish_sensors
from drake_twin.diagram.topics import CommandTopic, PublishedTopic, Topics
from drake_twin.diagram.update_periods import published_rate
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import controller_topic, robot_topic


def publish_robot(
    plan: RobotPlan,
    robot: RobotDiagram,
    system: Diagram,
    topics: Topics,
    in_plant: RobotInPlant,
    time_step: float,
) -> None:
    """Export the ports of a robot's topics and actions.

    Args:
        plan: The robot.
        robot: The parts of its sub-diagram.
        system: Its sub-diagram as a system of the builder.
        topics: Collects the topics.
        in_plant: The robot in the plant.
        time_step: The physics step (s).
    """
    plans = {item.name: item for item in plan.controllers}
    for name, kind in robot.always_published.items():
        drafter = None if robot.delays else robot.broadcaster.drafter(name, in_plant.places)
        topic, rate = robot_topic(plan, name), published_rate(robot.broadcaster.setup.update_period)
        topics.publish(PublishedTopic(topic, kind, system.GetOutputPort(name), rate, plan.name, drafter=drafter))
    publish_sensors(plan.name, robot.sensors, system, topics, time_step)
    for name, item in robot.controllers.items():
        for own, kind in item.subscribed.items():
            if (listened := controller_topic(plan, plans[name], own)) is not None:
                port = system.GetInputPort(f"{name}/{own}")
                topics.listen(CommandTopic(listened, _type(plans[name], own, kind), port, plan.name, name, own))
        for own, kind in item.actions.items():
            port = system.GetInputPort(f"{name}/{own}")
            action_name = f"{plan.robot.topic_namespace}/{name}/{own}"
            topics.listen(CommandTopic(action_name, kind, port, plan.name, name, own), action=True)
        for own, kind in item.published.items():
            published = controller_topic(plan, plans[name], own)
            if published is not None and own != TF_ODOMETRY:
                port, more = system.GetOutputPort(f"{name}/{own}"), times_of(item, own, time_step)
                more["drafter"] = None if robot.delays else item.drafter(own, in_plant.places)
                topics.publish(PublishedTopic(published, kind, port, robot=plan.name, controller=name, **more))


def times_of(controller: Controller, own: str, time_step: float) -> dict[str, Any]:
    """Return when a controller publishes on a topic, as `PublishedTopic` takes it.

    What an update publishes is on the port in the physics step after it.
    """
    setup = controller.setup
    times: dict[str, Any] = {"rate": published_rate(setup.update_period)}
    if isinstance(controller, PeriodicController):
        times |= {"offset": setup.update_offset + time_step, "publication": partial(_publication, controller, own)}
    return times


def _publication(controller: PeriodicController, own: str, root_context: Context) -> Any:
    return controller.publication(own, controller.GetMyContextFromRoot(root_context))


def _type(plan: ControllerPlan, own: str, kind: str) -> str:
    """Return the ROS type of a controller's topic."""
    return kind if plan.wiring is None else plan.wiring.types.get(own, kind)
