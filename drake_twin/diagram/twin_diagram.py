"""The root diagram of a twin: plant, scene graph, one sub-diagram per robot, clock, tf and viewer."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Pose
from drake_twin.description.world_file import read_world
from drake_twin.diagram.plant import PlantOfTwin, RobotInPlant, add_plant
from drake_twin.diagram.robot_diagram import COMMANDS_TYPE, PUBLISHED, build_robot_diagram
from drake_twin.diagram.robot_plan import RobotPlan, plan_robot
from drake_twin.errors import InputError
from drake_twin.scenario import Scenario
from drake_twin.systems.clock_publisher import ClockPublisher
from drake_twin.systems.transform_broadcaster import FixedFrame, TransformBroadcaster
from drake_twin.systems.velocity_controller import VelocityController


@dataclass(frozen=True)
class PublishedTopic:
    """A topic that the twin publishes.

    Attributes:
        type: the ROS message type.
        port: evaluates to the message.
        rate: how often ROS would publish it (Hz); None when it never changes, so that once is enough.
    """

    type: str
    port: OutputPort
    rate: float | None


@dataclass(frozen=True)
class CommandTopic:
    """A topic that the twin listens to: a controller's commands."""

    type: str
    port: InputPort
    controller: VelocityController
    robot: str


@dataclass(frozen=True)
class TwinDiagram:
    """A scenario's diagram and what is needed to run it.

    Attributes:
        diagram: the root diagram. Each topic is one of its ports, named like the topic without the leading slash.
        plans: the robots.
        published: topic → what the twin publishes on it.
        commanded: topic → what listens to it.
        warnings: what was given up or changed while building.
        not_started: what the files ask for and the twin does not start, each with the reason.
        visualizer: draws the scene on a Meshcat page when it is asked to; None without a page.
        world_models: what moves in the world and is no robot, by name: its model instances.
    """

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    plans: tuple[RobotPlan, ...]
    robots: dict[str, RobotInPlant]
    published: dict[str, PublishedTopic]
    commanded: dict[str, CommandTopic]
    visualizer: MeshcatVisualizer | None
    world_models: dict[str, tuple[ModelInstanceIndex, ...]]
    warnings: tuple[str, ...]
    not_started: tuple[str, ...]

    def fix_commands(self, context: Context) -> None:
        """Puts "no message yet" on every command port of a new root context."""
        for topic in self.commanded.values():
            topic.port.FixValue(context, AbstractValue.Make(None))


def build_twin_diagram(scenario: Scenario, meshcat: Meshcat | None = None) -> TwinDiagram:
    """Builds a scenario's diagram.

    Args:
        scenario: what to build.
        meshcat: the page to draw on.

    Raises:
        InputError: a file, a robot or a frame that cannot be used.
    """
    packages = PackageIndex(scenario.package_paths)
    plans = tuple(plan_robot(robot, packages, ("robots", index)) for index, robot in enumerate(scenario.robots))
    builder = DiagramBuilder()
    world_file = None if scenario.world.file is None else read_world(scenario.world.file, packages)
    parts = add_plant(builder, scenario, plans, world_file)
    published: dict[str, tuple[str, float | None]] = {}
    controllers: dict[str, tuple[RobotPlan, VelocityController]] = {}
    broadcaster = _add_transform_broadcaster(builder, scenario, plans)
    for plan in plans:
        _add_robot(builder, parts, plan, broadcaster, published, controllers)
    clock = builder.AddNamedSystem("clock", ClockPublisher())
    _export_output(builder, clock.get_clock_output_port(), "/clock", published, "rosgraph_msgs/msg/Clock", 100.0)
    tf_type = "tf2_msgs/msg/TFMessage"
    _export_output(builder, broadcaster.get_tf_output_port(), "/tf", published, tf_type, 20.0)
    _export_output(builder, broadcaster.get_tf_static_output_port(), "/tf_static", published, tf_type, None)
    visualizer = None
    if meshcat is not None:
        # The page is drawn when the run loop asks for it, in wall time: an event of its own would split CENIC's steps.
        parameters = MeshcatVisualizerParams(role=Role.kIllustration, publish_period=inf)
        visualizer = MeshcatVisualizer.AddToBuilder(builder, parts.scene_graph, meshcat, parameters)
        visualizer.set_name("meshcat_visualizer")
    diagram = builder.Build()
    diagram.set_name("twin")
    return TwinDiagram(
        diagram=diagram,
        plant=parts.plant,
        scene_graph=parts.scene_graph,
        plans=plans,
        robots=parts.robots,
        published={
            topic: PublishedTopic(kind, diagram.GetOutputPort(topic[1:]), rate)
            for topic, (kind, rate) in published.items()
        },
        commanded={
            topic: CommandTopic(COMMANDS_TYPE, diagram.GetInputPort(topic[1:]), controller, plan.name)
            for topic, (plan, controller) in controllers.items()
        },
        visualizer=visualizer,
        world_models=parts.world_models,
        warnings=(*(warning for plan in plans for warning in plan.warnings), *parts.warnings),
        not_started=tuple(reason for plan in plans for reason in plan.not_started),
    )


