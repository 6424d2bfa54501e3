"""The shapes of tracks and of the ground where the two meet: the tracks are hard, and the ground yields.

The facets where a hard and a yielding shape meet are the hard one's. Were the track soft, they would be the ground's,
and at the edge of a stair half of them would stand across the track, which slides into them: they would brake it.
"""

from collections.abc import Iterable

from pydrake.common import MemoryFile
from pydrake.geometry import Box, Cylinder, HalfSpace, InMemoryMesh, Mesh, Shape

from drake_twin.diagram.contact_material import usual_stiffness
from drake_twin.diagram.contact_shapes import ContactShape, extent_of
from drake_twin.diagram.track_shapes import hard_box
from drake_twin.diagram.yielding_shapes import Yielding, hard

_SLAB = 1.0  # m, how deep the pressure rises below a plane


def hard_track(shape: ContactShape) -> Shape:
    """Return a shape of a track that does not yield."""
    if not isinstance(shape.shape, Box):
        return hard(shape, is_fine=True)
    text = hard_box(*shape.shape.size().tolist())
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(text, ".obj", "track")))


def yielding_ground(shape: ContactShape) -> Yielding:
    """Return a static shape as one that yields."""
    form = shape.shape
    if isinstance(form, HalfSpace):
        return Yielding(form, _SLAB)
    if isinstance(form, Cylinder):
        return Yielding(form, min(form.radius(), form.length() / 2))
    return Yielding(form, float(extent_of(form).min()) / 2)


def gradient_of_ground(shapes: Iterable[ContactShape]) -> float:
    """Return how fast the pressure rises below the ground (Pa/m), so that tracks sink in as other robots do."""
    gradients = [0.0]
    for shape in shapes:
        if shape.is_track and shape.is_flat:
            _, middle, largest = sorted(extent_of(shape.shape).tolist())
            gradients.append(usual_stiffness(shape) / (middle * largest))
    return max(gradients)
