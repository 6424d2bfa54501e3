"""The topics that the ros2_control plugin in a robot's file renames."""

from collections.abc import Sequence
from dataclasses import replace

from drake_twin.description.gazebo_plugins import is_ros2_control, plugin_remappings
from drake_twin.description.robot_description import RobotDescription
from drake_twin.scenario import Robot


def with_plugin_remappings(robot: Robot, description: RobotDescription, controllers: Sequence[str]) -> Robot:
    """Return a robot with the topics that ``<remapping>`` of its ros2_control plugin renames.

    gz_ros2_control gives the rules to its whole process, so that they hold for each controller. What the scenario
    renames comes first.

    Args:
        robot: The scenario's entry.
        description: Its description.
        controllers: The names of its controllers, whose private names begin with ``~``.
    """
    rules = [rule for plugin in description.plugins if is_ros2_control(plugin) for rule in plugin_remappings(plugin)]
    if not rules:
        return robot
    from drake_twin.ros2.launched import absolute_name

    namespace = robot.topic_namespace
    nodes = [f"{namespace}/{name}" for name in controllers]
    found = {
        absolute_name(before, namespace, node): absolute_name(after, namespace, node)
        for before, after in rules
        for node in (nodes if before.startswith("~") or after.startswith("~") else [""])
    }
    return replace(robot, remappings={**found, **robot.remappings})
