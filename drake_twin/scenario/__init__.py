"""A whole twin as plain, frozen data: the world, the robots, what is commanded when.

Every front end (the builder, the command line, a file) ends in one `Scenario`, and only a `Scenario` becomes a
diagram, so that every twin can be printed, saved, compared and run again. Units are SI; rotations are roll, pitch, yaw.
"""

import typing
from collections.abc import Mapping
from dataclasses import field
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Vector3
from drake_twin.errors import InputError
from drake_twin.findings import Finding
from drake_twin.saved import saved
from drake_twin.scenario.names import name_in_twin as name_in_twin
from drake_twin.scenario.names import problem_of_name, problem_of_namespace
from drake_twin.scenario.node_program import NodeProgram as NodeProgram
from drake_twin.scenario.push import PUSH_DURATION as PUSH_DURATION  # for those who import it from here
from drake_twin.scenario.push import Push as Push
from drake_twin.scenario.push import problems_of_push
from drake_twin.typed_data import ValuePath, misfits
from drake_twin.values import LARGEST

# Drake's discrete solvers that support joint servos and mimic joints (TAMSI ignores both).
CONTACT_APPROXIMATIONS = ("lagged", "similar", "sap")

# How physics advances: with Drake's discrete solvers, or its convex integrator with error control.
DISCRETE, CENIC = "discrete", "cenic"
ENGINES = (DISCRETE, CENIC)

_IN_AN_ISLAND = 8  # robots that share a plant beside others: each step has a cost of its own, and more cost more each

# Steps outside these bounds (s) simulate nothing, and times beyond the last (s) overflow a step count.
SHORTEST_STEP, LONGEST_STEP, LONGEST_TIME = 1e-6, 0.1, 1e9
LONGEST_DELAY = 1.0  # s, of which all steps are kept

# How shapes touch: flat ones with their faces, or all of them in points.
HYDROELASTIC, POINT = "hydroelastic", "point"
CONTACTS = (HYDROELASTIC, POINT)

# The name in `Scenario.values` of the ground's coefficient of friction.
GROUND_FRICTION = "friction"

# What a collision mesh becomes: its convex hull, or convex pieces of it.
COLLISION_KINDS = ("hull", "decomposition")


@saved("World")
@dataclass(frozen=True)
class World:
    """The world around the robots. What is given here replaces what the world file says.

    Attributes:
        gravity: The acceleration of free fall in the world frame (m/s²); by default the file's, or 9.81 downwards.
        ground: Whether there is solid ground. By default the file's planes, or the half space z < 0 without a file;
            true adds that half space where the file has no plane, false leaves the file's planes out.
        ground_friction: The ground's coefficient of friction; by default the file's, or 1.
        file: An SDF world: a path, ``package://`` or ``model://``, or the name of a built-in one such as ``empty.sdf``.
        contact: ``hydroelastic``: flat shapes of the world touch with their faces; or ``point``: in a point.
        without_models: The names of models of the file to leave out, such as those that are robots of the scenario.
        model_poses: Model of the file → its pose in place of the file's: x, y, z (m), roll, pitch, yaw (rad).
        model_copies: Name of a further model → the model of the file that it is like, at the same pose unless
            `model_poses` gives it one.
        bridged: Of the sensors of the file's models: topic in Gazebo → the topic in ROS that a bridge publishes it on;
            None where no bridge runs, so that each one is published below its model's name.
        wind: The velocity of the air in the world frame (m/s); by default the file's, or none.
    """

    gravity: Vector3 | None = None
    ground: bool | None = None
    ground_friction: float | None = None
    file: str | None = None
    contact: str = HYDROELASTIC
    without_models: tuple[str, ...] = ()
    model_poses: Mapping[str, tuple[float, float, float, float, float, float]] = field(default_factory=dict)
    model_copies: Mapping[str, str] = field(default_factory=dict)
    bridged: Mapping[str, str] | None = None
    wind: Vector3 | None = None

    @property
    def has_own_ground(self) -> bool:
        """Whether the half space z < 0 is solid, whatever the world file says."""
        return self.file is None if self.ground is None else self.ground


