"""Loose cylinders roll on rims: two thin ellipsoids that touch in points, beside the flat ends, which touch as faces.

As facets the curved side would brake: a cylinder of them loses half of its speed in three seconds.
"""

from dataclasses import replace

from pydrake.geometry import Cylinder, Ellipsoid, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.diagram.contact_shapes import UPRIGHT, ContactShape

# The faceted cylinder stays inside its rims by this part of its radius, and no more than so much (m): more than rims
# sink in, less than is seen.
_RECESS = 0.01
_DEEPEST_RECESS = 5e-4

# Half of a rim's thickness, relative to the radius and to the length.
_THICK = 0.1
_SHARE = 0.05

_LEAST = 1e-4  # m


def recess_of(radius: float) -> float:
    """Return how far inside its rims the side of a loose cylinder of a radius (m) is (m)."""
    return min(_RECESS * radius, _DEEPEST_RECESS)


def with_rims(plant: MultibodyPlant, shape: ContactShape) -> list[ContactShape]:
    """Return a shape's parts: of a loose cylinder a thinner one and two rims, which are added to the plant.

    Args:
        plant: The plant, not yet finalized.
        shape: The shape.
    """
    cylinder = shape.shape
    if not (shape.is_loose and shape.is_flat and isinstance(cylinder, Cylinder)):
        return [shape]
    radius, length = cylinder.radius(), cylinder.length()
    recess = recess_of(radius)
    half = min(_THICK * radius, _SHARE * length)
    parts = [replace(shape, shape=Cylinder(radius - recess, length))]
    rim = Ellipsoid(radius, radius, half)
    apart = max(length / 2 - half - recess, 0.0)  # from the middle; inside the end, which is flat
    # Two points hold it upright if they are stiffer (1/s²) than g radius ÷ (2 apart²).
    stiffness = UPRIGHT * radius / (2 * max(apart, _LEAST) ** 2)
    for number, side in enumerate((-1, 1)):
        name = f"{shape.name}|rim{number}"
        pose = shape.X_BG @ RigidTransform([0.0, 0.0, side * apart])
        geometry = plant.RegisterCollisionGeometry(shape.body, pose, rim, name, ProximityProperties())
        part = replace(shape, geometry=geometry, name=name, shape=rim, X_BG=pose, is_flat=False)
        parts.append(replace(part, least_stiffness=stiffness))
    return parts
