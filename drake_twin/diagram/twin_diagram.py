"""The root diagram of a twin: plant, scene graph, one sub-diagram per robot, clock, tf and viewer."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from pydrake.geometry import Meshcat, MeshcatVisualizer, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Diagram, DiagramBuilder, InputPort, OutputPort, System

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import urdf_link_name
from drake_twin.description.package_index import PackageIndex
from drake_twin.diagram.applied_forces import apply_forces
from drake_twin.diagram.contact import TouchingShape
from drake_twin.diagram.detachable_joints import JointInPlant
from drake_twin.diagram.frames import add_frames, colliding_transforms, publish_frames
from drake_twin.diagram.plant import PlantOfTwin, RobotInPlant, add_plant
from drake_twin.diagram.release import release
from drake_twin.diagram.robot_diagram import RobotDiagram, build_robot_diagram
from drake_twin.diagram.robot_sensors import SensorSurroundings
from drake_twin.diagram.robot_topics import publish_robot
from drake_twin.diagram.sensors_of_twin import add_sensors
from drake_twin.diagram.topics import CLOCK, CommandTopic, PublishedTopic, Topics, ports_by_topic
from drake_twin.diagram.visualizer import add_visualizer
from drake_twin.diagram.world_in_plant import add_wind
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.plans import plan_robots, world_of
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import GROUND_TRUTH, robot_topic
from drake_twin.planning.triggers import OwnedTrigger, about_triggers, plan_noticing, plan_triggers
from drake_twin.planning.world_sensors import ModelPlan, plan_models
from drake_twin.progress import tell, told
from drake_twin.scenario import Scenario, World
from drake_twin.sensors.cameras.lazy_renderer import LazyRenderer
from drake_twin.systems.clock_publisher import ClockPublisher
from drake_twin.systems.entity_state_publisher import EntityStatePublisher
from drake_twin.systems.ground_truth_publisher import GroundTruthPublisher, RobotBase
from drake_twin.systems.plant_reading import PlantPorts

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldFile
    from drake_twin.planning.performers import Detection


@dataclass(frozen=True)
class TwinDiagram:
    """A scenario's diagram and what is needed to run it.

    Attributes:
        diagram: The root diagram. Each topic is one of its ports, named like the topic without the leading slash.
        plans: The robots.
        published: Port → its topic, type, rate and publisher. A topic's first port has the topic's name.
        commanded: Port → its topic, type and subscriber.
        actions: Action → its type, port and controller.
        parts: Robot → its controllers and servo.
        findings: The findings of the files: entries that were not used as they are.
        visualizer: Draws the scene on a Meshcat page on demand; None without a page.
        world_models: Moving model of the world → its model instances.
        sensing_models: The models of the world that have sensors.
        shapes: The contact of each collision shape.
        detachable_joints: The joints that come and go.
        triggers: What publishes messages when it hears one.
        detection: What notices performers and touches; None without any.
        extensions: The systems that the user's extensions have added.
        renderer: What draws the pictures of cameras; that of the diagram before, if there was one.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    ports: PlantPorts
    plans: tuple[RobotPlan, ...]
    robots: dict[str, RobotInPlant]
    published: dict[str, PublishedTopic]
    commanded: dict[str, CommandTopic]
    actions: dict[str, CommandTopic]
    parts: dict[str, RobotDiagram]
    visualizer: MeshcatVisualizer | None
    engine: str
    world: World
    world_file: "WorldFile | None"
    world_models: dict[str, tuple[ModelInstanceIndex, ...]]
    sensing_models: tuple[ModelPlan, ...]
    shapes: tuple[TouchingShape, ...]
    detachable_joints: tuple[JointInPlant, ...]
    triggers: tuple[OwnedTrigger, ...]
    detection: "Detection | None"
    extensions: tuple[System, ...]
    findings: tuple[Finding, ...]
    renderer: LazyRenderer

    @cached_property
    def listeners(self) -> dict[str, tuple[str, ...]]:
        """Topic → its ports in `commanded`."""
        return ports_by_topic(self.commanded)

    @cached_property
    def publishers(self) -> dict[str, tuple[str, ...]]:
        """Topic → its ports in `published`."""
        return ports_by_topic(self.published)

    def owners(self) -> dict[ModelInstanceIndex, str]:
        """Return the robot or the model of the world that each model instance belongs to."""
        owners = {parts.instance: name for name, parts in self.robots.items()}
        for name, instances in self.world_models.items():
            owners |= dict.fromkeys(instances, name)
        return owners