@saved("Robot")
@dataclass(frozen=True)
class Robot:
    """One robot.

    Attributes:
        name: Its name in the twin.
        model: Its file: a path, ``package://`` or ``model://`` (xacro, URDF, SDF or MJCF).
        xacro_args: Values for the file's ``<xacro:arg>``s; ``robot_name`` is the robot's name unless it is given here.
        xyz: The position of its root link at the start, in the world frame (m).
        rpy: The roll, pitch and yaw of its root link at the start (rad).
        namespace: The namespace of its topics; ``/`` and its name by default.
        frame_prefix: The prefix of its link names in tf messages. By default ``NAME/``, and nothing where its link
            names begin with its name already.
        controllers: Parameters files of its controllers; by default the ones that its ``<gazebo>`` plugin names.
        active_controllers: The controllers to activate; by default all in the parameters files, in their order.
        inactive_controllers: The controllers to load and leave inactive; those in no list are not loaded.
        unconfigured_controllers: The controllers to load and leave unconfigured.
        initial_positions: Joint name → position at the start (rad or m).
        self_collision: Whether its links collide with each other; by default those do that ``<selfCollide>`` names.
        collision: What a collision mesh becomes: its convex ``hull``, or a convex ``decomposition`` (needs CoACD).
        contact: ``hydroelastic``: its flat shapes touch with their faces; or ``point``: in a point.
        remappings: Topic → the topic in its place, both in full.
        stamped_topics: Topics of its Gazebo drives that are ``TwistStamped`` in ROS in place of ``Twist``, by their
            names in Gazebo.
        bridged: Topic in Gazebo → the topic in ROS that a bridge publishes it on; None where no bridge runs, so that
            each sensor is published below the robot's namespace.
        without_repairs: Names of repairs to leave out; ``drake_twin/docs/repairs.md`` lists them.
        added_controllers: Controller name → its ``type`` and its parameters, beside those of the parameters files.
        controller_parameters: Controller name → parameters that replace those of the parameters files. Parameters
            within a mapping are named with dots, for example ``gains.joint_1.p``.
        friction: The coefficient of friction of all its collision shapes; by default those of its file.
        joint_friction: Joint name → its dry friction (N·m or N) in place of the file's.
        command_delay: How much later what is published to its controllers reaches them (s), in whole physics steps.
        measurement_delay: How old the joint states are that its controllers read and publish (s), likewise.
        noise: A factor on the noise of all its sensors: 1 for that of its file, 0 for ideal values.
        publish_frequency: The highest rate at which its moving joints are published on ``/tf`` (Hz, 0 for that of its
            joint states), as robot_state_publisher's parameter of this name.
    """

    name: str
    model: str
    xacro_args: Mapping[str, str] = field(default_factory=dict)
    xyz: Vector3 = (0.0, 0.0, 0.0)
    rpy: Vector3 = (0.0, 0.0, 0.0)
    namespace: str | None = None
    frame_prefix: str | None = None
    controllers: tuple[str, ...] = ()
    active_controllers: tuple[str, ...] | None = None
    inactive_controllers: tuple[str, ...] = ()
    initial_positions: Mapping[str, float] = field(default_factory=dict)
    self_collision: bool | None = None
    collision: str = "hull"
    contact: str = HYDROELASTIC
    remappings: Mapping[str, str] = field(default_factory=dict)
    stamped_topics: tuple[str, ...] = ()
    without_repairs: tuple[str, ...] = ()
    added_controllers: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    unconfigured_controllers: tuple[str, ...] = ()
    bridged: Mapping[str, str] | None = None
    controller_parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    friction: float | None = None
    joint_friction: Mapping[str, float] = field(default_factory=dict)
    command_delay: float = 0.0
    measurement_delay: float = 0.0
    noise: float = 1.0
    publish_frequency: float = 20.0

    @property
    def topic_namespace(self) -> str:
        """The namespace with one leading slash and no trailing one; empty for the root namespace."""
        namespace = self.name if self.namespace is None else self.namespace
        return f"/{namespace.strip('/')}" if namespace.strip("/") else ""

    def remapped(self, topic: str) -> str:
        """Return the topic that replaces a topic."""
        return self.remappings.get(topic, topic)


