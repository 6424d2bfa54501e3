"""The space that a robot takes, and the height of its root link when it stands on the ground."""

from dataclasses import replace

import numpy as np
from pydrake.geometry import QueryObject, Role
from pydrake.systems.framework import DiagramBuilder

from drake_twin.dataclass import dataclass
from drake_twin.diagram.contact_shapes import reach_of
from drake_twin.diagram.plant import add_plant
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import POINT, Scenario, World

_CLEARANCE = 1e-4  # height above the ground at which robots start (m): none penetrates it or falls visibly
_DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])


@dataclass(frozen=True)
class Footprint:
    """The bounding box of a robot at its start positions, in the frame of its root link (m)."""

    lower: tuple[float, float, float]
    upper: tuple[float, float, float]


def height_on_ground(plan: RobotPlan) -> float:
    """Return the height of the root link of a robot that stands on the ground (m); zero for a fixed robot."""
    return 0.0 if plan.model.is_fixed else round(_CLEARANCE - footprint(plan).lower[2], 6)


def footprint(plan: RobotPlan) -> Footprint:
    """Return the bounding box of a robot's collision shapes, or of its visual shapes if it has none."""
    builder = DiagramBuilder()
    plan = replace(plan, robot=replace(plan.robot, contact=POINT))  # Drake makes no meshes for these
    scenario = Scenario(robots=(plan.robot,), world=World(ground=False))
    parts = add_plant(builder, scenario, [plan])
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    query: QueryObject = parts.scene_graph.get_query_output_port().Eval(parts.scene_graph.GetMyContextFromRoot(context))
    inspector = query.inspector()
    root = parts.plant.GetBodyByName(plan.model.root_body, parts.robots[plan.name].instance)
    to_root = parts.plant.EvalBodyPoseInWorld(parts.plant.GetMyContextFromRoot(context), root).inverse()
    for role in (Role.kProximity, Role.kIllustration):
        reach = np.full(6, -np.inf)
        for geometry in inspector.GetAllGeometryIds(role):
            pose = to_root @ query.GetPoseInWorld(geometry)
            directions = _DIRECTIONS @ pose.rotation().matrix()
            shape = inspector.GetShape(geometry)
            farthest = np.array([reach_of(shape, direction) for direction in directions])
            reach = np.maximum(reach, _DIRECTIONS @ pose.translation() + farthest)
        if np.isfinite(reach).all():
            upper, lower = reach[:3].tolist(), (-reach[3:]).tolist()
            return Footprint((lower[0], lower[1], lower[2]), (upper[0], upper[1], upper[2]))
    return Footprint((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
