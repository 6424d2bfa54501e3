"""The root diagram of a twin: plant, scene graph, one sub-diagram per robot, clock, tf and viewer."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf

from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort

from drake_twin.controllers.types import JOINT_STATE_BROADCASTER
from drake_twin.description.drake_urdf import drake_link_name, urdf_link_name
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import POSED_JOINT_TYPES, Pose
from drake_twin.description.world_file import WorldFile, read_world
from drake_twin.diagram.contact import TouchingShape
from drake_twin.diagram.let_go import let_go
from drake_twin.diagram.plant import PlantOfTwin, RobotInPlant, add_plant
from drake_twin.diagram.robot_diagram import PUBLISHED, RobotDiagram, build_robot_diagram
from drake_twin.diagram.servo_gains import ServoGains
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.robot_plan import RobotPlan, plan_robot
from drake_twin.progress import tell, told
from drake_twin.scenario import Scenario, World
from drake_twin.systems.clock_publisher import ClockPublisher
from drake_twin.systems.entity_state_publisher import EntityStatePublisher
from drake_twin.systems.ground_truth_publisher import GroundTruthPublisher, RobotBase
from drake_twin.systems.robot_state_publisher import FixedFrame, LinkFrame, RobotFrames, RobotStatePublisher

ROBOT_DESCRIPTION, GROUND_TRUTH = "robot_description", "ground_truth/odom"
ROBOT_TOPICS = (*PUBLISHED, ROBOT_DESCRIPTION, GROUND_TRUTH)  # that every robot has, below its namespace
TF_ODOMETRY = "tf_odometry"  # the port of a drive's transform, which is no topic of its own


@dataclass(frozen=True)
class PublishedTopic:
    """A topic that the twin publishes.

    Attributes:
        type: the ROS message type.
        port: evaluates to the message.
        rate: how often ROS would publish it (Hz); None when it never changes, so that once is enough.
        robot: whose topic it is; empty for the twin's own.
        controller: the controller that publishes it, while it is active; empty where it is always there.
    """

    type: str
    port: OutputPort
    rate: float | None
    robot: str = ""
    controller: str = ""


@dataclass(frozen=True)
class CommandTopic:
    """A topic or an action that a controller listens to.

    Attributes:
        type: the ROS message or action type.
        port: takes what the controller's ``read`` makes of a message.
        robot: the robot.
        controller: the controller's name.
        name: the topic below the controller's name.
    """

    type: str
    port: InputPort
    robot: str
    controller: str
    name: str


@dataclass(frozen=True)
class TwinDiagram:
    """A scenario's diagram and what is needed to run it.

    Attributes:
        diagram: the root diagram. Each topic is one of its ports, named like the topic without the leading slash.
        plans: the robots.
        published: topic → what the twin publishes on it.
        commanded: topic → what listens to it.
        actions: action → what does it.
        parts: robot → its controllers and servo.
        findings: what became of what the files say, where it is not simply used.
        visualizer: draws the scene on a Meshcat page when it is asked to; None without a page.
        world_models: what moves in the world and is no robot, by name: its model instances.
        shapes: how each collision shape touches.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    plans: tuple[RobotPlan, ...]
    robots: dict[str, RobotInPlant]
    published: dict[str, PublishedTopic]
    commanded: dict[str, CommandTopic]
    actions: dict[str, CommandTopic]
    parts: dict[str, RobotDiagram]
    visualizer: MeshcatVisualizer | None
    engine: str
    world: World
    world_file: WorldFile | None
    world_models: dict[str, tuple[ModelInstanceIndex, ...]]
    shapes: tuple[TouchingShape, ...]
    findings: tuple[Finding, ...]

    def owners(self) -> dict[ModelInstanceIndex, str]:
        """Model instance → the robot, or the model of the world, that it is part of."""
        owners = {parts.instance: name for name, parts in self.robots.items()}
        for name, instances in self.world_models.items():
            owners |= dict.fromkeys(instances, name)
        return owners

    def fix_commands(self, context: Context) -> None:
        """Puts "no message yet" on every command port of a new root context."""
        for topic in (*self.commanded.values(), *self.actions.values()):
            topic.port.FixValue(context, AbstractValue.Make(None))