@saved("StaticTransform")
@dataclass(frozen=True)
class StaticTransform:
    """A frame fixed in another: ``child`` in ``parent``, on ``/tf_static``."""

    parent: str
    child: str
    xyz: Vector3 = (0.0, 0.0, 0.0)
    rpy: Vector3 = (0.0, 0.0, 0.0)


@saved("Command")
@dataclass(frozen=True)
class Command:
    """A message published at a simulation time.

    Attributes:
        topic: The full topic name, for example ``/robot_1/forward_velocity_controller/commands``.
        data: The numbers of a ``Float64MultiArray``, or the fields of any message as ``ros2 topic pub`` takes them.
        time: The simulation time (s).
        period: The time between repetitions (s); None to publish it once.
        optional: Whether it is dropped, with a finding, where no controller accepts it.
    """

    topic: str
    data: tuple[float, ...] | Mapping[str, Any]
    time: float = 0.0
    period: float | None = None
    optional: bool = False


@saved("Scenario")
@dataclass(frozen=True)
class Scenario:
    """Everything a twin is built from.

    Attributes:
        robots: The robots, in a fixed order.
        time_step: The physics step (s). With the engine ``cenic`` commands and subscribers meet the simulation on this
            grid, and the engine chooses its own steps between.
        engine: ``discrete`` (fixed steps, repeatable to the last bit), or ``cenic`` (Drake's convex integrator, which
            controls its error).
        accuracy: The accuracy that ``cenic`` is asked for.
        contact_approximation: Drake's discrete contact solver: lagged, similar or sap.
        world: The world.
        package_paths: Folders of ROS packages to search first.
        static_transforms: Further frames.
        commands: Messages to publish, with their times.
        seed: What the noise of sensors is drawn from.
        sensor_noise: Whether sensors have the noise that their files give them.
        nodes: The rclpy programs that run beside the robots, in the order of their turns.
        findings: What a launch file asks for and the twin does not do, each with the reason.
        values: Parameters of the plant that differ from the files', by name: masses, dampings, the ground's friction;
            `drake_twin.twin.varied_parameters` lists them. Servo gains stay those of the files' values.
        pushes: Forces that push links, with their times.
        retune: Whether servo gains follow `values` instead, as if the files had them.
        clock_rate: The rate of ``/clock`` (Hz); 0 for each physics step, as Gazebo Sim publishes it.
        islands: How many robots and moving models of the world share a plant, if they may touch no others; 0 for one
            plant that has all. None for 8 beside more than eight robots in discrete steps, and else for one plant.
        threads: How many threads step islands; 0 for one on each core. The states are the same for any number.

    Raises:
        ScenarioError: If no twin can be built from a value, such as two robots of one name.
    """

    robots: tuple[Robot, ...]
    time_step: float = 0.001
    engine: str = "discrete"
    accuracy: float = 1e-3
    contact_approximation: str = "lagged"
    world: World = World()
    package_paths: tuple[str, ...] = ()
    static_transforms: tuple[StaticTransform, ...] = ()
    commands: tuple[Command, ...] = ()
    findings: tuple[Finding, ...] = ()
    seed: int = 0
    sensor_noise: bool = True
    nodes: tuple[NodeProgram, ...] = ()
    values: Mapping[str, float] = field(default_factory=dict)
    pushes: tuple[Push, ...] = ()
    retune: bool = False
    clock_rate: float = 0.0
    islands: int | None = None
    threads: int = 0

    def __post_init__(self) -> None:
        for path, message in _problems(self):
            raise ScenarioError(path, message)

    @property
    def most_in_an_island(self) -> int:
        """How many robots and moving models share a plant if they may touch no others; 0 for one plant of all."""
        if self.islands is not None:
            return self.islands
        return _IN_AN_ISLAND if len(self.robots) > _IN_AN_ISLAND and self.engine == DISCRETE else 0