# Adds a user's own systems to the diagram before it is built; see `build_twin_diagram`.
Extension = Callable[[DiagramBuilder, "DiagramParts"], None]


@dataclass(frozen=True)
class DiagramParts:
    """The parts of a diagram to which a user's systems can be connected while it is built.

    Attributes:
        plant: The finalized plant.
        scene_graph: The scene graph with its shapes.
        robots: Robot → its sub-diagram as a system of the builder.
        plans: The robots.
        ports: The ports that follow from the plant's step to come.
    """

    plant: MultibodyPlant
    scene_graph: SceneGraph
    robots: Mapping[str, Diagram]
    plans: tuple[RobotPlan, ...]
    ports: PlantPorts

    def output(self, robot: str, name: str) -> OutputPort:
        """Return an output port of a robot: ``state``, ``state_estimated``, ``net_actuation`` or a controller's.

        Raises:
            InputError: If the robot or the port is unknown.
        """
        system = self._robot(robot)
        own = {"state": self.plant.get_state_output_port, "net_actuation": self.ports.net_actuation}
        if name in own:
            return own[name](self.plant.GetModelInstanceByName(robot))
        if not system.HasOutputPort(name):
            ports = map(system.get_output_port, range(system.num_output_ports()))
            valid = [*own, *(port.get_name() for port in ports)]
            raise InputError(f"robot {robot!r} has no output port {name!r}", value=name, valid=valid)
        return system.GetOutputPort(name)

    def input(self, robot: str, name: str) -> InputPort:
        """Return an input port of a robot's sub-diagram, for example ``<controller>/command``.

        Raises:
            InputError: If the robot or the port is unknown.
        """
        system = self._robot(robot)
        if not system.HasInputPort(name):
            valid = [port.get_name() for port in map(system.get_input_port, range(system.num_input_ports()))]
            raise InputError(f"robot {robot!r} has no input port {name!r}", value=name, valid=valid)
        return system.GetInputPort(name)

    def _robot(self, robot: str) -> Diagram:
        if robot not in self.robots:
            raise InputError(f"unknown robot {robot!r}", value=robot, valid=self.robots)
        return self.robots[robot]


def build_twin_diagram(
    scenario: Scenario,
    meshcat: Meshcat | None = None,
    known: TwinDiagram | None = None,
    plans: Iterable[RobotPlan] = (),
    extensions: Sequence[Extension] = (),
) -> TwinDiagram:
    """Build a scenario's diagram.

    Beside the topics, the root diagram has for each robot the vector ports

    - ``<robot>/state`` (output): ``[q; v]`` of its model instance, the plant's own port;
    - ``<robot>/state_estimated`` (output): positions, then velocities, of its movable joints in file order;
    - ``<robot>/net_actuation`` (output): the effort of each actuator (N·m or N), if it has actuators.

    Only ``net_actuation`` has a direct feedthrough, so a controller that reads ``state_estimated`` and writes a
    `drake_twin.controllers.vector_command_controller` closes no algebraic loop.

    Args:
        scenario: The scenario to build.
        meshcat: The page to draw on.
        known: A diagram that was built before: robots and worlds that both have are not read again.
        plans: Plans of robots, if made before.
        extensions: Called with the builder and `DiagramParts` before the diagram is built, in their order.

    Raises:
        InputError: If a file, a robot or a frame cannot be used.
    """
    packages = PackageIndex(scenario.package_paths)
    plans = plan_robots(scenario, packages, (*plans, *(() if known is None else known.plans)))
    known_gains = {}
    if known is not None and known.world == scenario.world and known.engine == scenario.engine:
        known_gains = {plan.name: known.robots[plan.name].gains for plan in plans if plan in known.plans}
    if known is not None and known.world == scenario.world:
        world_file = known.world_file
    else:
        world_file = world_of(scenario.world, packages)
    builder = DiagramBuilder()
    try:
        parts = add_plant(builder, scenario, plans, world_file, known_gains, holds_state=scenario.most_in_an_island > 0)
        renderer = LazyRenderer() if known is None else known.renderer
        return _build(builder, scenario, meshcat, parts, plans, world_file, extensions, renderer)
    except BaseException:
        release([builder, *builder.GetSystems()])
        raise


