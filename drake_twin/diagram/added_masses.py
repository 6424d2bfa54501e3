"""The added mass of a fluid about links, by ``<fluid_added_mass>`` of SDF robots and of models of a world."""

from collections.abc import Mapping, Sequence

import numpy as np

from drake_twin.controllers.added_mass import AddedMassForces
from drake_twin.controllers.body_forces import BodyForces
from drake_twin.description.added_mass import added_masses
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.xml_reader import XmlReader
from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.planning.robot_plan import RobotPlan


def forces_of_added_masses(
    parts: PlantOfTwin, plans: Sequence[RobotPlan], of_world: Mapping[str, Mapping[str, tuple[float, ...]]]
) -> Sequence[BodyForces]:
    """Return the forces of added mass on the links that have some and move.

    Args:
        parts: The finalized plant.
        plans: The robots that may have such links.
        of_world: Model of the world → link → its added mass.

    Raises:
        InputError: If an added mass is invalid.
    """
    plant = parts.plant
    fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
    links, matrices, owners = [], [], []
    for plan in plans:
        reader = XmlReader(plan.description.text, plan.description.file)
        model = reader.root.find("model")
        for link, matrix in () if model is None else added_masses(model, reader):
            link = link.replace("::", "_")  # as `drake_twin.description.sdf_nested` calls those of models inside
            if link in plan.description.links:
                links.append(plant.GetBodyByName(drake_link_name(link), parts.robots[plan.name].instance))
                matrices.append(matrix)
                owners.append(f"robot {plan.name!r}")
    for name, found in of_world.items():
        for link, matrix in found.items() if name in parts.world_models else ():
            scope, _, own = f"{name}::{link}".rpartition("::")
            links.append(plant.GetBodyByName(own, plant.GetModelInstanceByName(scope)))
            matrices.append(matrix)
            owners.append(f"model {name!r}")
    kept = [number for number, link in enumerate(links) if link.index() not in fixed]
    if not kept:
        return ()
    added = np.array([matrices[number] for number in kept]).reshape(-1, 6, 6)
    return (AddedMassForces(plant, [links[number] for number in kept], added, [owners[number] for number in kept]),)
