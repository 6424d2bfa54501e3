"""The world in the plant: gravity, ground, the static and moving models of an SDF world, and beside it its wind."""

import re
from collections import defaultdict
from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder

from drake_twin.description.drake_log import DRAKE_RAISES, captured_warnings, reason_of, without_literal
from drake_twin.diagram.ball_joints import add_sdf_models
from drake_twin.diagram.contact_roles import ROUGH
from drake_twin.diagram.static_world import (
    StaticShape,
    anchors_of,
    bearable_detail,
    ground_shape,
    register_static_shapes,
    static_shapes,
)
from drake_twin.diagram.topics import PublishedTopic, Topics
from drake_twin.errors import InputError
from drake_twin.findings import Cause, Finding, Kind, Place, about_models
from drake_twin.scenario import CENIC, GROUND_FRICTION, Scenario, World

if TYPE_CHECKING:
    from drake_twin.control.wind import Swing
    from drake_twin.description.plugins.wind import SwingParameters
    from drake_twin.description.world_file import WorldFile, WorldModel
    from drake_twin.systems.wind import Wind

_WIND = "wind"  # the name of the system and of its noise

_GRAVITY = (0.0, 0.0, -9.81)
_FRICTION = 1.0


def add_world(
    plant: MultibodyPlant,
    scenario: Scenario,
    world_file: "WorldFile | None",
    findings: list[Finding],
) -> tuple[dict[str, tuple[ModelInstanceIndex, ...]], dict[str, dict[str, RigidTransform]]]:
    """Add gravity, ground and the world file's models to a plant.

    A model that Drake refuses is left out, which is a finding. Static models have no model instance and no body.

    Args:
        plant: The plant; it is changed.
        scenario: The scenario; its world overrides the file, and no robot may have the name of a model.
        world_file: The content of the world file.
        findings: Is extended by models that are left out.

    Returns:
        Moving model → its model instance and those of the models in it; static model with sensors → frame → its pose in
        the world.

    Raises:
        InputError: If a robot has the name of a model of the world.
    """
    world = scenario.world
    plant.mutable_gravity_field().set_gravity_vector(np.array(_gravity(world, world_file)))
    shapes: list[StaticShape] = []
    moving: dict[str, tuple[ModelInstanceIndex, ...]] = {}
    anchors: dict[str, dict[str, RigidTransform]] = {}
    if world_file is not None:
        _check_names(scenario, world_file)
        shapes, moving, anchors = _add_models(plant, world_file, findings)
    shapes = _with_ground(shapes, world)
    if GROUND_FRICTION in scenario.values:
        friction = CoulombFriction(ROUGH, ROUGH)
        shapes = [replace(item, friction=friction) if item.is_plane else item for item in shapes]
    register_static_shapes(plant, shapes)
    return moving, anchors


def _gravity(world: World, world_file: "WorldFile | None") -> tuple[float, float, float]:
    if world.gravity is not None:
        return world.gravity
    return _GRAVITY if world_file is None else world_file.gravity


def wind_of(world: World, world_file: "WorldFile | None") -> tuple[float, float, float]:
    """Return the velocity of the air in a world (m/s)."""
    if world.wind is not None:
        return world.wind
    return (0.0, 0.0, 0.0) if world_file is None else world_file.surroundings.wind


def _check_names(scenario: Scenario, world_file: "WorldFile") -> None:
    names = {model.name for model in world_file.models}
    for robot in scenario.robots:
        if robot.name in names:
            what = f"robot {robot.name!r} has the name of a model of the world: give it another name"
            raise InputError(what, file=world_file.file)


def _with_ground(shapes: list[StaticShape], world: World) -> list[StaticShape]:
    """Return the shapes, with the scenario's ground instead of the file's."""
    if world.ground is False:
        return [item for item in shapes if not item.is_plane]
    if world.ground_friction is not None:
        friction = CoulombFriction(world.ground_friction, world.ground_friction)
        shapes = [replace(item, friction=friction) if item.is_plane else item for item in shapes]
    if world.has_own_ground and not any(item.is_plane for item in shapes):
        shapes = [*shapes, ground_shape(_FRICTION if world.ground_friction is None else world.ground_friction)]
    return shapes


