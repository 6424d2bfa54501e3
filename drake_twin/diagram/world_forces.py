"""The plugins of a world that exert forces, on all robots and moving models."""

from typing import TYPE_CHECKING

from drake_twin.controllers.world_forces import WORLD_FORCES, MovingBody, WorldBodies, WorldForces
from drake_twin.description.drake_urdf import urdf_link_name
from drake_twin.diagram.plant import PlantOfTwin

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldFile


def forces_of_world(parts: PlantOfTwin, world_file: "WorldFile") -> list[WorldForces]:
    """Return the forces of a world's plugins on what moves in it.

    Args:
        parts: The finalized plant.
        world_file: The content of the world file.
    """
    plant = parts.plant
    names = {robot.instance: name for name, robot in parts.robots.items()}
    names |= {index: plant.GetModelInstanceName(index) for every in parts.world_models.values() for index in every}
    fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
    moving = [
        MovingBody(body, f"{name}::{urdf_link_name(body.name())}", parts.solids.get(body.index(), ()))
        for instance, name in names.items()
        for body in map(plant.get_body, plant.GetBodyIndices(instance))
        if body.index() not in fixed
    ]
    world = WorldBodies(plant, moving)
    return [WORLD_FORCES[plugin.type](plugin.parameters, world) for plugin in world_file.forces]
