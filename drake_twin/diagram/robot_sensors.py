"""The sensors of a robot's sub-diagram, and the broadcasters that read them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.description.surroundings import Surroundings
from drake_twin.diagram.plant_inputs import PlantInputs, free_name
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.sensors.noise import NoiseSource
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem


@dataclass(frozen=True)
class SensorSurroundings:
    """What the sensors of all robots are built in.

    Attributes:
        plant: The finalized plant.
        scene_graph: The scene graph with all shapes.
        time_step: The physics step (s).
        seed: What noise is drawn from.
        noise: Whether there is noise.
        world: Where on Earth the world is, and its magnetic field.
        shared: What sensors share, by what it is.
    """

    plant: MultibodyPlant
    scene_graph: SceneGraph | None = None
    time_step: float = 1e-3
    seed: int = 0
    noise: bool = True
    world: Surroundings = field(default_factory=Surroundings)
    shared: dict[str, Any] = field(default_factory=dict)


def add_sensors(
    builder: DiagramBuilder,
    plan: RobotPlan,
    instance: ModelInstanceIndex,
    surroundings: SensorSurroundings,
    controllers: Mapping[str, Controller],
    inputs: PlantInputs,
) -> tuple[dict[str, tuple[SensorPlan, str]], tuple[str, ...]]:
    """Add a robot's sensors, and connect the controllers that read them.

    Returns:
        Name of the sub-diagram's output port → the sensor that publishes there, and its topic's own name; and the
        sensors' warnings.
    """
    systems: dict[tuple[str, str], SensorSystem] = {}
    ports: dict[str, tuple[SensorPlan, str]] = {}
    warnings: list[tuple[str, str]] = []
    for item in plan.sensors:
        system = item.kind(_setup(plan, item, instance, surroundings))
        builder.AddNamedSystem(free_name(builder, f"sensor {item.place}"), system)
        for output, port in system.inputs_from(surroundings.plant, surroundings.scene_graph):
            inputs.connect(output, output.get_name(), port)
        systems[item.sensor.name.strip("/"), item.sensor.kind] = system
        warnings += [(item.place, text) for text in system.warnings]
        for topic in item.topics:
            if topic.topic is not None:
                name = f"sensor {item.place}/{topic.own}"
                builder.ExportOutput(system.GetOutputPort(topic.own), name)
                ports[name] = item, topic.own
    for name, controller in controllers.items():
        if isinstance(controller, SensorReader):
            _connect(builder, name, controller, instance, surroundings, systems, inputs)
    return ports, tuple(f"sensor {place}: {text}" for place, text in warnings)


def _setup(
    plan: RobotPlan, item: SensorPlan, instance: ModelInstanceIndex, surroundings: SensorSurroundings
) -> SensorSetup:
    return SensorSetup(
        sensor=item.sensor,
        settings=item.settings,
        plant=surroundings.plant,
        instance=instance,
        scene_graph=surroundings.scene_graph,
        frame=item.frame,
        noise=NoiseSource(
            surroundings.seed,
            plan.name,
            item.place,
            item.rate,
            surroundings.time_step,
            is_on=surroundings.noise,
        ),
        description=plan.description,
        frame_prefix=plan.frame_prefix,
        surroundings=surroundings.world,
        shared=surroundings.shared,
    )


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
        builder.Connect(system.GetOutputPort(system.values_port), controller.get_sensor_input_port())
        return
    own = controller.own_sensor(surroundings.plant, instance)
    source = ConstantVectorSource(controller.initial_values()) if own is None else own
    builder.AddNamedSystem(free_name(builder, f"{name}_sensor"), source)
    builder.Connect(source.get_output_port(), controller.get_sensor_input_port())
    if own is not None:
        for output, port in own.inputs_from(surroundings.plant):
            inputs.connect(output, output.get_name(), port)