def _add_models(
    plant: MultibodyPlant, world_file: "WorldFile", findings: list[Finding]
) -> tuple[list[StaticShape], dict[str, tuple[ModelInstanceIndex, ...]], dict[str, dict[str, RigidTransform]]]:
    detail = bearable_detail(world_file.models)
    if detail > 0:
        what = f"the world's meshes have too many faces for contact: their details are reduced to {detail:g} m"
        findings.append(Finding(Kind.WARNING, what, file=str(world_file.file or "")))
    meshes: dict[Finding, dict[str, Place]] = defaultdict(dict)
    shapes: list[StaticShape] = []
    moving: dict[str, tuple[ModelInstanceIndex, ...]] = {}
    anchors: dict[str, dict[str, RigidTransform]] = {}
    for model in world_file.models:
        said: list[str] = []
        with captured_warnings() as messages:
            try:
                if model.is_static:
                    shapes += static_shapes(model, detail, said)
                    anchors |= anchors_of(model)
                else:
                    _try_out(model, plant.time_step())
                    moving[model.name] = _add_moving(plant, model)
            except (*DRAKE_RAISES, InputError) as error:
                reason = reason_of(error).rstrip(".")
                what = f"{model.name}: the model is left out, because Drake refuses it ({reason})"
                findings.append(Finding.at(Kind.IGNORED, what, model.place))
        for what in dict.fromkeys(said):
            meshes[Finding(Kind.WARNING, what, cause=Cause.MESH)][model.name] = model.place
        logged = dict.fromkeys(f"{model.name}: {without_literal(message)}" for message in messages)
        findings += [Finding.at(Kind.WARNING, what, model.place) for what in logged]
    findings += about_models(meshes)
    return shapes, moving, anchors


def _try_out(model: "WorldModel", time_step: float) -> None:
    """Parse a model in a separate plant: a model that Drake refuses must not break the twin's."""
    plant = MultibodyPlant(time_step)
    add_sdf_models(plant, model.text)
    plant.Finalize()


def _add_moving(plant: MultibodyPlant, model: "WorldModel") -> tuple[ModelInstanceIndex, ...]:
    add_sdf_models(plant, model.text)
    every = [
        index
        for index in map(ModelInstanceIndex, range(plant.num_model_instances()))
        if plant.GetModelInstanceName(index) == model.name
        or plant.GetModelInstanceName(index).startswith(f"{model.name}::")
    ]
    remove_actuators(plant, every)  # nothing commands these
    for index in every:
        plant.set_gravity_enabled(index, model.falls)
    return tuple(every)


def remove_actuators(plant: MultibodyPlant, instances: Collection[ModelInstanceIndex]) -> None:
    """Remove the actuators with which Drake's parser drives the joints of model instances."""
    # With an instance as argument, the plant lists its actuators only once it is finalized.
    for actuator in map(plant.get_joint_actuator, plant.GetJointActuatorIndices()):
        if actuator.model_instance() in instances:
            plant.RemoveJointActuator(actuator)


def add_wind(
    builder: DiagramBuilder, scenario: Scenario, world_file: "WorldFile | None", topics: Topics
) -> "tuple[float, float, float] | Wind":
    """Return the velocity of the air in the world (m/s), or the system of one that changes, which is added.

    Args:
        builder: The root diagram's builder.
        scenario: The scenario.
        world_file: The content of its world file.
        topics: Collects the topics.
    """
    wanted = wind_of(scenario.world, world_file)
    if world_file is None or (parameters := world_file.wind_effects) is None:
        return wanted
    from drake_twin.control.wind import ChangingWind
    from drake_twin.systems.wind import Wind

    parts = {"speed": parameters.speed, "direction": parameters.direction, "vertical": parameters.vertical}
    wind = ChangingWind(**{name: _swing(scenario, name, part) for name, part in parts.items()})
    step = 0.0 if scenario.engine == CENIC else scenario.time_step
    system: Wind = builder.AddNamedSystem(f"world/{_WIND}", Wind(wind, wanted, step))
    topic, port = f"{wind_topic(world_file.name)}_info", system.get_wind_info_output_port()
    topics.publish(PublishedTopic(topic, "geometry_msgs/msg/Vector3", port, 1.0 / scenario.time_step))
    return system


def wind_topic(world: str) -> str:
    """Return the topic of a world's wind, with characters that ROS does not take replaced by ``_``."""
    name = re.sub(r"[^a-zA-Z0-9_]+", "_", world) or "_"
    return f"/world/{'_' if name[0].isdigit() else ''}{name}/wind"


def changing_wind(diagram: Diagram) -> "Wind | None":
    """Return the system of a wind that changes; None for a steady one."""
    name = f"world/{_WIND}"
    if not diagram.HasSubsystemNamed(name):
        return None
    from drake_twin.systems.wind import Wind

    system = diagram.GetSubsystemByName(name)
    assert isinstance(system, Wind)
    return system


def present_wind(diagram: Diagram, root: Context, steady: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the velocity of the air at the present time (m/s).

    Args:
        diagram: The root diagram.
        root: Its context.
        steady: That of a wind that does not change.
    """
    system = changing_wind(diagram)
    return steady if system is None else system.present(system.GetMyContextFromRoot(root))


def _swing(scenario: Scenario, name: str, parameters: "SwingParameters") -> "Swing":
    from drake_twin.control.wind import Swing
    from drake_twin.sensors.noise import Noise, NoiseSource

    noise = None
    if parameters.noise:
        source = NoiseSource(scenario.seed, "", _WIND, 0.0, scenario.time_step)
        noise = source.channel(name, Noise(**parameters.noise)).apply
    return Swing(parameters.rise, parameters.amplitude, parameters.period, noise)
