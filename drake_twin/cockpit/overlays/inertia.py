"""The mass distribution of each body, as an ellipsoid of the same inertia."""

from collections.abc import Iterator

from pydrake.geometry import Ellipsoid, Rgba

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes, bodies_with_mass
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
    for body, M_BBo_B in bodies_with_mass(twin):
        radii, X_BE = M_BBo_B.CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid()
        a, b, c = (max(float(radius), _THINNEST) for radius in radii)
        yield BodyShape(body, X_BE, Ellipsoid(a, b, c), _COLOR)
