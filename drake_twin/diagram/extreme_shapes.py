"""Collision shapes and masses that are too small or too large for contact to be what their files mean."""

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from pydrake.geometry import Capsule, Convex, Ellipsoid, HalfSpace, Sphere

from drake_twin.diagram.contact_shapes import ContactShape, extent_of
from drake_twin.findings import first_of

# What touches in a point sinks in by a tenth of a millimeter under its own weight.
_THINNEST = 1e-4  # m
_LARGEST = 1e3  # m; of what moves
_LARGEST_STATIC = 1e5  # m

_LIGHTEST = 1e-6  # kg; of less, contact at a step of 10 ms fails, and CENIC sees no acceleration
_HEAVIEST = 1e8  # kg; more sinks in by a millimeter

_MOST_NAMED = 3


def said_of_extremes(shapes: Sequence[ContactShape]) -> Iterator[str]:
    """Yield sentences on the shapes and bodies of each model that are beyond what contact is made for."""
    found: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for shape in shapes:
        model = "the world" if shape.group is None else shape.group.model
        for kind, value in _extremes(shape):
            found[model, kind].setdefault(shape.body.name(), value)
    for (model, kind), values in found.items():
        bodies = first_of(values, _MOST_NAMED)
        yield f"{model}: {kind.format(bodies=bodies, value=f'{next(iter(values.values())):.3g}')}"


def _extremes(shape: ContactShape) -> Iterator[tuple[str, float]]:
    """Yield in which ways a shape is extreme, as a sentence, with the value."""
    if isinstance(shape.shape, HalfSpace) or (shape.is_static and isinstance(shape.shape, Convex)):
        return  # the solids of a static mesh are as thick as it allows
    sides = _sides_of(shape)
    if (smallest := float(sides.min())) < _THINNEST:
        yield (
            "a collision shape of {bodies} is {value} m thin: it may sink in or pass, as contact yields by 1e-4 m",
            smallest,
        )
    if (largest := float(sides.max())) > (_LARGEST_STATIC if shape.is_static else _LARGEST):
        yield "a collision shape of {bodies} is {value} m large: does its file mean millimeters?", largest
    if not shape.is_static and shape.own_mass < _LIGHTEST:
        yield "{bodies} weighs {value} kg: contact is made for 1e-6 kg and more", shape.own_mass
    if not shape.is_static and shape.mass > _HEAVIEST:
        yield (
            "{bodies} bears {value} kg: contact is made for 1e8 kg at most, and yields by more than a millimeter",
            shape.mass,
        )


def _sides_of(shape: ContactShape) -> np.ndarray:
    """Return the sides of the box around a shape, in its frame (m)."""
    form = shape.shape
    if isinstance(form, Sphere):
        return np.full(3, 2 * form.radius())
    if isinstance(form, Capsule):
        return np.array([2 * form.radius(), 2 * form.radius(), form.length() + 2 * form.radius()])
    if isinstance(form, Ellipsoid):
        return 2 * np.array([form.a(), form.b(), form.c()])
    return extent_of(form)
