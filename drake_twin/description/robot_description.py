"""A robot as plain, frozen data: the content of its file, independent of any simulator.

Units are SI: m, rad, s, kg, N, N·m. Rotations are roll, pitch, yaw about fixed x, y, z axes, as in URDF.
"""

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.dataclass import dataclass
from drake_twin.description.link_surface import LinkSurface
from drake_twin.description.plugin_element import GazeboPlugin as GazeboPlugin
from drake_twin.findings import Place

if TYPE_CHECKING:
    from pydrake.math import RigidTransform

Vector3 = tuple[float, float, float]

MOVABLE_JOINT_TYPES = ("revolute", "continuous", "prismatic")

POSED_JOINT_TYPES = ("ball", "universal", "screw")  # SDF's: one position does not say where the child link is


@dataclass(frozen=True)
class Pose:
    """A frame in another: translation (m) and roll, pitch, yaw (rad)."""

    xyz: Vector3 = (0.0, 0.0, 0.0)
    rpy: Vector3 = (0.0, 0.0, 0.0)

    def compose(self, inner: "Pose") -> "Pose":
        """Return the pose of what has a pose in this frame, seen from where this frame is given."""
        if inner == Pose():
            return self
        return Pose.of(self.transform() @ inner.transform())

    @classmethod
    def of(cls, transform: "RigidTransform") -> "Pose":
        """Return the pose that is Drake's transform."""
        from pydrake.math import RollPitchYaw

        xyz, rpy = transform.translation().tolist(), RollPitchYaw(transform.rotation()).vector().tolist()
        return cls(tuple(xyz), tuple(rpy))

    def transform(self) -> "RigidTransform":
        """Return the pose as Drake's transform."""
        from pydrake.math import RigidTransform, RollPitchYaw

        return RigidTransform(RollPitchYaw(*self.rpy), self.xyz)

    @property
    def text(self) -> str:
        """The pose as SDF writes it."""
        return " ".join(f"{value:.17g}" for value in (*self.xyz, *self.rpy))


@dataclass(frozen=True)
class Mimic:
    """A follower joint's position: ``multiplier`` · (position of ``joint``) + ``offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


NO_LIMIT = 1e16  # SDF's value for "no limit"; files have the largest double, too


@dataclass(frozen=True)
class JointLimits:
    """Position (rad or m), velocity (rad/s or m/s) and effort (N·m or N) bounds; infinite where the file has none."""

    lower: float = -inf
    upper: float = inf
    velocity: float = inf
    effort: float = inf

    def __post_init__(self) -> None:
        if self.lower <= -NO_LIMIT:
            object.__setattr__(self, "lower", -inf)
        for name in ("upper", "velocity", "effort"):
            if getattr(self, name) >= NO_LIMIT:
                object.__setattr__(self, name, inf)


@dataclass(frozen=True)
class Joint:
    """A joint between two links.

    ``origin`` is the joint frame in the parent link, ``axis`` is a unit vector in the joint frame. ``child_origin`` is
    the child link in the moved joint frame: the identity in URDF, something else in some SDF files. MJCF has the
    inertia of the actuator (kg·m² or kg) as ``armature``, and a spring with a stiffness and a position of rest.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Pose = Pose()
    axis: Vector3 = (1.0, 0.0, 0.0)
    limits: JointLimits = JointLimits()
    damping: float = 0.0
    friction: float = 0.0
    mimic: Mimic | None = None
    child_origin: Pose = Pose()
    armature: float = 0.0
    stiffness: float = 0.0
    rest_position: float = 0.0

    @property
    def is_movable(self) -> bool:
        """Whether the joint has one position: revolute, continuous or prismatic."""
        return self.type in MOVABLE_JOINT_TYPES


MUJOCO = "<actuator>"  # the plugin of the hardware that an MJCF robot's actuators are: no file can name it


@dataclass(frozen=True)
class CommandInterface:
    """What a controller may command at a joint: ``position``, ``velocity`` or ``effort``, within min and max."""

    name: str
    min: float = -inf
    max: float = inf


@dataclass(frozen=True)
class StateInterface:
    """What a joint reports: ``position``, ``velocity`` or ``effort``, and its value at the start."""

    name: str
    initial_value: float | None = None


@dataclass(frozen=True)
class ControlledJoint:
    """A ``<joint>`` of a ``<ros2_control>`` tag."""

    name: str
    command_interfaces: tuple[CommandInterface, ...] = ()
    state_interfaces: tuple[StateInterface, ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)

    def together_with(self, other: "ControlledJoint") -> "ControlledJoint":
        """Merge two tags of one joint; the other's interfaces replace those of the same name."""
        commands = {item.name: item for item in (*self.command_interfaces, *other.command_interfaces)}
        states = {item.name: item for item in (*self.state_interfaces, *other.state_interfaces)}
        return ControlledJoint(
            self.name, tuple(commands.values()), tuple(states.values()), {**self.parameters, **other.parameters}
        )


