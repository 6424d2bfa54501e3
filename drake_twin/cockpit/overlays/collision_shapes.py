"""The shapes that contact is computed with, translucent."""

from collections.abc import Iterator

from pydrake.geometry import HalfSpace, Meshcat, Rgba, Role

from drake_twin.cockpit.overlays import PATH
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes
from drake_twin.diagram.joint_friction import is_brake
from drake_twin.twin import Twin

_COLOR = Rgba(0.16, 0.62, 0.56, 0.45)


class CollisionShapes(BodyShapes):
    """The proximity role's geometries of all bodies, but no brakes in joints; Meshcat cannot draw half spaces."""

    def __init__(self, meshcat: Meshcat, twin: Twin):
        super().__init__(meshcat, twin, f"{PATH}/collision", _shapes(twin))


def _shapes(twin: Twin) -> Iterator[BodyShape]:
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        body = twin.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        shape = inspector.GetShape(geometry)
        if body is not None and not isinstance(shape, HalfSpace) and not is_brake(inspector, geometry):
            yield BodyShape(body.index(), inspector.GetPoseInFrame(geometry), shape, _COLOR)