class ScenarioError(InputError):
    """Raised for a value of a scenario that no twin can be built from.

    If the scenario comes from a YAML file, the error is raised again with the value's file and line: see
    `ScenarioFile.located`.

    Attributes:
        path: The keys and indices that lead to the value.
        reason: What is wrong.
        more: Further arguments of `InputError`.
    """

    def __init__(self, path: ValuePath, reason: str, **more: Any):
        self.path = path
        self.reason = reason
        self.more = more
        super().__init__(f"{'.'.join(map(str, path))}: {reason}", **more)


def _problems(scenario: Scenario) -> typing.Iterator[tuple[ValuePath, str]]:
    yield from misfits(scenario, unchecked=("data",))  # a command's data is checked by its controller
    if not (scenario.robots or scenario.nodes or scenario.world.file):
        yield ("robots",), "a twin needs at least one robot, a world, or a node program that spawns one"
    if not scenario.time_step > 0:
        yield ("time_step",), f"{scenario.time_step:g} s is not positive"
    elif not SHORTEST_STEP <= scenario.time_step <= LONGEST_STEP:
        bounds = f"{SHORTEST_STEP:g} s to {LONGEST_STEP:g} s"
        yield ("time_step",), f"{scenario.time_step:g} s is out of bounds: valid are {bounds}"
    yield from _far_away(scenario)
    for name, valid in (("engine", ENGINES), ("contact_approximation", CONTACT_APPROXIMATIONS)):
        if getattr(scenario, name) not in valid:
            yield (name,), _unknown(getattr(scenario, name), valid)
    if not 0 <= scenario.clock_rate <= 1 / SHORTEST_STEP:
        yield ("clock_rate",), f"{scenario.clock_rate:g} Hz is out of bounds: valid are 0 to {1 / SHORTEST_STEP:g} Hz"
    for name in ("islands", "threads"):
        if not 0 <= (getattr(scenario, name) or 0) <= 1000:
            yield (name,), f"{getattr(scenario, name)} is not a number from 0 to 1000"
    if scenario.islands and scenario.engine == CENIC:
        yield ("islands",), f"the engine {CENIC} has all robots in one plant: use {DISCRETE}, or no islands"
    if scenario.seed < 0:
        yield ("seed",), f"{scenario.seed} is below zero"
    if not 1e-9 <= scenario.accuracy <= 1.0:
        yield ("accuracy",), f"{scenario.accuracy:g} is out of bounds: valid are 1e-9 to 1"
    if scenario.world.ground_friction is not None and not scenario.world.ground_friction >= 0:
        yield ("world", "ground_friction"), f"{scenario.world.ground_friction:g} is below zero"
    if scenario.world.contact not in CONTACTS:
        yield ("world", "contact"), _unknown(scenario.world.contact, CONTACTS)
    names: set[str] = set()
    for index, robot in enumerate(scenario.robots):
        for name, valid in (("contact", CONTACTS), ("collision", COLLISION_KINDS)):
            if getattr(robot, name) not in valid:
                yield ("robots", index, name), _unknown(getattr(robot, name), valid)
        if (what := problem_of_name(robot.name)) is not None:
            yield ("robots", index, "name"), what
        if robot.namespace is not None and (what := problem_of_namespace(robot.namespace)) is not None:
            yield ("robots", index, "namespace"), what
        if robot.name in names:
            yield ("robots", index, "name"), f"two robots are named {robot.name!r}"
        names.add(robot.name)
        least_zero: list[tuple[tuple[str, ...], float | None]] = [(("friction",), robot.friction)]
        least_zero += [(("joint_friction", name), value) for name, value in robot.joint_friction.items()]
        for where, value in (*least_zero, (("noise",), robot.noise)):
            if value is not None and not value >= 0:
                yield ("robots", index, *where), f"{value:g} is below zero"
        for name, delay in (("command_delay", robot.command_delay), ("measurement_delay", robot.measurement_delay)):
            if not 0 <= delay <= LONGEST_DELAY:
                yield ("robots", index, name), f"{delay:g} s is not a delay from 0 to {LONGEST_DELAY:g} s"
        if not 0 <= robot.publish_frequency <= 1000:  # as in robot_state_publisher
            what = f"{robot.publish_frequency:g} Hz is not a rate from 0 to 1000 Hz"
            yield ("robots", index, "publish_frequency"), what
        if robot.measurement_delay and scenario.engine == CENIC:
            yield ("robots", index, "measurement_delay"), f"the engine {CENIC} measures without delay: use {DISCRETE}"
    children: set[str] = set()
    for index, transform in enumerate(scenario.static_transforms):
        if transform.child in children:
            yield ("static_transforms", index, "child"), f"frame {transform.child!r} would have two parents"
        if transform.child == transform.parent:
            yield ("static_transforms", index, "child"), f"frame {transform.child!r} would be its own parent"
        children.add(transform.child)
    yield from _circles(scenario.static_transforms)
    for index, command in enumerate(scenario.commands):
        if not 0 <= command.time <= LONGEST_TIME:
            what = "is before the start" if command.time < 0 else f"is later than {LONGEST_TIME:g} s"
            yield ("commands", index, "time"), f"{command.time:g} s {what}"
        if command.period is not None and not scenario.time_step <= command.period <= LONGEST_TIME:
            what = f"it must be {scenario.time_step:g} s (the time step) or more"
            yield ("commands", index, "period"), f"{command.period:g} s is not a period: {what}"
    for index, push in enumerate(scenario.pushes):
        yield from ((("pushes", index, *path), text) for path, text in problems_of_push(push, LONGEST_TIME))
    for index, node in enumerate(scenario.nodes):
        if not node.executable:
            yield ("nodes", index, "executable"), "a node needs a script, or a package and its program"
        if not 0 <= node.time <= LONGEST_TIME:
            yield ("nodes", index, "time"), f"{node.time:g} s is not a time from zero to {LONGEST_TIME:g} s"


