"""The names of a robot's topics: below its namespace, with its parameters, plugins and remappings applied."""

from collections.abc import Collection, Iterable, Mapping

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.registry import controller_class
from drake_twin.description.gazebo_drive import of_model
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.robot_plan import RobotPlan

JOINT_STATES, DYNAMIC_JOINT_STATES = "joint_states", "dynamic_joint_states"
ROBOT_DESCRIPTION, GROUND_TRUTH = "robot_description", "ground_truth/odom"

# The topics of every robot, below its namespace.
ROBOT_TOPICS = (JOINT_STATES, DYNAMIC_JOINT_STATES, ROBOT_DESCRIPTION, GROUND_TRUTH)


def robot_topic(plan: RobotPlan, name: str) -> str:
    """Return the full name of a robot's topic."""
    return plan.robot.remapped(f"{plan.robot.topic_namespace}/{name}")


def controller_topic(plan: RobotPlan, controller: ControllerPlan, own: str) -> str | None:
    """Return the full name of a controller's topic; None if its Gazebo plugin does not have it.

    Args:
        plan: The robot.
        controller: One of its controllers.
        own: The topic's name in the controller's class.
    """
    wiring = controller.wiring
    if wiring is None:
        kind = controller_class(controller.type) or Controller
        return robot_topic(plan, kind.topic_name(controller.name, controller.parameters, own))
    topic = wiring.topics.get(own)
    if topic is None:
        return None
    in_gazebo = of_model(wiring.gz_topics.get(own, ""), plan.name)
    in_gazebo = in_gazebo if in_gazebo.startswith("/") else f"/{in_gazebo}"
    if in_gazebo in plan.robot.remappings:  # by a parameter_bridge
        return plan.robot.remapped(in_gazebo)
    return plan.robot.remapped(topic) if topic.startswith("/") else robot_topic(plan, topic)


def with_bridges_of(plans: Iterable[RobotPlan], bridged: Mapping[str, str]) -> dict[str, str]:
    """Return topic in gz → topic in ROS, of the world's bridges and those of robots."""
    return {**bridged, **{gz: ros for plan in plans for gz, ros in plan.robot.remappings.items()}}


def topics_with_one_owner(plan: RobotPlan) -> set[str]:
    """Return the topics of this robot that no other robot may have."""
    robot, namespace = plan.robot, plan.robot.topic_namespace
    names = [f"{namespace}/{name}" for name in ROBOT_TOPICS]
    for item in plan.controllers:
        names += [name for name in robot.remappings if name.startswith(f"{namespace}/{item.name}/")]
        if item.wiring is not None:
            names += ["/" + of_model(name, robot.name).lstrip("/") for name in item.wiring.gz_topics.values()]
            names += [
                name if name.startswith("/") else f"{namespace}/{name}" for name in item.wiring.topics.values() if name
            ]
    return {robot.remapped(name) for name in names}


def own_topics(plan: RobotPlan, taken: Collection[str]) -> dict[str, str]:
    """Return remappings that keep a robot's topics apart from those of others where no bridge names them.

    Args:
        plan: The robot.
        taken: The topics of other robots.

    Returns:
        Its topic → the name that Gazebo has for it, of the plugins whose topic another robot has in ROS alone.
    """
    found = {}
    for item in plan.controllers:
        if item.wiring is None:
            continue
        for own in item.wiring.topics:
            in_gazebo = "/" + of_model(item.wiring.gz_topics.get(own, ""), plan.name).strip("/")
            topic = controller_topic(plan, item, own)
            is_bridged = in_gazebo in plan.robot.remappings
            if topic in taken and in_gazebo != "/" and not is_bridged and in_gazebo not in (topic, *taken):
                found[str(topic)] = in_gazebo
    return found