@dataclass(frozen=True)
class HardwareSensor:
    """A ``<sensor>`` of a ``<ros2_control>`` tag.

    Attributes:
        name: Its name.
        state_interfaces: State interface (``orientation.x``, …) → its ``initial_value``; NaN where the file has none.
        parameters: Its ``<param>`` values.
    """

    name: str
    state_interfaces: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Gpio:
    """A ``<gpio>`` of a ``<ros2_control>`` tag: inputs and outputs that are no joint's.

    Attributes:
        name: Its name.
        commands: Command interface → its value at the start; NaN without one.
        states: State interface → its value at the start; NaN without one.
    """

    name: str
    commands: Mapping[str, float] = field(default_factory=dict)
    states: Mapping[str, float] = field(default_factory=dict)

    def problem(self, kind: str, interface: str) -> str | None:
        """Return why a ``command`` or ``state`` interface cannot be claimed; None if it can."""
        has = self.commands if kind == "command" else self.states
        if interface in has:
            return None
        known = f"it has {', '.join(has)}" if has else f"it has no {kind} interface"
        return f"gpio {self.name} has no {interface} {kind} interface in <ros2_control> ({known})"


@dataclass(frozen=True)
class HardwareSystem:
    """A ``<ros2_control>`` tag: one hardware component, its joints, sensors, GPIOs and ``<hardware><param>`` values."""

    name: str
    type: str
    plugin: str
    joints: tuple[ControlledJoint, ...] = ()
    sensors: tuple[HardwareSensor, ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)
    gpios: tuple[Gpio, ...] = ()
    place: Place = field(default=Place(""), compare=False)


@dataclass(frozen=True)
class Sensor:
    """A sensor that Gazebo would simulate: a ``<sensor>``, or a plugin of Gazebo classic that is one.

    Attributes:
        name: Its name; a ``<sensor>`` of ``<ros2_control>`` with the same name is this one, as for gz_ros2_control.
        kind: Its type as written, such as ``imu`` or ``gpu_ray``; of a plugin its kind, such as ``gazebo_ros_p3d``.
        link: The link that it is attached to; empty for one on a joint.
        joint: The joint that it is on; empty for one on a link.
        gazebo_link: The link that Gazebo attaches it to, which is the parent of the link's fixed joints, as Gazebo
            folds these; of a joint its child.
        pose: The sensor in the link's frame, or in the joint's frame.
        pose_frame: The frame that the pose is relative to; empty for the link or joint.
        frame: The frame that the file gives its values; empty where it gives none.
        topic: Gazebo's own topic; empty where the file gives none.
        update_rate: The rate of its measurements (Hz); 0 for at every step.
        place: Where it was written.
        text: Its element, for what its kind reads of it beyond this.
        places: Where each element of ``text`` was written, in the order of the document.
    """

    name: str
    kind: str
    link: str = ""
    joint: str = ""
    gazebo_link: str = ""
    pose: Pose = Pose()
    pose_frame: str = ""
    frame: str = ""
    topic: str = ""
    update_rate: float = 0.0
    place: Place = field(default=Place(""), compare=False)
    text: str = field(default="<sensor/>", compare=False, repr=False)
    places: tuple[Place, ...] = field(default=(), compare=False, repr=False)


