"""Gazebo's drive plugins: what is read of one, the controller that it becomes, and the registry of plugins.

Other packages add a plugin with the same decorator as the twin's own::

    from drake_twin.description.gazebo_drive import DrivePlugin, GazeboDrive, gazebo_plugin

    @gazebo_plugin("libmy_spinner.so")
    def my_spinner(plugin: DrivePlugin) -> GazeboDrive:
        joints = plugin.joints("joint")
        return GazeboDrive(
            plugin.plugin,
            plugin.controller("velocity_controllers/JointGroupVelocityController", {"joints": list(joints)}),
            topics=plugin.ros_topics({"commands": "spin"}),
            interfaces=tuple((joint, "velocity") for joint in joints),
        )

in a module that a program imports, or that the entry-point group ``drake_twin.gazebo_plugins`` names.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any, TypeAlias

from drake_twin.dataclass import dataclass
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.gazebo_plugins import CannotWorkError as CannotWorkError
from drake_twin.description.gazebo_plugins import PluginReader, plugin_kind, ros_topic
from drake_twin.description.planar_joints import ANGULAR_Z, LINEAR_X, LINEAR_Y
from drake_twin.description.robot_description import GazeboPlugin, RobotDescription
from drake_twin.extensions import Registry

if TYPE_CHECKING:
    from drake_twin.description.performers import Performer, PerformerDetector
    from drake_twin.description.touches import TouchDetector
    from drake_twin.description.triggers import Trigger

FOR_EVER = 1e9  # s; Gazebo's plugins have no timeout, and zero means one update to some controllers

JointInterface = tuple[str, str]
Element = tuple[str, int | None]

EACH_STEP = 1e6  # Hz: the rate of what happens in each physics step, however short

ACTUATORS = "actuator_msgs/msg/Actuators"

# The twin's own types: ros2_controllers has nothing like them.
PLANAR_MOVE = "gazebo_ros/PlanarMove"
ODOMETRY_PUBLISHER = "gz_sim/OdometryPublisher"
POSE_PUBLISHER = "gz_sim/PosePublisher"
DETACHABLE_JOINT = "gz_sim/DetachableJoint"
JOINT_PID = "gz_sim/JointPidController"
JOINT_CONTROLLER = "gz_sim/JointController"
ROLLER_WHEELS = "drake_twin/RollerWheels"
MULTICOPTER = "gz_sim/Multicopter"
LIFT_DRAG = "gz_sim/LiftDrag"
ADVANCED_LIFT_DRAG = "gz_sim/AdvancedLiftDrag"
TRIGGERED_PUBLISHER = "gz_sim/TriggeredPublisher"
PERFORMERS = "gz_sim/Performers"
PERFORMER_DETECTOR = "gz_sim/PerformerDetector"
KINETIC_ENERGY_MONITOR = "gz_sim/KineticEnergyMonitor"
LINEAR_BATTERY = "gz_sim/LinearBattery"
HYDRODYNAMICS = "gz_sim/Hydrodynamics"
THRUSTER = "gz_sim/Thruster"
ELEVATOR = "gz_sim/Elevator"
TOUCH_PLUGIN = "gz_sim/TouchPlugin"
BUOYANCY_ENGINE = "gz_sim/BuoyancyEngine"
SPACECRAFT_THRUSTER = "gz_sim/SpacecraftThruster"
TRAJECTORY_FOLLOWER = "gz_sim/TrajectoryFollower"
LIGHTER_THAN_AIR = "gz_sim/LighterThanAirDynamics"
TRACKS = "gz_sim/Tracks"
PLANAR_INTERFACES: tuple[JointInterface, ...] = (
    (LINEAR_X, "velocity"),
    (LINEAR_Y, "velocity"),
    (ANGULAR_Z, "velocity"),
)


@dataclass(frozen=True)
class Servo:
    """How a joint follows a command: as a PD controller, or as fast as its limits allow.

    Attributes:
        proportional: The effort for an error of the command: N·m/rad or N/m, of a velocity N·m·s/rad or N·s/m. None for
            a servo that is there in the next step.
        derivative: The effort against a velocity, of a position's servo (N·m·s/rad or N·s/m).
        time_constant: Of a velocity's servo without the others, with which it approaches that against inertia alone
            (s); 0 for one that is there in the next step.
    """

    proportional: float | None = None
    derivative: float = 0.0
    time_constant: float = 0.0


@dataclass(frozen=True)
class GazeboDrive:
    """A plugin as a controller.

    Attributes:
        plugin: The plugin.
        controller: The controller that does the same; None when the plugin cannot work.
        topics: The controller's own topic (as its system names the port) → the topic that the plugin uses instead,
            relative to the robot's namespace, or with a leading ``/`` where a remapping puts it elsewhere. A topic of
            the controller that is not here is not published.
        gz_topics: The same in gz's transport, as a ``parameter_bridge`` names it; ``{model}`` stands for the model.
        types: Topic of the controller → the ROS type that the plugin or its bridge has there, where it is another one.
        elements: Topic with another type → the field of its messages that commands all joints, and the index in that;
            None for a field that is a number, as of the ``std_msgs/msg/Float64`` that need not be given.
        interfaces: (joint, command interface) for each actuator that it needs.
        efforts: Joint → the largest effort that the plugin gives it (N·m or N).
        velocities: Joint → the largest velocity that the plugin gives it (rad/s or m/s).
        servos: (joint, command interface) → how the plugin follows a command, if not as the twin does by itself.
        start: Joint → the position (rad or m) that the plugin commands at the start.
        true_odometry: Whether its odometry is the true pose in the world, and not computed from the wheels.
        odometry_rate: The rate of its odometry (Hz); 0 for each physics step, None for the controller's own.
        not_started: Why the plugin cannot work.
        has_failed: Whether that is an exception in the code of another package.
        is_part: Whether the controller of another plugin does its work.
        warnings: What of it changes nothing in the twin.
        unread: Its elements that are ignored.
        triggers: What the twin publishes when it hears messages, beside the controller or without one.
        performers: The boxes as which its model is a performer, likewise.
        detectors: The regions of its model that notice performers, likewise.
        touches: What tells that its model has touched another one, likewise.
    """

    plugin: GazeboPlugin
    controller: ControllerParameters | None = None
    topics: Mapping[str, str] = field(default_factory=dict)
    gz_topics: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    elements: Mapping[str, Element] = field(default_factory=dict)
    interfaces: tuple[JointInterface, ...] = ()
    efforts: Mapping[str, float] = field(default_factory=dict)
    velocities: Mapping[str, float] = field(default_factory=dict)
    servos: Mapping[JointInterface, Servo] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    true_odometry: bool = False
    odometry_rate: float | None = None
    not_started: str | None = None
    has_failed: bool = False
    is_part: bool = False
    warnings: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    triggers: "tuple[Trigger, ...]" = ()
    performers: "tuple[Performer, ...]" = ()
    detectors: "tuple[PerformerDetector, ...]" = ()
    touches: "tuple[TouchDetector, ...]" = ()


class DrivePlugin(PluginReader):
    """Reads a drive plugin.

    Args:
        plugin: The plugin.
        description: The robot it is on.
        name: The name of the controller that it becomes.
    """

    def __init__(self, plugin: GazeboPlugin, description: RobotDescription, name: str):
        super().__init__(plugin)
        self.description = description
        self.name = name

    def joints(self, tag: str, *, required: bool = True) -> tuple[str, ...]:
        """Read the joints that the elements of a tag name.

        Raises:
            CannotWorkError: If the robot has no such movable joint, or a required element is missing.
        """
        found = self.texts(tag)
        if required and not found:
            raise CannotWorkError(f"<{tag}> is missing")
        self.check_joints(found)
        return found

    def check_joints(self, joints: Iterable[str]) -> None:
        """Check that the robot has the joints, and that they move.

        Raises:
            CannotWorkError: If it does not.
        """
        movable = {joint.name for joint in self.description.movable_joints}
        for joint in joints:
            if joint not in movable:
                raise CannotWorkError(f"the robot has no movable joint {joint!r}")

    def link(self, tag: str = "link_name") -> str:
        """Read the link that an element names.

        Raises:
            CannotWorkError: If the robot has no such link, or the element is missing.
        """
        link = self.text(tag, "")
        if link not in self.description.links:
            raise CannotWorkError(f"the robot has no link {link!r}" if link else f"<{tag}> is missing")
        return link

    def controller(self, kind: str, parameters: Mapping[str, Any]) -> ControllerParameters:
        """Return the entry of a controller of a type with these parameters."""
        return ControllerParameters(self.name, kind, dict(parameters))

    def drive(
        self, kind: str, parameters: Mapping[str, Any], names: Mapping[str, tuple[str, str]] | None = None, **more: Any
    ) -> GazeboDrive:
        """Return the plugin as a controller of a type with these parameters.

        Args:
            kind: The controller's type.
            parameters: Its parameters.
            names: Its topics, as `gz_topics` takes them.
            more: Other attributes of `GazeboDrive`.
        """
        if names is not None:
            more["topics"], more["gz_topics"] = self.gz_topics(names)
        return GazeboDrive(self.plugin, self.controller(kind, parameters), **more)

    def ros_topics(self, names: Mapping[str, str | None]) -> dict[str, str]:
        """Return the controller's topics by the plugin's names, remapped; those without a name are left out."""
        return {own: ros_topic(self.plugin, name) for own, name in names.items() if name is not None}

    def gz_topics(self, names: Mapping[str, tuple[str, str]]) -> tuple[dict[str, str], dict[str, str]]:
        """Return the controller's topics for ROS and for gz.

        Args:
            names: Topic of the controller → the element that names it, and gz's name below the model without one.
        """
        ros, gz = {}, {}
        for own, (tag, default) in names.items():
            gz[own] = self.text(tag, f"/model/{{model}}/{default}")
            given = gz[own].strip("/")
            ros[own] = given if self.has(tag) else default.rpartition("/")[2]
        ros.pop("tf_odometry", None)  # all robots' transforms go to /tf
        return ros, gz


def of_model(topic: str, model: str) -> str:
    """Return a topic of gz's transport with the model's name in the place of ``{model}``."""
    return topic.replace("{model}", model)


Convert: TypeAlias = Callable[[DrivePlugin], GazeboDrive]

# By the kind of plugin, as `plugin_kind` names it.
GAZEBO_PLUGINS: Registry[Convert] = Registry(
    "Gazebo plugin", "gazebo_plugin", "drake_twin.gazebo_plugins", ["drake_twin.description.plugins"]
)


def gazebo_plugin(*names: str) -> Callable[[Convert], Convert]:
    """Register a function that converts a Gazebo plugin to a controller.

    The function may raise `CannotWorkError`.

    Args:
        names: The plugin's names: its library (``libgazebo_ros_diff_drive.so``, ``gz-sim-diff-drive-system``), with or
            without ``lib``, ``.so`` and gz's version where the library is Gazebo's own.

    Raises:
        InputError: If another function converts a plugin of the name.
    """

    def register(function: Convert) -> Convert:
        for name in names:
            GAZEBO_PLUGINS.add(plugin_kind(GazeboPlugin(name, "")), function, function)
        return function

    return register


def as_rate(rate: float) -> float:
    """Return a plugin's rate (Hz), where zero or less stands for every physics step."""
    return rate if 0.0 < rate < EACH_STEP else EACH_STEP
