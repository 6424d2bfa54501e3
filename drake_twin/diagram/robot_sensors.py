"""The sensors of a robot's sub-diagram, and the broadcasters that read them."""

from collections.abc import Iterable, Mapping
from dataclasses import field
from typing import TYPE_CHECKING

from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.dataclass import dataclass
from drake_twin.description.surroundings import Surroundings
from drake_twin.diagram.plant_inputs import PlantInputs, free_name
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import PlannedTopic, SensorPlan
from drake_twin.planning.world_sensors import ModelPlan
from drake_twin.sensors.cameras.lazy_renderer import LazyRenderer
from drake_twin.sensors.noise import NoiseSource
from drake_twin.sensors.sensor_host import SensorHost
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.systems.plant_reading import PlantPorts

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldFile
    from drake_twin.systems.wind import Wind


@dataclass(frozen=True)
class SensorSurroundings:
    """What the sensors and controllers of all robots are built in.

    Attributes:
        ports: The finalized plant's ports.
        scene_graph: The scene graph with all shapes.
        time_step: The physics step (s).
        seed: What noise is drawn from.
        noise: Whether there is noise.
        world: The world's file; None without one.
        renderer: What draws the pictures of cameras.
        wind: The velocity of the air in the world (m/s), or the system of one that changes.
    """

    ports: PlantPorts
    scene_graph: SceneGraph | None = None
    time_step: float = 1e-3
    seed: int = 0
    noise: bool = True
    world: "WorldFile | None" = None
    renderer: LazyRenderer = field(default_factory=LazyRenderer)
    wind: "tuple[float, float, float] | Wind" = (0.0, 0.0, 0.0)

    @property
    def plant(self) -> MultibodyPlant:
        """The finalized plant."""
        return self.ports.plant


@dataclass(frozen=True)
class SensorPort:
    """The port of a sensor's topic: the sensor's plan, the topic, the name of the port on its host, the sensor."""

    plan: SensorPlan
    topic: PlannedTopic
    name: str
    system: SensorSystem


def add_read_sensors(
    builder: DiagramBuilder,
    plan: RobotPlan,
    instance: ModelInstanceIndex,
    surroundings: SensorSurroundings,
    controllers: Mapping[str, Controller],
    inputs: PlantInputs,
) -> tuple[tuple[SensorPort, ...], tuple[str, ...]]:
    """Add the sensors that a robot's controllers read to its sub-diagram, and connect them.

    Returns:
        The sub-diagram's output ports for the sensors' topics, and the sensors' warnings.
    """
    readers = {name: item for name, item in controllers.items() if isinstance(item, SensorReader)}
    wanted = {item.simulated_sensor for item in readers.values()}
    read = [item for item in plan.sensors if _key(item) in wanted]
    host = SensorHost()
    systems, ports, warnings = _add(host, plan, read, instance, surroundings, "sensor ", {})
    if read:
        builder.AddNamedSystem(free_name(builder, "sensors"), host)
        for output, port in host.inputs_from(surroundings.ports, surroundings.scene_graph):
            inputs.connect(output, output.get_name(), port)
        for item in ports:
            builder.ExportOutput(host.GetOutputPort(item.name), item.name)
    for name, controller in readers.items():
        _connect(builder, name, controller, instance, surroundings, systems, inputs)
    return ports, warnings


def add_other_sensors(
    host: SensorHost,
    plan: RobotPlan | ModelPlan,
    instance: ModelInstanceIndex,
    surroundings: SensorSurroundings,
    known: Iterable[SensorPort] = (),
    anchors: Mapping[str, RigidTransform] | None = None,
) -> tuple[tuple[SensorPort, ...], tuple[str, ...]]:
    """Give a host the sensors of a robot, or of a model of the world, that no controller reads.

    Args:
        host: The host.
        plan: The robot or the model.
        instance: It in the plant.
        surroundings: What its sensors are built in.
        known: The ports of those that controllers read.
        anchors: Frame → pose in the world, of a static model.

    Returns:
        The host's output ports for the sensors' topics, and the sensors' warnings.
    """
    there = {item.plan.place for item in known}
    others = [item for item in plan.sensors if item.place not in there]
    _, ports, warnings = _add(host, plan, others, instance, surroundings, f"{plan.name}/", anchors or {})
    return ports, warnings


def _add(
    host: SensorHost,
    plan: RobotPlan | ModelPlan,
    sensors: Iterable[SensorPlan],
    instance: ModelInstanceIndex,
    surroundings: SensorSurroundings,
    prefix: str,
    anchors: Mapping[str, RigidTransform],
) -> tuple[dict[tuple[str, str], SensorSystem], tuple[SensorPort, ...], tuple[str, ...]]:
    systems: dict[tuple[str, str], SensorSystem] = {}
    ports: list[SensorPort] = []
    warnings: list[str] = []
    world = surroundings.world
    factor = 0.0 if not surroundings.noise else plan.robot.noise if isinstance(plan, RobotPlan) else 1.0
    for item in sensors:
        noise = NoiseSource(surroundings.seed, plan.name, item.place, item.rate, surroundings.time_step, factor)
        setup = SensorSetup(
            sensor=item.sensor,
            settings=item.settings,
            plant=surroundings.plant,
            instance=instance,
            scene_graph=surroundings.scene_graph,
            frame=item.frame,
            noise=noise,
            description=plan.description,
            frame_prefix=plan.frame_prefix,
            host=host,
            prefix=f"{prefix}{item.place}/",
            surroundings=Surroundings() if world is None else world.surroundings,
            renderer=surroundings.renderer,
            owner=plan.name,
            anchors=anchors,
            models=() if world is None else world.models,
            wind=surroundings.wind if isinstance(surroundings.wind, tuple) else None,
        )
        system = item.kind(setup)
        systems[_key(item)] = system
        ports += [SensorPort(item, topic, system.port_name(topic.own), system) for topic in item.topics if topic.topic]
        warnings += [f"sensor {item.place}: {text}" for text in system.warnings]
    return systems, tuple(ports), tuple(warnings)


def _key(item: SensorPlan) -> tuple[str, str]:
    return item.sensor.name.strip("/"), item.sensor.kind


def _connect(
    builder: DiagramBuilder,
    name: str,
    controller: SensorReader,
    instance: ModelInstanceIndex,
    surroundings: SensorSurroundings,
    systems: Mapping[tuple[str, str], SensorSystem],
    inputs: PlantInputs,
) -> None:
    """Connect a controller to the sensor that it reads; one that nothing simulates has constant values."""
    system = systems.get(controller.simulated_sensor)
    if system is not None:
        builder.Connect(system.output(system.values_port), controller.get_sensor_input_port())
        return
    own = controller.own_sensor(surroundings.plant, instance)
    source = ConstantVectorSource(controller.initial_values()) if own is None else own
    builder.AddNamedSystem(free_name(builder, f"{name}_sensor"), source)
    builder.Connect(source.get_output_port(), controller.get_sensor_input_port())
    if own is not None:
        for output, port in own.inputs_from(surroundings.ports):
            inputs.connect(output, output.get_name(), port)
