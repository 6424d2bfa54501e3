"""One of Gazebo's drive plugins: what is read of it, and what it amounts to in the twin."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.gazebo_plugins import PluginReader, ros_topic
from drake_twin.description.planar_joints import ANGULAR_Z, LINEAR_X, LINEAR_Y
from drake_twin.description.robot_description import GazeboPlugin, RobotDescription

FOR_EVER = 1e9  # s; Gazebo's plugins have no timeout, and zero means one update to some controllers

JointInterface = tuple[str, str]

PLANAR_MOVE = "gazebo_ros/PlanarMove"  # the twin's own type: ros2_controllers has nothing like it
PLANAR_INTERFACES: tuple[JointInterface, ...] = (
    (LINEAR_X, "velocity"),
    (LINEAR_Y, "velocity"),
    (ANGULAR_Z, "velocity"),
)


@dataclass(frozen=True)
class GazeboDrive:
    """A plugin as a controller.

    Attributes:
        plugin: the plugin.
        controller: the controller that does the same; None when the plugin cannot work.
        topics: the controller's own topic (as its system names the port) → the topic that the plugin uses instead,
            relative to the robot's namespace, or with a leading ``/`` where a remapping puts it elsewhere. A topic of
            the controller that is not here is not published.
        gz_topics: the same in gz's transport, as a ``parameter_bridge`` names it; ``{model}`` stands for the model.
        types: topic of the controller → the ROS type that the plugin or its bridge has there, where it is another one.
        interfaces: (joint, command interface) for each actuator that it needs.
        efforts: joint → the largest effort that the plugin gives it (N·m or N).
        start: joint → the position (rad or m) that the plugin commands at the start.
        true_odometry: whether its odometry is the true pose in the world instead of what the wheels tell.
        not_started: why the plugin cannot work.
        warnings: what of it changes nothing in the twin.
        unread: its elements of which no use is made.
    """

    plugin: GazeboPlugin
    controller: ControllerParameters | None = None
    topics: Mapping[str, str] = field(default_factory=dict)
    gz_topics: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    interfaces: tuple[JointInterface, ...] = ()
    efforts: Mapping[str, float] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    true_odometry: bool = False
    not_started: str | None = None
    warnings: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()


class CannotWorkError(Exception):
    """A plugin that Gazebo loads, and that then does nothing."""


class DrivePlugin(PluginReader):
    """A plugin, the robot it is on, and the name of the controller it becomes."""

    def __init__(self, plugin: GazeboPlugin, description: RobotDescription, name: str):
        super().__init__(plugin)
        self.description = description
        self.name = name

    def joints(self, tag: str, *, required: bool = True) -> tuple[str, ...]:
        """Joints that the robot has."""
        found = self.texts(tag)
        if required and not found:
            raise CannotWorkError(f"<{tag}> is missing")
        self.check_joints(found)
        return found

    def check_joints(self, joints: Iterable[str]) -> None:
        """Refuses joints that the robot does not have or that do not move."""
        movable = {joint.name for joint in self.description.movable_joints}
        for joint in joints:
            if joint not in movable:
                raise CannotWorkError(f"the robot has no movable joint {joint!r}")

    def controller(self, kind: str, parameters: Mapping[str, Any]) -> ControllerParameters:
        """The controller with these parameters."""
        return ControllerParameters(self.name, kind, dict(parameters))

    def ros_topics(self, names: Mapping[str, str | None]) -> dict[str, str]:
        """The controller's topics by the plugin's names, with its remappings; those without a name are left out."""
        return {own: ros_topic(self.plugin, name) for own, name in names.items() if name is not None}

    def gz_topics(self, names: Mapping[str, tuple[str, str]]) -> tuple[dict[str, str], dict[str, str]]:
        """For ROS and for gz: the controller's topics by an element of the plugin, or by gz's name below the model."""
        ros, gz = {}, {}
        for own, (tag, default) in names.items():
            gz[own] = self.text(tag, f"/model/{{model}}/{default}")
            given = gz[own].strip("/")
            ros[own] = given if self.has(tag) else default.rpartition("/")[2]
        ros.pop("tf_odometry", None)  # all robots' transforms go to /tf
        return ros, gz


def as_rate(rate: float) -> float:
    """A plugin's rate (Hz), where zero stands for every update."""
    return rate if rate > 0.0 else 1e6
