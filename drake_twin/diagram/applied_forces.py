"""The forces on the plant's bodies beside those of its joints and contacts: pushes, and what systems exert.

A plant has one port for them all, and a port takes one connection.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import ExternallyAppliedSpatialForceMultiplexer, MultibodyPlant, Propeller, PropellerInfo
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import ConstantValueSource, Multiplexer, PassThrough

from drake_twin.controllers.body_forces import BodyForces, ForceController, RobotBody
from drake_twin.diagram.gyroscopic_moments import add_gyroscopic_moments, bodies_that_gain_energy
from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.plant_reading import holds_state

if TYPE_CHECKING:
    from drake_twin.controllers.world_forces import WorldForces
    from drake_twin.description.world_file import WorldFile
    from drake_twin.systems.wind import Wind

# No robot has such names.
_ON_LINKS = "forces/on_links"
_PUSHES = "forces/pushes"
_ALL = "forces/all"


def apply_forces(
    builder: DiagramBuilder,
    parts: PlantOfTwin,
    plans: Sequence[RobotPlan],
    robots: Mapping[str, RobotDiagram],
    world_file: "WorldFile | None",
    wind: "tuple[float, float, float] | Wind",
) -> Iterator[Finding]:
    """Apply the forces of controllers and the world and the moments that tumbling bodies need; leave room for pushes.

    Args:
        builder: The root diagram's builder.
        parts: The finalized plant.
        plans: The robots.
        robots: Their diagrams.
        world_file: The content of the world file.
        wind: The velocity of the air in the world (m/s), or the system of one that changes.

    Yields:
        What keeps them from it.
    """
    plant, of_world = parts.plant, []
    controllers = [item for robot in robots.values() for item in robot.forces()]
    if world_file is not None and world_file.forces:
        from drake_twin.diagram.world_forces import forces_of_world

        of_world = forces_of_world(parts, plans, world_file)
    if builder.IsConnectedOrExported(plant.get_applied_spatial_force_input_port()):
        what = "a system of yours is connected to the plant's port applied_spatial_force"
        if bodies := ", ".join(bodies_that_gain_energy(plant)):
            yield Finding(Kind.WARNING, f"{what}: in the air {bodies} gain energy where they tumble")
        if names := ", ".join(controller.setup.name for controller, _ in controllers):
            yield Finding(Kind.NOT_STARTED, f"{what}: {names} exert no forces")
        if of_world:
            yield Finding(Kind.NOT_STARTED, f"{what}: the plugins of the world exert no forces")
        return
    tumbling = None if holds_state(plant) else add_gyroscopic_moments(builder, plant)
    found = tumbling, _forces_of(builder, plant, controllers, of_world, wind)
    sources = [source for source in found if source is not None]
    if not sources:
        return
    pushes = join_forces(builder, plant, sources)
    none = builder.AddNamedSystem("forces/no_pushes", ConstantValueSource(pushes.Allocate()))
    if builder.HasSubsystemNamed(_ON_LINKS) and builder.GetSubsystemByName(_ON_LINKS).HasInputPort("pushes"):
        heard = builder.AddNamedSystem(_PUSHES, PassThrough(pushes.Allocate()))
        builder.Connect(heard.get_output_port(), pushes)
        builder.Connect(heard.get_output_port(), builder.GetSubsystemByName(_ON_LINKS).GetInputPort("pushes"))
        pushes = heard.get_input_port()
    builder.Connect(none.get_output_port(), pushes)


def join_forces(builder: DiagramBuilder, plant: MultibodyPlant, sources: Sequence[OutputPort]) -> InputPort:
    """Apply the forces of some ports to a plant, and return the port for pushes, which has no value yet."""
    system = builder.AddNamedSystem(_ALL, ExternallyAppliedSpatialForceMultiplexer(len(sources) + 1))
    for number, source in enumerate(sources):
        builder.Connect(source, system.get_input_port(number))
    builder.Connect(system.get_output_port(), plant.get_applied_spatial_force_input_port())
    pushes: InputPort = system.get_input_port(len(sources))
    return pushes


def follow_masses(diagram: Diagram, plant: MultibodyPlant, root: Context) -> None:
    """Let forces that depend on masses follow those in a context.

    Args:
        diagram: The root diagram.
        plant: Its plant.
        root: The diagram's context; it is changed.
    """
    if diagram.HasSubsystemNamed(_ON_LINKS):
        from drake_twin.controllers.applied_forces import AppliedForces

        system = diagram.GetSubsystemByName(_ON_LINKS)
        assert isinstance(system, AppliedForces)
        system.follow(plant.GetMyContextFromRoot(root), system.GetMyMutableContextFromRoot(root))


def wrench_port(diagram: Diagram, plant: MultibodyPlant) -> InputPort:
    """Return the port for pushes, whose value can be fixed."""
    if not diagram.HasSubsystemNamed(_ALL):
        return plant.get_applied_spatial_force_input_port()
    if diagram.HasSubsystemNamed(_PUSHES):
        return diagram.GetSubsystemByName(_PUSHES).get_input_port()
    system = diagram.GetSubsystemByName(_ALL)
    return system.get_input_port(system.num_input_ports() - 1)


def _forces_of(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    controllers: Sequence[tuple[ForceController, OutputPort]],
    of_world: "Sequence[WorldForces]",
    wind: "tuple[float, float, float] | Wind",
) -> OutputPort | None:
    """Add the system that computes the forces of controllers and of the world, and Drake's own that applies them."""
    by_kind: dict[type[BodyForces], list[tuple[ForceController, OutputPort]]] = {}
    for controller, signals in controllers:
        by_kind.setdefault(controller.Forces, []).append((controller, signals))
    steady = wind if isinstance(wind, tuple) else None
    blows = [] if isinstance(wind, tuple) else [wind.get_blows_output_port()]
    kinds: list[tuple[BodyForces, list[OutputPort]]] = [
        (forces, blows if forces.has_wind_signal else []) for forces in of_world if forces.bodies
    ]
    for kind, found in by_kind.items():
        sources: list[tuple[ForceController, RobotBody]] = []
        for controller, _ in found:
            assert controller.body is not None
            sources.append((controller, controller.body))
        kinds.append((kind(sources), [signals for _, signals in found if signals.size()]))
    if not kinds:
        return None
    kinds.sort(key=lambda entry: entry[0].is_last)
    ports = [port for _, signals in kinds for port in signals]
    sizes = [(forces, sum(port.size() for port in signals)) for forces, signals in kinds]
    from drake_twin.controllers.applied_forces import AppliedForces

    generalized = plant.get_applied_generalized_force_input_port()
    is_left = not builder.IsConnectedOrExported(generalized)
    system = builder.AddNamedSystem(_ON_LINKS, AppliedForces(plant, sizes, may_be_generalized=is_left, wind=steady))
    builder.Connect(plant.get_state_output_port(), system.GetInputPort("state"))
    if not isinstance(wind, tuple):
        builder.Connect(wind.get_velocity_output_port(), system.GetInputPort("wind"))
    if ports:
        joined = builder.AddNamedSystem("forces/signals", Multiplexer([port.size() for port in ports]))
        for number, port in enumerate(ports):
            builder.Connect(port, joined.get_input_port(number))
        builder.Connect(joined.get_output_port(), system.GetInputPort("signals"))
    if system.are_generalized:  # propellers and their forces would cost a body 5 µs a step
        builder.Connect(system.get_output_port(), generalized)
        return None
    propellers = [
        PropellerInfo(
            body_index=body.index(),
            X_BP=RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), np.zeros(3)),
            thrust_ratio=thrust,
            moment_ratio=1.0 - thrust,
        )
        for body in system.bodies
        for thrust in (0.0, 1.0)
        for axis in np.eye(3)
    ]
    applied = builder.AddNamedSystem("forces/propellers", Propeller(propellers))
    builder.Connect(plant.get_body_poses_output_port(), applied.get_body_poses_input_port())
    builder.Connect(system.GetOutputPort("wrenches"), applied.get_command_input_port())
    forces: OutputPort = applied.get_spatial_forces_output_port()
    return forces
