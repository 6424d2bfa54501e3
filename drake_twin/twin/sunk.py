"""Robots that penetrate something when they are spawned."""

from collections.abc import Collection, Mapping

from pydrake.geometry import GeometryId, QueryObject
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin.diagram.static_world import GROUND
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.findings import Finding, Kind

_LEAST_DEPTH = 1e-3  # m: a body at rest penetrates its support far less


def sunk_robots(built: TwinDiagram, context: Context, robots: Collection[str]) -> dict[str, tuple[Finding, ...]]:
    """Find robots that penetrate something deeply, in the context's state.

    Args:
        built: The diagram.
        context: Its root context.
        robots: The names of the robots to check; of two robots, the one added later counts as the one that penetrates.

    Returns:
        Robot → a warning for each robot, model or part of the world that it penetrates, at the deepest point.
    """
    scene_graph = built.scene_graph
    query: QueryObject = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(context))
    owners = built.owners()
    order = {name: index for index, name in enumerate(built.robots)}
    deepest: dict[tuple[str, str], tuple[float, str]] = {}
    for pair in query.ComputePointPairPenetration():
        sides = [_owner_and_body(built, owners, query, geometry) for geometry in (pair.id_A, pair.id_B)]
        sides.sort(key=lambda side: -order.get(side[0], -1))
        (robot, body), (other, other_body) = sides
        if robot not in robots or robot == other or pair.depth < _LEAST_DEPTH:
            continue
        if pair.depth > deepest.get((robot, other), (0.0, ""))[0]:
            whose = f"robot {other!r}" if other in order else f"the world's {other!r}"
            place = f"in the ground ({body})" if other == GROUND else f"in {whose} ({body} in {other_body})"
            depth = f"{100 * pair.depth:.1f} cm" if pair.depth >= 0.01 else f"{1000 * pair.depth:.1f} mm"
            text = f"it starts {depth} deep {place}: contact pushes it out"
            deepest[robot, other] = (pair.depth, text)
    found: dict[str, tuple[Finding, ...]] = {}
    for (robot, _), (_, text) in sorted(deepest.items()):
        found[robot] = (*found.get(robot, ()), Finding(Kind.WARNING, text, robot=robot))
    return found


def _owner_and_body(
    built: TwinDiagram, owners: Mapping[ModelInstanceIndex, str], query: QueryObject, geometry: GeometryId
) -> tuple[str, str]:
    """Return the robot or model of a shape, and its body; for a static part of the world, the model and its link."""
    inspector = query.inspector()
    body = built.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
    if name := owners.get(body.model_instance()):
        return name, body.name()
    model, _, rest = inspector.GetName(geometry).rpartition("::")[2].partition("/")
    return model, rest.partition("/")[0]