def _far_away(scenario: Scenario) -> typing.Iterator[tuple[ValuePath, str]]:
    """Yield the first component of each vector that overflows in the simulation."""
    placed = (("robots", scenario.robots), ("static_transforms", scenario.static_transforms))
    vectors: dict[ValuePath, tuple[float, ...]] = {
        (name, index, part): getattr(item, part)
        for name, items in placed
        for index, item in enumerate(items)
        for part in ("xyz", "rpy")
    }
    vectors |= {("world", part): getattr(scenario.world, part) or () for part in ("gravity", "wind")}
    for path, vector in vectors.items():
        for index, value in enumerate(vector):
            if abs(value) > LARGEST:
                yield (*path, index), f"{value:g} is out of bounds: valid are {-LARGEST:g} to {LARGEST:g}"


def _unknown(value: str, valid: tuple[str, ...]) -> str:
    return f"unknown value {value!r}: valid are {', '.join(valid)}"


def _circles(transforms: tuple[StaticTransform, ...]) -> typing.Iterator[tuple[ValuePath, str]]:
    parents = {transform.child: transform.parent for transform in transforms}
    for index, transform in enumerate(transforms):
        frame, seen = transform.child, set()
        while frame in parents and frame not in seen:
            seen.add(frame)
            frame = parents[frame]
        if frame in seen:
            yield ("static_transforms", index, "parent"), f"the static transforms form a circle through {frame!r}"
            return
