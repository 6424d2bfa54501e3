"""Fixed joints in the plant that come and go while it runs, for controllers that ask for them.

A plant cannot change once it is finalized, and a weld's pose is not in its context. But the two points and the length
of a rod between two bodies are (Drake's distance constraint), and whether it acts. So a fixed joint is six rods: three
along the axes at the child's center of mass, two across at a lever from it, one at another lever. They are set to the
pose that the bodies have when they are attached. At a step of 1 ms the child stays within 0.01 mm of it, whatever the
levers; at 10 ms within 0.3 mm while both tumble at 2 rad/s (`pytest tests/diagram/test_detachable_joints.py`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, FilterId, GeometrySet, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import DistanceConstraintParams, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, MultibodyConstraintId, RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.gazebo_drive import DETACHABLE_JOINT
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.diagram.cenic_constraints import cenic_has_constraints
from drake_twin.findings import Finding, Kind, Place
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import CENIC, DISCRETE
from drake_twin.systems.plant_reading import holds_state

_OWN_MODEL = "__model__"

# The length of a rod and of its lever from the child's center of mass (m).
_LENGTH = 0.1

# Of each rod: its place and its direction in the child's axes, both in lengths.
_RODS = tuple(
    (np.array(place, dtype=float), np.array(direction, dtype=float))
    for place, direction in (
        ((0, 0, 0), (1, 0, 0)),
        ((0, 0, 0), (0, 1, 0)),
        ((0, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 1, 0)),
        ((1, 0, 0), (0, 0, 1)),
        ((0, 1, 0), (0, 0, 1)),
    )
)

# Stiffer than what Drake's solver takes for rigid, up to a ton at 1 ms (N/m). With an infinite one the solver fails
# where a rod's ends cannot move along it, as across the plane of a linkage.
_STIFFNESS = 1e12

# Drake's rods act in each new context, and cannot be without stiffness (N/m).
_NO_STIFFNESS = 1e-300


@dataclass(frozen=True)
class JointInPlant:
    """The place of a detachable joint in the plant.

    Attributes:
        robot: The robot whose controller asks for it.
        controller: The controller.
        parent: The robot's link.
        child: The other model's link.
        rods: The constraints.
    """

    robot: str
    controller: str
    parent: RigidBody
    child: RigidBody
    rods: tuple[MultibodyConstraintId, ...]

    def set_pose(self, plant: MultibodyPlant, context: Context, X_PC: RigidTransform | None) -> None:
        """Keep the child at a pose in the parent's frame, or let it go.

        Args:
            plant: The plant.
            context: Its context.
            X_PC: The pose; None to let it go.
        """
        center = self.child.CalcCenterOfMassInBodyFrame(context)
        for rod, (place, direction) in zip(self.rods, _RODS, strict=True):
            plant.SetConstraintActiveStatus(context, rod, X_PC is not None)
            if X_PC is not None:
                p_CQ = center + _LENGTH * place
                p_PR = X_PC @ (p_CQ + _LENGTH * direction)
                ends = self.parent.index(), p_PR, self.child.index(), p_CQ
                plant.SetDistanceConstraintParams(
                    context, rod, DistanceConstraintParams(*ends, _LENGTH, _STIFFNESS, 0.0)
                )

    def hold(
        self,
        plant: MultibodyPlant,
        scene_graph: SceneGraph,
        root: Context,
        X_PC: RigidTransform | None,
        filter_before: FilterId | None,
    ) -> FilterId | None:
        """Keep the child at a pose in the parent's frame, where the two models do not touch, or let it go.

        Args:
            plant: The plant.
            scene_graph: Its scene graph.
            root: The context of their diagram.
            X_PC: The pose; None to let it go.
            filter_before: What was returned the last time.

        Returns:
            The collision filter to give the next time.
        """
        if not holds_state(plant):
            self.set_pose(plant, plant.GetMyMutableContextFromRoot(root), X_PC)
        filters = scene_graph.collision_filter_manager(scene_graph.GetMyMutableContextFromRoot(root))
        if filter_before is not None:
            filters.RemoveDeclaration(filter_before)
        instances = [body.model_instance() for body in (self.parent, self.child)]
        if X_PC is None or instances[0] == instances[1]:
            return None
        parents, children = (
            GeometrySet([plant.GetBodyFrameIdOrThrow(index) for index in plant.GetBodyIndices(instance)])
            for instance in instances
        )
        declared: FilterId = filters.ApplyTransient(CollisionFilterDeclaration().ExcludeBetween(parents, children))
        return declared


def add_detachable_joints(
    plant: MultibodyPlant,
    plans: Sequence[RobotPlan],
    instances: Mapping[str, ModelInstanceIndex],
    world_models: Mapping[str, tuple[ModelInstanceIndex, ...]],
    findings: list[Finding],
) -> tuple[JointInPlant, ...]:
    """Add the rods of the detachable joints of all robots, without effect in a new context.

    Args:
        plant: The plant, with all bodies and not yet finalized; it is changed.
        plans: The robots.
        instances: Robot → its model instance.
        world_models: Moving model of the world → its model instances.
        findings: Is extended by the joints that cannot be.
    """
    models = {name: (instance,) for name, instance in instances.items()} | dict(world_models)
    joints = []
    for plan in plans:
        for item in plan.controllers:
            if item.type != DETACHABLE_JOINT or item.problem is not None:
                continue
            name = item.parameters.child_model
            parent = plant.GetBodyByName(drake_link_name(item.parameters.parent_link), instances[plan.name])
            child = _child(plant, models[plan.name], models, name, item.parameters.child_link)
            problem = _problem(plant, parent, child)
            if child is None and item.parameters.suppress_child_warning:
                continue
            if child is None or problem:
                what = problem or f"no moving model {name!r} with a link {item.parameters.child_link!r} is there yet"
                kind = Kind.NOT_STARTED if problem else Kind.WARNING
                written = (plugin.place for plugin in plan.description.plugins if _names_child(plugin, name))
                finding = Finding.at(kind, f"{item.name}: {what}", next(written, Place("")))
                findings.append(replace(finding, robot=plan.name))
                continue
            points = parent, np.zeros(3), child, np.zeros(3)
            rods = tuple(plant.AddDistanceConstraint(*points, _LENGTH, _NO_STIFFNESS, 0.0) for _ in _RODS)
            joints.append(JointInPlant(plan.name, item.name, parent, child, rods))
    return tuple(joints)


def _names_child(plugin: GazeboPlugin, model: str) -> bool:
    """Tell whether a plugin is the one that fixes a model."""
    return model in plugin.elements.get("child_model", ())


def _child(
    plant: MultibodyPlant,
    own: tuple[ModelInstanceIndex, ...],
    models: Mapping[str, tuple[ModelInstanceIndex, ...]],
    model: str,
    link: str,
) -> RigidBody | None:
    """Return the link of another model; None if it does not exist."""
    nested = drake_link_name(f"{model}::{link}")  # of a model inside the robot's own
    searched = own if model == _OWN_MODEL else models.get(model, ())
    places = [(drake_link_name(link), instance) for instance in searched] + [(nested, instance) for instance in own]
    if model not in models and plant.HasModelInstanceNamed(model):
        places.append((link, plant.GetModelInstanceByName(model)))
    return next((plant.GetBodyByName(*place) for place in places if plant.HasBodyNamed(*place)), None)


def _problem(plant: MultibodyPlant, parent: RigidBody, child: RigidBody | None) -> str | None:
    """Return why two links cannot be joined; None if they can, or the child does not exist."""
    if child is None:
        return None
    if child.index() == parent.index():
        return "its parent and child are one link"
    still = set(plant.GetBodiesWeldedTo(plant.world_body()))
    if parent in still and child in still:
        return "neither of its links moves"
    if plant.time_step() == 0.0 and not cenic_has_constraints("AddDistanceConstraint", 1.0):
        return f"the engine {CENIC} of this Drake has no such joint: use the engine {DISCRETE}"
    return None
