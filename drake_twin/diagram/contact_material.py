"""Stiffness and damping of shapes, and the meshes that Drake makes of them for contact."""

from collections.abc import Iterator
from math import pi

from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddCompliantHydroelasticPropertiesForHalfSpace,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Convex,
    Cylinder,
    HalfSpace,
    ProximityProperties,
    SceneGraphConfig,
    Shape,
)
from pydrake.multibody.plant import CoulombFriction

from drake_twin.description.hull import corners_of, sides_under
from drake_twin.diagram.contact_shapes import (
    DISSIPATION,
    POINT_STIFFNESS,
    STIFFEST,
    UPRIGHT,
    ContactShape,
    Part,
    extent_of,
)
from drake_twin.diagram.rims_and_corners import CORNER_STIFFNESS, recess_of
from drake_twin.diagram.yielding_shapes import Yielding

# A face yields as if its model stood on a spring of this natural frequency, squared (1/s²): whatever the size and mass,
# it sinks by g / this = 25 µm under its own weight. With 2e5 a stack of three on a slope of 12° leans by 4 mm, with 1e5
# it falls. With more, at a step of 10 ms, a body that slides on a moving one trembles, which brakes it: 1e6 by up to 6
# % at a friction of 0.8, 4e5 by 2 %.
_FACE_STIFFNESS = 4e5

# What stands on a side that is not below its center of mass in the middle leans by less than this (rad).
_LEAN = 3e-4

# The least of that for the smallest face: what stands on it sinks by 75 µm at most.
_SMALL_FACE_STIFFNESS = 1.3e5

# Nothing is softer than a compact thing of this mass (kg): what pushes it may be stronger than its weight. Its faces
# have 3e5 to 1e6 N/m at least. Loose cylinders are left out: at a step of 10 ms a coin as stiff as this falls over.
_LEAST_BORNE = 2.5

# Of that, relative to the mass of the body itself: what weighs less than 10 mg would be so stiff that Drake's solvers
# fail at a step of 10 ms.
_MOST_BORNE = 2.5e5

_G = 9.81  # m/s²
_RIGID = 1e12  # N/m; for a point of a static shape

# The same for the supports of a robot that stands near its edge: what comes out faster tips it over (in CENIC, a robot
# that lands on its caster).
_SUPPORT_DISSIPATION = 50.0

# Faces that are closer than this take part in the solution of a step before they touch (m), so that they do not sink
# into each other in a step. Without it, at a step of 10 ms, a box that is set down sticks where it should slide:
# friction follows from the depth at the start of a step.
_MARGIN = 1e-3
_MARGIN_OF_THIN = 0.05  # relative to the smallest side

# With fixed steps only what has hollow sides may have it (``yielding_shapes`` says why), and what is so light that it
# would hop.
_HOPS = 0.01  # kg

# Drake adds to a shape what it lacks of these when a context is created, and then makes its faces once more.
_DEFAULTS = SceneGraphConfig().default_proximity_properties


def candidates(
    shape: ContactShape,
    friction: float,
    *,
    soft: Yielding | None,
    is_rigid: bool,
    is_discrete: bool,
    gradient: float | None = None,
) -> Iterator[tuple[bool, ProximityProperties]]:
    """Yield the possible properties of a shape, the best first, each with whether it has faces.

    Drake accepts the last one for every shape.

    Args:
        shape: The shape.
        friction: The coefficient of friction.
        soft: The shape whose faces yield, if they do.
        is_rigid: Whether it has faces that do not yield.
        is_discrete: Whether the engine has fixed steps.
        gradient: How fast the pressure rises in what yields (Pa/m); None for what follows from its mass.
    """
    if soft is not None and gradient is not None:
        properties = _material(shape, friction)
        modulus, depth = gradient * (soft.depth or 1.0), soft.depth or 1.0
        if isinstance(soft.shape, HalfSpace):
            AddCompliantHydroelasticPropertiesForHalfSpace(
                slab_thickness=depth, hydroelastic_modulus=modulus, properties=properties
            )
        else:
            AddCompliantHydroelasticProperties(
                resolution_hint=_resolution(soft.shape), hydroelastic_modulus=modulus, properties=properties
            )
        properties.AddProperty("hydroelastic", "margin", 0.0)
        yield True, properties
    elif soft is not None:
        modulus, hint = _modulus(shape, soft.depth), _resolution(shape.shape)
        for margin in dict.fromkeys((_margin(shape, soft, is_discrete=is_discrete), 0.0)):
            properties = _material(shape, friction)
            AddCompliantHydroelasticProperties(
                resolution_hint=hint, hydroelastic_modulus=modulus, properties=properties
            )
            properties.AddProperty("hydroelastic", "margin", margin)
            yield True, properties
    elif is_rigid:
        properties = _material(shape, friction)
        AddRigidHydroelasticProperties(resolution_hint=_resolution(shape.shape), properties=properties)
        properties.AddProperty("hydroelastic", "hydroelastic_modulus", _DEFAULTS.hydroelastic_modulus)
        yield True, properties
    yield False, _material(shape, friction)