def build_twin_diagram(
    scenario: Scenario, meshcat: Meshcat | None = None, known: TwinDiagram | None = None
) -> TwinDiagram:
    """Builds a scenario's diagram.

    Args:
        scenario: what to build.
        meshcat: the page to draw on.
        known: a diagram that was built before: robots and worlds that it has, too, are not read again.

    Raises:
        InputError: a file, a robot or a frame that cannot be used.
    """
    packages = PackageIndex(scenario.package_paths)
    known_plans = {} if known is None else {plan.name: plan for plan in known.plans}
    plans = tuple(
        known_plans[robot.name]
        if robot.name in known_plans and known_plans[robot.name].robot == robot
        else plan_robot(robot, packages, ("robots", index))
        for index, robot in enumerate(told("reading", scenario.robots, lambda robot: robot.name))
    )
    known_gains = {}
    if known is not None and known.world == scenario.world and known.engine == scenario.engine:
        known_gains = {plan.name: known.robots[plan.name].gains for plan in plans if plan in known.plans}
    builder = DiagramBuilder()
    try:
        return _build(builder, scenario, meshcat, known, plans, known_gains, packages)
    except BaseException:
        let_go([builder, *builder.GetSystems()])
        raise


def _build(
    builder: DiagramBuilder,
    scenario: Scenario,
    meshcat: Meshcat | None,
    known: TwinDiagram | None,
    plans: tuple[RobotPlan, ...],
    known_gains: Mapping[str, tuple[ServoGains | None, ...]],
    packages: PackageIndex,
) -> TwinDiagram:
    """The diagram of planned robots."""
    if known is not None and known.world == scenario.world:
        world_file = known.world_file
    else:
        world_file = None if scenario.world.file is None else read_world(scenario.world.file, packages)
    parts = add_plant(builder, scenario, plans, world_file, known_gains)
    topics = _Topics(builder)
    robots = {
        plan.name: _add_robot(builder, parts, plan, topics, scenario.time_step)
        for plan in told("connecting", plans, lambda plan: plan.name)
    }
    frames = _add_frames(builder, scenario, parts, plans, robots, topics)
    clock = builder.AddNamedSystem("clock", ClockPublisher())
    topics.publish("/clock", clock.get_clock_output_port(), "rosgraph_msgs/msg/Clock", 100.0)
    tf_type = "tf2_msgs/msg/TFMessage"
    topics.publish("/tf", frames.get_tf_output_port(), tf_type, 20.0)
    topics.publish("/tf_static", frames.get_tf_static_output_port(), tf_type, None)
    _add_ground_truth(builder, parts, plans, topics)
    _add_entity_states(builder, parts, plans, topics)
    visualizer = None
    if meshcat is not None:
        # The page is drawn when the run loop asks for it, in wall time: an event of its own would split CENIC's steps.
        parameters = MeshcatVisualizerParams(role=Role.kIllustration, publish_period=inf)
        visualizer = MeshcatVisualizer.AddToBuilder(builder, parts.scene_graph, meshcat, parameters)
        visualizer.set_name("meshcat_visualizer")
    tell("building the diagram")
    diagram = builder.Build()
    diagram.set_name("twin")
    return TwinDiagram(
        diagram=diagram,
        plant=parts.plant,
        scene_graph=parts.scene_graph,
        plans=plans,
        robots=parts.robots,
        published={
            topic: PublishedTopic(kind, diagram.GetOutputPort(topic[1:]), rate, *owner)
            for topic, (kind, rate, owner) in topics.published.items()
        },
        commanded={
            topic: CommandTopic(kind, diagram.GetInputPort(topic[1:]), *owner)
            for topic, (kind, owner) in topics.subscribed.items()
        },
        actions={
            topic: CommandTopic(kind, diagram.GetInputPort(topic[1:]), *owner)
            for topic, (kind, owner) in topics.actions.items()
        },
        parts=robots,
        visualizer=visualizer,
        engine=scenario.engine,
        world=scenario.world,
        world_file=world_file,
        world_models=parts.world_models,
        shapes=parts.shapes,
        findings=(
            *scenario.findings,
            *(finding for plan in plans for finding in _about_robot(plan, robots[plan.name])),
            *(() if world_file is None else world_file.findings),
            *parts.findings,
        ),
    )


def _about_robot(plan: RobotPlan, parts: RobotDiagram) -> Iterator[Finding]:
    yield from plan.findings
    yield from (Finding(Kind.WARNING, text, robot=plan.name) for text in parts.warnings)


class _Topics:
    """Collects the topics while the diagram is built, and exports each one's port under its name."""

    def __init__(self, builder: DiagramBuilder):
        self._builder = builder
        self.published: dict[str, tuple[str, float | None, tuple[str, str]]] = {}
        self.subscribed: dict[str, tuple[str, tuple[str, str, str]]] = {}
        self.actions: dict[str, tuple[str, tuple[str, str, str]]] = {}

    def publish(
        self, topic: str, port: OutputPort, kind: str, rate: float | None, robot: str = "", controller: str = ""
    ) -> None:
        if topic in self.published:
            raise InputError(f"two robots would publish on {topic}: give each a namespace of its own")
        self._builder.ExportOutput(port, topic[1:])
        self.published[topic] = (kind, rate, (robot, controller))

    def listen(self, topic: str, port: InputPort, kind: str, *owner: str, action: bool = False) -> None:
        robot, controller, name = owner
        known = self.actions if action else self.subscribed
        if topic in known:
            raise InputError(f"robots {known[topic][1][0]!r} and {robot!r} would both listen to {topic}")
        self._builder.ExportInput(port, topic[1:])
        known[topic] = (kind, (robot, controller, name))