def _add_robot(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plan: RobotPlan,
    broadcaster: TransformBroadcaster,
    published: dict[str, tuple[str, float | None]],
    controllers: dict[str, tuple[RobotPlan, VelocityController]],
) -> None:
    plant, (instance, layout) = parts.plant, (parts.robots[plan.name].instance, parts.robots[plan.name].layout)
    robot = build_robot_diagram(plan, layout)
    system = builder.AddNamedSystem(plan.name, robot.diagram)
    builder.Connect(plant.get_state_output_port(instance), system.GetInputPort("state"))
    builder.Connect(plant.get_net_actuation_output_port(instance), system.GetInputPort("net_actuation"))
    if layout.num_actuators:
        builder.Connect(system.GetOutputPort("desired_state"), plant.get_desired_state_input_port(instance))
    for port in ("tf", "tf_static", "ground_truth/odom"):
        if broadcaster.HasInputPort(f"{plan.name}/{port}"):
            builder.Connect(system.GetOutputPort(port), broadcaster.GetInputPort(f"{plan.name}/{port}"))
    namespace = plan.robot.topic_namespace
    for port, kind in PUBLISHED.items():
        rate = None if port == "robot_description" else plan.update_rate
        _export_output(builder, system.GetOutputPort(port), f"{namespace}/{port}", published, kind, rate)
    for name, controller in robot.controllers.items():
        topic = f"{namespace}/{name}/commands"
        if topic in controllers:
            raise InputError(f"robots {controllers[topic][0].name!r} and {plan.name!r} would both listen to {topic}")
        controllers[topic] = (plan, controller)
        builder.ExportInput(system.GetInputPort(f"{name}/commands"), topic[1:])


def _export_output(
    builder: DiagramBuilder,
    port: OutputPort,
    topic: str,
    published: dict[str, tuple[str, float | None]],
    kind: str,
    rate: float | None,
) -> None:
    if topic in published:
        raise InputError(f"two robots would publish on {topic}: give each a namespace of its own")
    builder.ExportOutput(port, topic[1:])
    published[topic] = (kind, rate)


def _add_transform_broadcaster(
    builder: DiagramBuilder, scenario: Scenario, plans: Sequence[RobotPlan]
) -> TransformBroadcaster:
    """A frame has one parent: a true base pose goes to tf only where no static transform places that frame."""
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
    broadcaster = TransformBroadcaster(
        robots=[plan.name for plan in plans],
        moving_bases=[plan.name for plan in own if not plan.model.is_fixed],
        static_transforms=[*static_transforms, *fixed_bases],
    )
    builder.AddNamedSystem("tf", broadcaster)
    return broadcaster


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