def _material(shape: ContactShape, friction: float) -> ProximityProperties:
    properties = ProximityProperties()
    stiffness, dissipation = POINT_STIFFNESS * shape.mass, DISSIPATION
    if shape.is_static:
        stiffness = _RIGID
    elif shape.support is not None:
        stiffness, dissipation = shape.support.stiffness, _SUPPORT_DISSIPATION
    elif shape.point_stiffness is not None:
        stiffness = shape.point_stiffness * shape.mass
        if shape.part is Part.FOOT:
            stiffness = shape.point_stiffness * _borne(shape)
        elif shape.part is Part.CORNER:
            stiffness = max(stiffness, CORNER_STIFFNESS * _borne(shape))
        dissipation = shape.point_dissipation or DISSIPATION
    AddContactMaterial(
        dissipation=dissipation,
        point_stiffness=stiffness,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    properties.AddProperty("material", "relaxation_time", _DEFAULTS.relaxation_time)
    return properties


def usual_stiffness(shape: ContactShape) -> float:
    """Return the stiffness of a robot's shape that follows from its mass (N/m); of the largest face, if it has some."""
    return _FACE_STIFFNESS * _borne(shape) if shape.is_flat else POINT_STIFFNESS * shape.mass


def _borne(shape: ContactShape) -> float:
    """Return the mass that a shape's faces and corners bear at least (kg)."""
    if shape.is_loose and isinstance(shape.shape, Cylinder):
        return shape.mass
    return max(shape.mass, min(_LEAST_BORNE, _MOST_BORNE * shape.own_mass))


def _margin(shape: ContactShape, soft: Yielding, *, is_discrete: bool) -> float:
    if soft.depth is None:  # with a margin, such hulls sink in by millimeters
        return 0.0
    if is_discrete and not soft.is_hollow and shape.own_mass > _HOPS:
        return 0.0
    margin = min(_MARGIN, _MARGIN_OF_THIN * float(min(extent_of(shape.shape))))
    if shape.is_loose and isinstance(shape.shape, Cylinder):  # its side must not brake the rims that it rolls on
        return min(margin, recess_of(shape.shape.radius()) / 2)
    return margin


def _modulus(shape: ContactShape, depth: float | None) -> float:
    """Return the modulus with which a shape's faces are stiff enough (Pa).

    The pressure rises to it behind each face, to one depth or to the middle.
    """
    if (foot := shape.support) is not None:
        return foot.stiffness / foot.area * (depth or foot.height / 2)
    smallest, middle, largest = sorted(extent_of(shape.shape).tolist())
    # Of each face: the stiffness that it has at least, its sides, and how tall the body is that stands on it.
    faces = (
        (_FACE_STIFFNESS, middle, largest, smallest),
        (_SMALL_FACE_STIFFNESS, smallest, largest, middle),
        (_SMALL_FACE_STIFFNESS, smallest, middle, largest),
    )
    filled = pi / 4 if isinstance(shape.shape, Cylinder) else 1.0  # of a face's rectangle
    modulus = 0.0
    for least, width, length, height in faces:
        stands = 6 * UPRIGHT * height / width**2  # 1/s²: so stiff a face keeps a body upright
        stiffness = min(max(least, stands), STIFFEST)
        bears = max(stiffness * shape.mass, least * _borne(shape))
        modulus = max(modulus, bears / (filled * width * length) * (depth or height / 2))
    if shape.is_loose and isinstance(shape.shape, Convex):
        modulus = max(modulus, _modulus_to_stand(shape, depth))
    return modulus


def _modulus_to_stand(shape: ContactShape, depth: float | None) -> float:
    """Return the modulus with which a hull stands on each of its sides, which may be smaller than those around it."""
    center = shape.X_BG.inverse() @ shape.body.default_com()
    modulus = 0.0
    for side in sides_under(corners_of(shape.shape.GetConvexHull()), center):
        resists = side.width**2 / 12
        stiffness = max(_SMALL_FACE_STIFFNESS, UPRIGHT * side.height / resists, _G * side.off / (_LEAN * resists))
        modulus = max(modulus, min(stiffness, STIFFEST) * shape.mass / side.area * (depth or side.height))
    return modulus


def _resolution(shape: Shape) -> float:
    """Return the edge length of a cylinder's facets (m); boxes and hulls have their own."""
    return shape.radius() / 3 if isinstance(shape, Cylinder) else 1.0