def _add_robot(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plan: RobotPlan,
    topics: _Topics,
    time_step: float,
) -> RobotDiagram:
    plant, in_plant = parts.plant, parts.robots[plan.name]
    instance, layout = in_plant.instance, in_plant.layout
    robot = build_robot_diagram(plan, plant, in_plant, time_step)
    system = builder.AddNamedSystem(plan.name, robot.diagram)
    builder.Connect(plant.get_state_output_port(instance), system.GetInputPort("state"))
    builder.Connect(plant.get_net_actuation_output_port(instance), system.GetInputPort("net_actuation"))
    if layout.num_actuators:
        builder.Connect(system.GetOutputPort("desired_state"), plant.get_desired_state_input_port(instance))
        if system.HasOutputPort("actuation"):
            builder.Connect(system.GetOutputPort("actuation"), plant.get_actuation_input_port(instance))
    for name, output in robot.plant_inputs.items():
        builder.Connect(output, system.GetInputPort(name))
    namespace = plan.robot.topic_namespace
    plans = {item.name: item for item in plan.controllers}
    broadcaster = next((item for item in plan.controllers if item.type == JOINT_STATE_BROADCASTER), None)
    for name, kind in PUBLISHED.items():
        if broadcaster is None:
            topic = plan.robot.remapped(f"{namespace}/{name}")
            topics.publish(topic, system.GetOutputPort(name), kind, plan.update_rate, plan.name)
        elif (broadcast := _broadcast_topic(plan, broadcaster, name)) is not None:
            rate = broadcaster.update_rate
            topics.publish(broadcast, system.GetOutputPort(name), kind, rate, plan.name, broadcaster.name)
    for name, item in robot.controllers.items():
        for own, kind in item.subscribed.items():
            if (listened := _controller_topic(plan, plans[name], own)) is not None:
                port = system.GetInputPort(f"{name}/{own}")
                topics.listen(listened, port, plans[name].types.get(own, kind), plan.name, name, own)
        for own, kind in item.actions.items():
            port = system.GetInputPort(f"{name}/{own}")
            topics.listen(f"{namespace}/{name}/{own}", port, kind, plan.name, name, own, action=True)
        for own, kind in item.published.items():
            published = _controller_topic(plan, plans[name], own)
            if published is not None and own != TF_ODOMETRY:  # which goes to /tf
                output = system.GetOutputPort(f"{name}/{own}")
                topics.publish(published, output, kind, plans[name].update_rate, plan.name, name)
    return robot


def _add_ground_truth(builder: DiagramBuilder, parts: PlantOfTwin, plans: Sequence[RobotPlan], topics: _Topics) -> None:
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
    for plan in plans:
        topic = plan.robot.remapped(f"{plan.robot.topic_namespace}/{GROUND_TRUTH}")
        port = publisher.get_odom_output_port(plan.name)
        topics.publish(topic, port, "nav_msgs/msg/Odometry", plan.update_rate, plan.name)


def _add_entity_states(
    builder: DiagramBuilder, parts: PlantOfTwin, plans: Sequence[RobotPlan], topics: _Topics
) -> None:
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
    topics.publish("/model_states", publisher.get_model_states_output_port(), "gazebo_msgs/msg/ModelStates", 10.0)
    topics.publish("/link_states", publisher.get_link_states_output_port(), "gazebo_msgs/msg/LinkStates", 10.0)


def _controller_topic(robot: RobotPlan, plan: ControllerPlan, own: str) -> str | None:
    """The full name of a controller's topic; None where its plugin does not have it."""
    namespace = robot.robot.topic_namespace
    if plan.topics is None:
        return robot.robot.remapped(f"{namespace}/{plan.name}/{own}")
    topic = plan.topics.get(own)
    if topic is None:
        return None
    in_gazebo = plan.gz_topics.get(own, "").format(model=robot.name)
    in_gazebo = in_gazebo if in_gazebo.startswith("/") else f"/{in_gazebo}"
    if in_gazebo in robot.robot.remappings:  # by a parameter_bridge
        return robot.robot.remapped(in_gazebo)
    return robot.robot.remapped(topic if topic.startswith("/") else f"{namespace}/{topic}")


