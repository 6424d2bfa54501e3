"""Collision shapes with the properties that decide on their contact."""

from collections.abc import Sequence
from enum import Enum
from math import fsum, inf, sqrt

import numpy as np
from pydrake.geometry import (
    Box,
    CalcVolume,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    GeometryId,
    HalfSpace,
    Mesh,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of
from drake_twin.description.surface_velocity import has_moving_surface
from drake_twin.diagram.contact_models import ContactModel
from drake_twin.diagram.wheels import WheelFinder
from drake_twin.scenario import POINT
from drake_twin.systems.plant_reading import physics_step

_ROUND = (Sphere, Capsule, Ellipsoid)
_LEAST_MASS = 1e-3  # kg
_THINNEST = 1e-6  # m
_LEAST = 1e-100  # m, whose square is not zero

# What is thinner is pressed out on the wrong side where a corner has passed its middle in a step (m).
_THICK = 0.05

_SHORT = 2e-3  # s; see `has_short_steps`

# A body falls over on contacts that yield more to a side than they bear of its weight: they have ten times the
# stiffness that this needs (m/s²).
UPRIGHT = 10 * 9.81

# No face, rim or corner is stiffer than this (1/s²), which keeps a plate upright that is 1 mm thick and 10 cm tall.
# Thinner things would be so stiff that Drake's solvers fail where they fall onto something.
STIFFEST = 1e8

# What touches in a point yields as if its model stood on a spring of this natural frequency, squared (1/s²).
POINT_STIFFNESS = 1e5


# Hunt and Crossley's dissipation (s/m). A body that has sunk in comes out at 1/this at most: at Drake's default of 50
# it creeps out, at 1 it jumps.
DISSIPATION = 5.0


@dataclass(frozen=True, order=True)
class Group:
    """Shapes that do not meet each other; groups are ordered by mass.

    Attributes:
        mass: The mass of the whole model (kg).
        model: The model's name.
        body: The body's index if the model's bodies collide with each other; else -1.
    """

    mass: float
    model: str
    body: int


class Part(Enum):
    """What decides on which shapes a shape meets where loose ones have balls beside their faces.

    The last three do not move.
    """

    WHOLE = "whole"  # it meets all but balls
    FACES = "faces"  # of what has feet: they meet all but planes and balls
    CORNER = "corner"  # a ball that meets what is thick
    FOOT = "foot"  # a ball that meets planes
    THIN = "thin"  # it meets no ball: one that is pressed in by a step may pass its middle
    THICK = "thick"  # it meets corners beside the faces between them
    PLANE = "plane"  # it meets feet in place of the faces between them

    @property
    def is_ball(self) -> bool:
        """Whether it is a ball beside the faces of a shape."""
        return self in (Part.CORNER, Part.FOOT)

    def meets(self, other: "Part") -> bool:
        """Return whether shapes of two parts meet."""
        pair = {self, other}
        if Part.CORNER in pair:
            return Part.THICK in pair
        if Part.FOOT in pair:
            return Part.PLANE in pair
        return pair != {Part.FACES, Part.PLANE}


@dataclass(frozen=True)
class Support:
    """How a shape that a robot stands on is to yield.

    Attributes:
        stiffness: Of the shape, which follows from the weight that it bears (N/m).
        area: Of the face that it stands on, if it has faces (m²).
        height: Of the shape above that face (m).
    """

    stiffness: float
    area: float
    height: float


@dataclass(frozen=True)
class ContactShape:
    """A collision shape.

    Attributes:
        geometry: Its geometry; None for a point beside the faces of another, which is not registered yet.
        body: Its body.
        name: Its name in the scene graph.
        shape: The shape that contact uses.
        X_BG: The pose of that shape on the body.
        friction: Its coefficient of friction.
        group: The group that it belongs to; None for static parts of the world.
        is_static: Whether it never moves.
        is_flat: Whether it has hydroelastic contact.
        is_wheel: Whether it is an ellipsoid instead of a wheel's cylinder.
        is_loose: Whether its whole model is one moving rigid body, such as a crate.
        mass: The mass that it may have to bear (kg).
        own_mass: The mass of what its body is welded to, with its own (kg).
        point_stiffness: How stiff it is where it touches in a point (a natural frequency squared, 1/s²); None as usual.
        point_dissipation: Hunt and Crossley's there (s/m); None as usual.
        part: What decides on which shapes it meets where loose ones have balls beside their faces.
        is_roller: Whether it is one of several around a wheel.
        support: What its robot stands on; None for stiffness that follows from its mass.
        is_track: Whether it moves, and its surface along it.
    """

    geometry: GeometryId | None
    body: RigidBody
    name: str
    shape: Shape
    X_BG: RigidTransform
    friction: float
    group: Group | None
    is_static: bool
    is_flat: bool
    is_wheel: bool
    is_loose: bool
    mass: float
    own_mass: float
    point_stiffness: float | None = None
    point_dissipation: float | None = None
    part: Part = Part.WHOLE
    is_roller: bool = False
    support: Support | None = None
    is_track: bool = False


def has_short_steps(plant: MultibodyPlant) -> bool:
    """Return whether a plant's steps are so short that few places of contact do.

    With longer ones, and in CENIC, a box that is set down on balls sticks where it should slide: a ball takes part in a
    step only once it has sunk in, and a face before. And a cube slips three times as fast out of pads that touch it
    with few facets: Drake's solvers regularize friction in proportion to the step and to the force of each.
    """
    return 0 < physics_step(plant) <= _SHORT


def extent_of(shape: Shape) -> np.ndarray:
    """Return the side lengths of the box around a box, a cylinder or a hull, in its frame (m)."""
    if isinstance(shape, Box):
        return np.asarray(np.maximum(shape.size(), _LEAST))
    if isinstance(shape, Cylinder):
        return np.asarray(np.maximum([2 * shape.radius(), 2 * shape.radius(), shape.length()], _LEAST))
    return np.asarray(np.maximum(np.ptp(corners_of(shape.GetConvexHull()), axis=0), _THINNEST))


def reach_of(shape: Shape, direction: np.ndarray) -> float:
    """Return the extent of a shape from its origin in a direction of its own frame (its support function, m)."""
    across = float(np.hypot(direction[0], direction[1]))
    along = abs(float(direction[2]))
    if isinstance(shape, Sphere):
        return float(shape.radius())
    if isinstance(shape, Box):
        return float(np.abs(direction) @ shape.size() / 2)
    if isinstance(shape, Cylinder):
        return float(shape.radius() * across + shape.length() / 2 * along)
    if isinstance(shape, Capsule):
        return float(shape.radius() + shape.length() / 2 * along)
    if isinstance(shape, Ellipsoid):
        return float(np.linalg.norm(direction * (shape.a(), shape.b(), shape.c())))
    if isinstance(shape, Mesh | Convex):
        return float(np.max(corners_of(shape.GetConvexHull()) @ direction))
    return 0.0


def _thickness(shape: Shape) -> float:
    """Return how thick a shape is at least (m): as if it filled the box around it but for its smallest side."""
    if isinstance(shape, HalfSpace):
        return inf
    if isinstance(shape, _ROUND):
        return float(np.cbrt(CalcVolume(shape)))
    _, middle, largest = sorted(extent_of(shape).tolist())
    return float(CalcVolume(shape) / (middle * largest))


class ShapeReader:
    """Read the properties and the owner of a shape.

    Args:
        plant: The plant, not yet finalized.
        models: The robots and the moving models of the world.
        world_contact: ``hydroelastic`` or ``point``, for static parts of the world.
    """

    def __init__(self, plant: MultibodyPlant, models: Sequence[ContactModel], world_contact: str):
        self._plant = plant
        self._models = {instance: model for model in models for instance in model.instances}
        self._world_contact = world_contact
        poses = {model.instances[0]: model.root_pose for model in models if model.root_pose is not None}
        self._wheels = WheelFinder(plant, poses)
        self._masses = {model.name: self._mass_of(model) for model in models}
        self._static = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}

    def read(
        self, geometry: GeometryId, body: RigidBody, name: str, shape: Shape, X_BG: RigidTransform, friction: float
    ) -> ContactShape:
        """Return a geometry of the plant as contact uses it."""
        model = self._models.get(body.model_instance())
        is_static = body.index() in self._static
        contact = self._world_contact if model is None else model.contact
        if isinstance(shape, Mesh):
            shape = Convex(shape.source(), shape.scale3())
        wheel = None if is_static else self._wheels.wheel(body, shape, X_BG)
        if wheel is not None:
            shape, X_BG = wheel.shape, wheel.X_BE
        own = fsum(item.default_mass() for item in self._plant.GetBodiesWeldedTo(body))
        total = own if model is None else self._masses[model.name]
        moves = total if wheel is not None and wheel.is_roller else own
        group = None
        if model is not None:
            collides = model.colliding is None or body.name() in model.colliding
            group = Group(total, model.name, int(body.index()) if collides else -1)
        return ContactShape(
            geometry=geometry,
            body=body,
            name=name,
            shape=shape,
            X_BG=X_BG,
            friction=friction,
            group=group,
            is_static=is_static,
            part=self._part(shape) if is_static else Part.WHOLE,
            is_flat=contact != POINT and not isinstance(shape, _ROUND),
            is_wheel=wheel is not None,
            is_roller=wheel is not None and wheel.is_roller,
            is_track=not is_static and has_moving_surface(self._plant, body),
            is_loose=not is_static and model is not None and self._is_one_body(model, body),
            # A link may have to bear the whole model, but must not be too stiff for its own mass: the geometric mean of
            # both. Rollers always bear it, and would sink in by half a millimeter.
            mass=sqrt(max(moves, _LEAST_MASS) * max(total, own, _LEAST_MASS)),
            own_mass=own,
        )

    def _part(self, static: Shape) -> Part:
        if isinstance(static, HalfSpace) and has_short_steps(self._plant):
            return Part.PLANE
        return Part.THICK if _thickness(static) >= _THICK else Part.THIN

    def _is_one_body(self, model: ContactModel, body: RigidBody) -> bool:
        """Tell whether a model is one body, and not a vehicle: its tracks turn it on their faces alone."""
        count = sum(len(self._plant.GetBodyIndices(instance)) for instance in model.instances)
        welded = self._plant.GetBodiesWeldedTo(body)
        return count == len(welded) and not any(has_moving_surface(self._plant, each) for each in welded)

    def _mass_of(self, model: ContactModel) -> float:
        bodies = (index for instance in model.instances for index in self._plant.GetBodyIndices(instance))
        return float(fsum(self._plant.get_body(index).default_mass() for index in bodies))