def _build(
    builder: DiagramBuilder,
    scenario: Scenario,
    meshcat: Meshcat | None,
    parts: PlantOfTwin,
    plans: tuple[RobotPlan, ...],
    world_file: "WorldFile | None",
    extensions: Sequence[Extension],
    renderer: LazyRenderer,
) -> TwinDiagram:
    """Add everything except the plant, and build the diagram."""
    topics = Topics(builder)
    surroundings = SensorSurroundings(
        parts.ports,
        parts.scene_graph,
        scenario.time_step,
        scenario.seed,
        scenario.sensor_noise,
        world_file,
        renderer,
        add_wind(builder, scenario, world_file, topics),
    )
    robots = {
        plan.name: _add_robot(builder, parts, plan, topics, surroundings)
        for plan in told("connecting", plans, lambda plan: plan.name)
    }
    models = () if world_file is None else plan_models(world_file.models, scenario.world.bridged)
    models = tuple(model for model in models if parts.has_model(model.name))
    about_sensors = add_sensors(builder, parts, plans, models, robots, topics, surroundings)
    frames = add_frames(builder, scenario, parts, plans, robots, topics)
    clock = builder.AddNamedSystem("clock", ClockPublisher())
    clock_port, clock_rate = clock.get_clock_output_port(), scenario.clock_rate or 1.0 / scenario.time_step
    drafters = {"drafter": clock.drafter(), "draft_at": clock.draft_at()}
    topics.publish(PublishedTopic(CLOCK, "rosgraph_msgs/msg/Clock", clock_port, clock_rate, **drafters))
    publish_frames(frames, plans, robots, topics, scenario.time_step)
    _add_ground_truth(builder, parts, plans, topics)
    _add_entity_states(builder, parts, plans, topics)
    visualizer = add_visualizer(builder, parts.scene_graph, meshcat)
    own = {system.get_name() for system in builder.GetSystems()}
    systems = {name: robot.diagram for name, robot in robots.items()}
    for extend in extensions:
        extend(builder, DiagramParts(parts.plant, parts.scene_graph, systems, plans, parts.ports))
    parts.ports.refuse_own(builder)
    _export_vectors(builder, parts, robots, topics)
    added = tuple(system for system in builder.GetMutableSystems() if system.get_name() not in own)
    _name_unnamed(added)
    about_forces = tuple(apply_forces(builder, parts, plans, robots, world_file, surroundings.wind))
    surfaces = [(parts.robots[name].instance, *item) for name, robot in robots.items() for item in robot.surfaces()]
    if surfaces:
        from drake_twin.diagram.surfaces import move_surfaces

        about_forces += tuple(move_surfaces(builder, parts.plant, surfaces))
    about_robots: list[Finding] = []
    for plan in plans:
        about_robots += plan.findings
        about_robots += (Finding(Kind.WARNING, text, robot=plan.name) for text in robots[plan.name].warnings)
    triggers = plan_triggers(plans, models, world_file, scenario.world.bridged or {})
    detection = plan_noticing(plans, models, world_file, scenario.world.bridged or {})
    types = [{item.topic: item.type for item in known.values()} for known in (topics.published, topics.subscribed)]
    tell("building the diagram")
    diagram = builder.Build()
    diagram.set_name("twin")
    return TwinDiagram(
        diagram=diagram,
        plant=parts.plant,
        scene_graph=parts.scene_graph,
        ports=parts.ports,
        plans=plans,
        robots=parts.robots,
        published=topics.published_of(diagram),
        commanded=topics.listened_of(diagram),
        actions=topics.listened_of(diagram, actions=True),
        parts=robots,
        visualizer=visualizer,
        engine=scenario.engine,
        world=scenario.world,
        world_file=world_file,
        world_models=parts.world_models,
        sensing_models=models,
        shapes=parts.shapes,
        detachable_joints=parts.detachable_joints,
        triggers=triggers,
        detection=detection,
        extensions=added,
        renderer=renderer,
        findings=(
            *scenario.findings,
            *about_robots,
            *about_sensors,
            *colliding_transforms(robots),
            *(() if world_file is None else world_file.findings),
            *parts.findings,
            *about_forces,
            *about_triggers(triggers, *types),
            *(() if detection is None else detection.findings),
        ),
    )


