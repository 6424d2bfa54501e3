"""Which robots and models of the world touch each other, in how many facets and points."""

from collections import Counter
from collections.abc import Mapping

from pydrake.geometry import GeometryId, Role

from drake_twin.diagram.joint_friction import is_brake
from drake_twin.twin.twin import Twin


def models_of_shapes(twin: Twin) -> dict[GeometryId, str]:
    """Return the robot or moving model of the world of each collision shape that has one, other than brakes."""
    names = {shape.body: shape.model for shape in twin.built.shapes if shape.model}
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    bodies = {
        geometry: twin.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        for geometry in inspector.GetAllGeometryIds(Role.kProximity)
        if not is_brake(inspector, geometry)
    }
    models = {geometry: names.get(body.index(), "") for geometry, body in bodies.items() if body is not None}
    return {geometry: model for geometry, model in models.items() if model}


def touching(twin: Twin, models: Mapping[GeometryId, str]) -> tuple[Counter[tuple[str, str]], Counter[tuple[str, str]]]:
    """Return between which models there are how many facets, and how many points; what has no model is ``""``.

    Args:
        twin: The twin.
        models: What `models_of_shapes` returns.

    Raises:
        RunError: If Drake cannot solve the next step.
    """
    results = twin.graph.evaluate(twin.built.ports.contact_results())
    facets, points = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
    for index in range(results.num_hydroelastic_contacts()):
        surface = results.hydroelastic_contact_info(index).contact_surface()
        facets[_pair(models, surface.id_M(), surface.id_N())] += surface.num_faces()
    for index in range(results.num_point_pair_contacts()):
        point = results.point_pair_contact_info(index).point_pair()
        points[_pair(models, point.id_A, point.id_B)] += 1
    return facets, points


def _pair(models: Mapping[GeometryId, str], one: GeometryId, other: GeometryId) -> tuple[str, str]:
    first, second = sorted((models.get(one, ""), models.get(other, "")))
    return first, second
