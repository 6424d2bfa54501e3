"""The plugins of a world that exert forces, on all robots and moving models."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drake_twin.controllers.world_forces import WORLD_FORCES, MovingBody, WorldBodies, WorldForces
from drake_twin.description.drake_urdf import urdf_link_name
from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.planning.robot_plan import RobotPlan

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldFile


def forces_of_world(parts: PlantOfTwin, plans: Sequence[RobotPlan], world_file: "WorldFile") -> list[WorldForces]:
    """Return the forces of a world's plugins on what moves in it.

    Args:
        parts: The finalized plant.
        plans: The robots.
        world_file: The content of the world file.
    """
    plant = parts.plant
    names = {robot.instance: name for name, robot in parts.robots.items()}
    names |= {index: plant.GetModelInstanceName(index) for every in parts.world_models.values() for index in every}
    fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
    windy = {f"{plan.name}::{link}" for plan in plans for link in plan.description.windy_links}
    windy |= {f"{model.name}::{link}" for model in world_file.models for link in model.windy_links}
    moving = [
        MovingBody(body, full, parts.solids.get(body.index(), ()), full in windy)
        for instance, name in names.items()
        for body in map(plant.get_body, plant.GetBodyIndices(instance))
        for full in (f"{name}::{urdf_link_name(body.name())}",)
        if body.index() not in fixed
    ]
    world = WorldBodies(plant, moving)
    return [WORLD_FORCES[plugin.type](plugin.parameters, world) for plugin in world_file.forces]