def _export_vectors(
    builder: DiagramBuilder, parts: PlantOfTwin, robots: Mapping[str, RobotDiagram], topics: Topics
) -> None:
    """Export the robots' vector ports, but for those whose name a topic has."""
    taken = {name[1:] for known in (topics.published, topics.subscribed, topics.actions) for name in known}
    for name, robot in robots.items():
        instance = parts.robots[name].instance
        outputs = {"state": parts.plant.get_state_output_port(instance)}
        outputs["state_estimated"] = robot.diagram.GetOutputPort("state_estimated")
        if parts.robots[name].layout.num_actuators:
            outputs["net_actuation"] = parts.ports.net_actuation(instance)
        for own, output in outputs.items():
            if f"{name}/{own}" not in taken:
                builder.ExportOutput(output, f"{name}/{own}")
        for controller, system in robot.controllers.items():
            for own in system.vector_inputs:
                port = robot.diagram.GetInputPort(f"{controller}/{own}")
                if not builder.IsConnectedOrExported(port):
                    builder.ExportInput(port, f"{name}/{controller}/{own}")
            for own in system.vector_outputs:
                builder.ExportOutput(robot.diagram.GetOutputPort(f"{controller}/{own}"), f"{name}/{controller}/{own}")


def _add_robot(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plan: RobotPlan,
    topics: Topics,
    surroundings: SensorSurroundings,
) -> RobotDiagram:
    in_plant = parts.robots[plan.name]
    robot = build_robot_diagram(plan, surroundings, in_plant)
    system = builder.AddNamedSystem(plan.name, robot.diagram)
    if in_plant.layout.num_actuators:
        parts.ports.connect_motors(builder, system, in_plant.instance)
    for name, output in robot.plant_inputs.items():
        builder.Connect(output, system.GetInputPort(name))
    publish_robot(plan, robot, system, topics, in_plant, surroundings.time_step)
    return robot


def _add_ground_truth(builder: DiagramBuilder, parts: PlantOfTwin, plans: Sequence[RobotPlan], topics: Topics) -> None:
    bases = [
        RobotBase(
            plan.name,
            plan.base_frame,
            parts.robots[plan.name].layout_in_plant,
            plan.spawn_pose if plan.model.is_fixed else None,
        )
        for plan in plans
    ]
    publisher = builder.AddNamedSystem("ground_truth", GroundTruthPublisher(bases, parts.plant.num_multibody_states()))
    builder.Connect(parts.plant.get_state_output_port(), publisher.get_state_input_port())
    for plan, base in zip(plans, bases, strict=True):
        topic, drafter = robot_topic(plan, GROUND_TRUTH), publisher.drafter(base)
        if topic in topics.published:  # another robot of its namespace has it
            topic = f"{plan.robot.topic_namespace}/{plan.name}/{GROUND_TRUTH}"
        port, rate = publisher.get_odom_output_port(plan.name), plan.manager.update_rate
        topics.publish(PublishedTopic(topic, "nav_msgs/msg/Odometry", port, rate, plan.name, drafter=drafter))


def _add_entity_states(builder: DiagramBuilder, parts: PlantOfTwin, plans: Sequence[RobotPlan], topics: Topics) -> None:
    plant = parts.plant
    models: dict[str, int] = {}
    links: dict[str, int] = {}
    instances = {plan.name: (parts.robots[plan.name].instance,) for plan in plans} | parts.world_models
    roots = {plan.name: plan.model.root_body for plan in plans}
    for name, of_model in instances.items():
        bodies = [plant.get_body(index) for instance in of_model for index in plant.GetBodyIndices(instance)]
        models[name] = next(int(body.index()) for body in bodies if body.name() == roots.get(name, body.name()))
        links |= {f"{name}::{urdf_link_name(body.name())}": int(body.index()) for body in bodies}
    publisher = builder.AddNamedSystem("entity_states", EntityStatePublisher(models, links))
    builder.Connect(plant.get_body_poses_output_port(), publisher.get_body_poses_input_port())
    builder.Connect(plant.get_body_spatial_velocities_output_port(), publisher.get_body_spatial_velocities_input_port())
    models_port, links_port = publisher.get_model_states_output_port(), publisher.get_link_states_output_port()
    topics.publish(PublishedTopic("/model_states", "gazebo_msgs/msg/ModelStates", models_port, 10.0))
    topics.publish(PublishedTopic("/link_states", "gazebo_msgs/msg/LinkStates", links_port, 10.0))


def _name_unnamed(systems: Iterable[System]) -> None:
    """Name the systems that have no name of their own by class and order: Drake's names hold addresses in memory."""
    for number, system in enumerate(systems):
        kind, _, address = system.get_name().rpartition("@")
        if kind and re.fullmatch("[0-9a-f]{16}", address):
            system.set_name(f"{kind.rpartition('/')[2]}_{number}")
