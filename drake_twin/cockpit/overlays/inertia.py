"""The mass distribution of each body, as an ellipsoid of the same inertia."""

from collections.abc import Iterator
from math import inf

from pydrake.geometry import Ellipsoid, Rgba
from pydrake.multibody.tree import BodyIndex

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.twin.twin import Twin

_COLOR = Rgba(0.53, 0.33, 0.74, 0.5)
_THINNEST = 2e-3  # m


@overlay("inertia", "Inertia", "A solid ellipsoid for each link, with its moments of inertia", "I")
class Inertia(BodyShapes):
    """A solid ellipsoid of uniform density for each body with mass, with the moments of inertia of the body."""

    def __init__(self, scene: Scene, twin: Twin):
        super().__init__(scene, twin, f"{OVERLAYS}/inertia", _shapes(twin), on_top=True)


def _shapes(twin: Twin) -> Iterator[BodyShape]:
    plant = twin.plant
    context = plant.GetMyContextFromRoot(twin.context)
    for number in range(1, plant.num_bodies()):  # 0 is the world
        body = plant.get_body(BodyIndex(number))
        M_BBo_B = body.CalcSpatialInertiaInBodyFrame(context)
        if not 0.0 < M_BBo_B.get_mass() < inf:
            continue
        radii, X_BE = M_BBo_B.CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid()
        a, b, c = (max(float(radius), _THINNEST) for radius in radii)
        yield BodyShape(body.index(), X_BE, Ellipsoid(a, b, c), _COLOR)