@dataclass(frozen=True)
class RobotDescription:
    """One robot as its file describes it.

    Attributes:
        name: The robot's name in the file.
        links: The links' names, in file order.
        joints: The joints, in file order.
        systems: Its ``<ros2_control>`` tags.
        plugins: The plugins of its ``<gazebo>`` tags.
        surfaces: Link name → the surface of its shapes, by ``<gazebo reference>``; of SDF only whether they collide.
        sensors: The sensors of its ``<gazebo>`` tags, or of an SDF's links and joints.
        text: The expanded URDF (or the SDF), which is also published as ``robot_description``.
        file: The file it was read from.
        base_joints: Joints that the twin adds between the world and the root link, so that the base can be commanded;
            they can be looked up by name like the robot's own, and are not among its ``joints``.
        root_pose: The pose of the root link in the model's frame, which is what is spawned; of SDF only.
        loose_links: The other links that no joint holds, with their poses in the model's frame; of SDF only.
        windy_links: The links with ``<enable_wind>``.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    systems: tuple[HardwareSystem, ...] = ()
    plugins: tuple[GazeboPlugin, ...] = ()
    surfaces: Mapping[str, LinkSurface] = field(default_factory=dict)
    sensors: tuple[Sensor, ...] = ()
    text: str = field(default="", repr=False)
    file: Path | None = None
    base_joints: tuple[Joint, ...] = ()
    root_pose: Pose = field(default_factory=Pose)
    loose_links: Mapping[str, Pose] = field(default_factory=dict)
    windy_links: tuple[str, ...] = ()

    @cached_property
    def root_link(self) -> str:
        """The first link that is not the child of any joint."""
        children = {joint.child for joint in self.joints}
        return next(link for link in self.links if link not in children)

    @cached_property
    def joints_by_name(self) -> dict[str, Joint]:
        """Joint name → joint, including the base's."""
        return {joint.name: joint for joint in (*self.joints, *self.base_joints)}

    @property
    def movable_joints(self) -> tuple[Joint, ...]:
        """The joints that have a position, in file order."""
        return tuple(joint for joint in self.joints if joint.is_movable)

    @cached_property
    def controlled_joints(self) -> dict[str, ControlledJoint]:
        """Joint name → its tag in ``<ros2_control>``, in file order, of the joints that the robot has and that move."""
        movable = {joint.name for joint in (*self.movable_joints, *self.base_joints)}
        found: dict[str, ControlledJoint] = {}
        for joint in (joint for system in self.systems for joint in system.joints if joint.name in movable):
            known = found.get(joint.name)
            # Actuator and sensor of a joint may be separate hardware, each with a tag.
            found[joint.name] = joint if known is None else known.together_with(joint)
        return found

    @property
    def actuated_joints(self) -> tuple[Joint, ...]:
        """The movable joints with a command interface, in the order of ``<ros2_control>``, without followers."""
        joints = (self.joints_by_name[name] for name, tag in self.controlled_joints.items() if tag.command_interfaces)
        return tuple(joint for joint in joints if joint.is_movable and joint.mimic is None)

    @cached_property
    def hardware_sensors(self) -> dict[str, HardwareSensor]:
        """Sensor name → its tag in ``<ros2_control>``."""
        return {sensor.name: sensor for system in self.systems for sensor in system.sensors}

    @cached_property
    def sensor_states(self) -> dict[str, float]:
        """State interface of a sensor (``imu/orientation.x``) → its ``initial_value``; NaN where the file has none."""
        return {
            f"{sensor.name}/{interface}": value
            for sensor in self.hardware_sensors.values()
            for interface, value in sensor.state_interfaces.items()
        }

    @cached_property
    def gpios(self) -> dict[str, Gpio]:
        """GPIO name → its tags in ``<ros2_control>``, merged, in file order."""
        found: dict[str, Gpio] = {}
        for gpio in (gpio for system in self.systems for gpio in system.gpios):
            known = found.get(gpio.name, Gpio(gpio.name))
            found[gpio.name] = Gpio(gpio.name, {**known.commands, **gpio.commands}, {**known.states, **gpio.states})
        return found

    def sensor(self, name: str, kind: str) -> Sensor | None:
        """Return the simulated sensor behind a sensor of ``<ros2_control>``; None if it has another name."""
        own = name.strip("/")
        return next((item for item in self.sensors if (item.name.strip("/"), item.kind) == (own, kind)), None)

    @property
    def controller_files(self) -> tuple[str, ...]:
        """The controllers' YAML files that the ros2_control plugins of the ``<gazebo>`` tags name."""
        return tuple(file for plugin in self.plugins for file in plugin.parameters)

    def with_followers(self, positions: Mapping[str, float]) -> dict[str, float]:
        """Return joint positions (rad or m) with each mimic follower where its leader puts it.

        Args:
            positions: Joint name → position of the joints that do not follow another; values of followers are replaced.
        """
        result = dict(positions)

        def position(joint: Joint) -> float:
            if joint.mimic is None:
                return result[joint.name]
            leader = position(self.joints_by_name[joint.mimic.joint])
            return joint.mimic.multiplier * leader + joint.mimic.offset

        for joint in self.movable_joints:
            result[joint.name] = position(joint)
        return result

    def limits_of_command(self, joint: str, interface: str, *, of_joint: bool = True) -> tuple[float, float]:
        """Return the tightest bounds on a command: those of the URDF joint and of its ``<ros2_control>`` interface.

        Args:
            joint: The joint's name, or that of a GPIO, whose commands have no bounds.
            interface: ``position`` (rad or m), ``velocity`` (rad/s or m/s) or ``effort`` (N·m or N).
            of_joint: Whether the joint's own limits count.
        """
        if joint in self.gpios:
            return -inf, inf
        limits = self.joints_by_name[joint].limits
        v, effort = limits.velocity, limits.effort
        bounds = {"position": (limits.lower, limits.upper), "velocity": (-v, v), "effort": (-effort, effort)}
        lower, upper = bounds[interface] if of_joint else (-inf, inf)
        for command in self.controlled_joints[joint].command_interfaces:
            if command.name == interface:
                lower, upper = max(lower, command.min), min(upper, command.max)
        return lower, upper
