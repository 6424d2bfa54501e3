"""The contact of collision shapes: on faces or in a point, the friction of a pair, and which shapes meet.

Drake's point contact gives a pair of convex shapes one point, so that a box stands on one corner at a time: friction is
wrong, stacks sink, boxes fall through slopes. Its hydroelastic contact integrates a pressure over the faces that meet.
So all flat shapes use hydroelastic contact; round ones (wheels, spheres, capsules, ellipsoids) touch in a point, which
is exact for them and cheaper. Loose shapes do both: see ``rims_and_corners``.
"""

from collections.abc import Sequence

from pydrake.geometry import Role, SceneGraph, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from drake_twin.dataclass import dataclass
from drake_twin.diagram.contact_models import ContactModel
from drake_twin.diagram.contact_roles import Registry, exclude_within_models, variants
from drake_twin.diagram.contact_shapes import ContactShape, ShapeReader
from drake_twin.diagram.extreme_shapes import said_of_extremes
from drake_twin.diagram.hard_tracks import gradient_of_ground
from drake_twin.diagram.rims_and_corners import with_points
from drake_twin.diagram.supports import share_weight

# How a shape touches, as named in reports.
FACES, IN_A_POINT, WHEEL = "faces", "point", "wheel"

_DEFAULT_FRICTION = 1.0  # the default of ODE, DART and Drake


@dataclass(frozen=True)
class TouchingShape:
    """The contact of a collision shape.

    Attributes:
        model: The robot or the model of the world; empty for static parts of the world.
        body: The body B in the plant.
        name: The shape's name in the scene graph.
        shape: The shape that contact uses: a mesh's convex hull, a wheel's ellipsoid.
        X_BG: The pose of that shape on the body.
        touches: `FACES`, `IN_A_POINT`, or `WHEEL` for a point of an ellipsoid in place of a cylinder.
        friction: Its coefficient of friction.
    """

    model: str
    body: BodyIndex
    name: str
    shape: Shape
    X_BG: RigidTransform
    touches: str
    friction: float


def give_contact(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    models: Sequence[ContactModel],
    world_contact: str,
    warnings: list[str],
) -> tuple[TouchingShape, ...]:
    """Decide on the contact of every collision shape of a plant.

    Args:
        plant: The plant, with all shapes, not yet finalized; it is changed.
        scene_graph: Its scene graph; it is changed.
        models: The robots and the moving models of the world.
        world_contact: ``hydroelastic`` or ``point``, for static parts of the world.
        warnings: Is extended by shapes that cannot have hydroelastic contact.

    Returns:
        The contact of each shape, in the order of registration; corners belong to their shape.
    """
    inspector = scene_graph.model_inspector()
    reader = ShapeReader(plant, models, world_contact)
    frictions = {instance: model.friction for model in models for instance in model.instances}
    shapes: list[ContactShape] = []
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        properties = inspector.GetProximityProperties(geometry)
        friction = _DEFAULT_FRICTION
        own = frictions.get(body.model_instance())
        if own is not None:
            friction = own
        elif properties.HasProperty("material", "coulomb_friction"):
            friction = properties.GetProperty("material", "coulomb_friction").dynamic_friction()
        # Copies: the inspector returns references into the scene graph, which is about to be changed.
        shape, X_BG = inspector.GetShape(geometry).Clone(), RigidTransform(inspector.GetPoseInFrame(geometry))
        shapes.append(reader.read(geometry, body, inspector.GetName(geometry), shape, X_BG, friction))
    warnings.extend(said_of_extremes(shapes))
    shapes = with_points(share_weight(plant, shapes, models), warnings)
    registry = Registry(plant, scene_graph, gradient_of_ground(shapes))
    for shape, wanted in zip(shapes, variants(shapes, warnings), strict=True):
        registry.add(shape, wanted)
    registry.filter()
    exclude_within_models(plant, scene_graph, models)
    found = []
    for shape in shapes:
        if shape.part.is_ball:
            continue
        touches = WHEEL if shape.is_wheel else FACES if shape.is_flat else IN_A_POINT
        if shape.geometry in registry.without_faces:
            touches = IN_A_POINT
            what = f"a collision shape of {shape.body.name()} touches in a point: Drake cannot compute its pressure"
            warnings.append(f"{shape.group.model if shape.group else 'the world'}: {what}")
        model = "" if shape.group is None else shape.group.model
        body = shape.body.index()
        found.append(TouchingShape(model, body, shape.name, shape.shape, shape.X_BG, touches, shape.friction))
    return tuple(found)