def _broadcast_topic(robot: RobotPlan, plan: ControllerPlan, name: str) -> str | None:
    """The full name of one of the joint_state_broadcaster's topics; None for one that it does not publish."""
    if plan.topics is not None:
        return _controller_topic(robot, plan, name)
    namespace = robot.robot.topic_namespace
    local = plan.parameters is not None and plan.parameters.use_local_topics
    return robot.robot.remapped(f"{namespace}/{plan.name}/{name}" if local else f"{namespace}/{name}")


def _add_frames(
    builder: DiagramBuilder,
    scenario: Scenario,
    parts: PlantOfTwin,
    plans: Sequence[RobotPlan],
    robots: Mapping[str, RobotDiagram],
    topics: _Topics,
) -> RobotStatePublisher:
    """A frame has one parent: a true base pose goes to tf only where nobody else places that frame."""
    static_transforms = [
        FixedFrame(item.parent, item.child, Pose(item.xyz, item.rpy)) for item in scenario.static_transforms
    ]
    placed = {frame.child for frame in static_transforms} | {"world"}
    link_frames: dict[str, str] = {}
    for plan in plans:
        for link in plan.description.links:
            frame = plan.frame_prefix + link
            if frame in link_frames and frame != "world":
                raise InputError(
                    f"robots {link_frames[frame]!r} and {plan.name!r} would both publish the frame {frame!r}:"
                    " give them different frame prefixes"
                )
            link_frames[frame] = plan.name
            if frame in placed and link != plan.description.root_link:
                raise InputError(f"frame {frame!r} of robot {plan.name!r} would have two parents", value=frame)
    own = [plan for plan in plans if plan.base_frame not in placed]
    fixed_bases = [FixedFrame("world", plan.base_frame, plan.spawn_pose) for plan in own if plan.model.is_fixed]
    _refuse_circles(plans, static_transforms)
    odometry = {
        (robot, name): controller.odometry_frames
        for robot, parts in robots.items()
        for name, controller in parts.controllers.items()
        if controller.odometry_frames is not None
    }
    placed_by_odometry = {child for _, child in odometry.values()}
    bases = {
        plan.name: plan.base_frame
        for plan in own
        if not plan.model.is_fixed and plan.base_frame not in placed_by_odometry
    }
    links = [frame for plan in plans for frame in _posed_links(parts, plan)]
    publisher = RobotStatePublisher(
        [
            RobotFrames(
                plan.name,
                plan.description,
                parts.robots[plan.name].layout_in_plant,
                plan.frame_prefix,
                bases.get(plan.name, ""),
            )
            for plan in plans
        ],
        parts.plant.num_multibody_states(),
        static_transforms=[*static_transforms, *fixed_bases],
        odometry=[f"{robot}/{name}/{TF_ODOMETRY}" for robot, name in odometry],
        links=links,
    )
    builder.AddNamedSystem("tf", publisher)
    builder.Connect(parts.plant.get_state_output_port(), publisher.get_state_input_port())
    if links:
        builder.Connect(parts.plant.get_body_poses_output_port(), publisher.GetInputPort("body_poses"))
    for robot, name in odometry:
        port = robots[robot].diagram.GetOutputPort(f"{name}/{TF_ODOMETRY}")
        builder.Connect(port, publisher.GetInputPort(f"{robot}/{name}/{TF_ODOMETRY}"))
    for plan in plans:
        topic = plan.robot.remapped(f"{plan.robot.topic_namespace}/{ROBOT_DESCRIPTION}")
        port = publisher.GetOutputPort(f"{plan.name}/robot_description")
        topics.publish(topic, port, "std_msgs/msg/String", None, plan.name)
    return publisher


def _posed_links(parts: PlantOfTwin, plan: RobotPlan) -> Iterator[LinkFrame]:
    """The links at joints whose positions do not say where they are."""
    for joint in plan.description.joints:
        if joint.type in POSED_JOINT_TYPES:
            parent, child = (
                int(parts.plant.GetBodyByName(drake_link_name(link), parts.robots[plan.name].instance).index())
                for link in (joint.parent, joint.child)
            )
            yield LinkFrame(plan.frame_prefix + joint.parent, plan.frame_prefix + joint.child, parent, child)


def _refuse_circles(plans: Sequence[RobotPlan], static_transforms: Sequence[FixedFrame]) -> None:
    """A static transform may place a robot's base in another frame, but not in one that hangs on that base."""
    parents = {frame.child: frame.parent for frame in static_transforms}
    for plan in plans:
        parents.update({plan.frame_prefix + j.child: plan.frame_prefix + j.parent for j in plan.description.joints})
    for frame in [plan.base_frame for plan in plans]:
        seen = []
        while frame in parents and frame not in seen:
            seen.append(frame)
            frame = parents[frame]
        if frame in seen:
            raise InputError(f"the static transforms put frame {frame!r} in a circle: {' in '.join([*seen, frame])}")
