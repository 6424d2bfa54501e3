"""The static parts of an SDF world as shapes of the world body: planes, meshes as solids, and all other shapes.

Such shapes cost nothing in a step, while each link that is welded to the world costs 0.8 µs.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree
from pydrake.geometry import (
    Box,
    Convex,
    GeometryInstance,
    HalfSpace,
    IllustrationProperties,
    PerceptionProperties,
    SceneGraph,
    SceneGraphInspector,
    Shape,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import SpatialInertia

from drake_twin.dataclass import dataclass
from drake_twin.description.model_frames import model_frames
from drake_twin.description.robot_description import Vector3
from drake_twin.errors import InputError

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldModel

GROUND = "ground"  # the name of the shape of a world without a file

# Drake 1.51 crashes if a half space and other shapes (53 were enough), or more than 14 half spaces, are on the world
# body: FCL divides a tree of bounding boxes with an infinite one without end. So beside a plane all other shapes are on
# a body that is welded to the world, where a shape costs 0.1 µs a step, and more where shapes overlap (a terrain of
# 1,150 triangles: 1.3 ms). Above a number of shapes the plane is replaced by the upper side of a huge box.
_STATIC_BODY = "static_world"
_MOST_BESIDE_A_PLANE = 100
_MOST_PLANES = 8
_ENDLESS = 10_000.0  # m
_DEEP = 10.0  # m

# A plane whose normal has a smaller z than this is a wall: a slab of its size, not endless ground.
_GROUND_FACES = 0.1

# Building a plant takes time and memory with the square of the number of shapes (1,000: 0.5 s, 240 MB).
_MOST_SOLIDS = 1200
_DETAILS = (0.0, 0.05, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 51.2, 204.8)  # m; each one takes time if a mesh is new


@dataclass(frozen=True)
class StaticShape:
    """A shape in the world frame: it collides if it has friction, and is visible if it has a color."""

    name: str
    shape: Shape
    pose: RigidTransform
    friction: CoulombFriction | None = None
    look: IllustrationProperties | None = None
    camera_look: PerceptionProperties | None = None

    @property
    def is_plane(self) -> bool:
        """Whether the shape is a half space on which something can stand."""
        return isinstance(self.shape, HalfSpace)


def ground_shape(friction: float) -> StaticShape:
    """Return the half space z < 0."""
    return StaticShape(GROUND, HalfSpace(), RigidTransform(), friction=CoulombFriction(friction, friction))


def static_shapes(model: "WorldModel", detail: float, warnings: list[str]) -> list[StaticShape]:
    """Return the shapes of a static model.

    Drake's parser determines their poses; planes and meshes, which it would read differently, are replaced by stand-ins
    for it.

    Args:
        model: The model.
        detail: The size below which details of a mesh may be lost (m); see `bearable_detail`.
        warnings: Is extended by parts that are left out.

    Raises:
        RuntimeError: If Drake refuses the model.
    """
    root = etree.fromstring(model.text)
    stand_ins = _put_stand_ins(root, detail, warnings)
    plant, scene_graph = MultibodyPlant(0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)  # a diagram builder would hold both for good (drake#22515)
    Parser(plant).AddModelsFromString(etree.tostring(root, encoding="unicode"), "sdf")
    plant.Finalize()
    return list(_shapes(plant, scene_graph.model_inspector(), stand_ins))


def anchors_of(model: "WorldModel") -> dict[str, dict[str, RigidTransform]]:
    """Return the poses in the world of the frames of a static model, and of those in it, that have sensors.

    Raises:
        RuntimeError: If Drake refuses the model.
    """
    frames = model_frames(model.text) if model.sensing else {}
    return {each.name: frames[each.name] for each in model.sensing}


def bearable_detail(models: "Sequence[WorldModel]") -> float:
    """Return the finest detail of static meshes (m) that does not give the plant too many solids."""
    from drake_twin.description.solid_mesh import solid_mesh

    meshes: Counter[tuple[str, Vector3]] = Counter()
    for model in models:
        if model.is_static:
            meshes.update(_mesh_and_scale(mesh) for mesh in etree.fromstring(model.text).iterfind(".//collision//mesh"))
    step = 0
    while True:
        detail, total = _DETAILS[step], 0
        for (file, scale), times in meshes.items():
            with suppress(InputError):  # reported where the mesh is used
                total += times * len(solid_mesh(Path(file), detail / max(map(abs, scale))))
        if total <= _MOST_SOLIDS or step == len(_DETAILS) - 1:
            return detail
        step = min(step + (1 if total < 4 * _MOST_SOLIDS else 2), len(_DETAILS) - 1)


def register_static_shapes(plant: MultibodyPlant, shapes: Sequence[StaticShape]) -> None:
    """Add shapes to a plant that is not finalized."""
    planes = _different_planes(item for item in shapes if item.is_plane)
    solids = [item for item in shapes if item.friction is not None and not item.is_plane]
    visuals = [item for item in shapes if item.friction is None]
    body = plant.world_body()
    if planes and len(solids) > _MOST_BESIDE_A_PLANE:
        planes = [
            replace(item, shape=Box(_ENDLESS, _ENDLESS, _DEEP), pose=item.pose @ RigidTransform([0.0, 0.0, -_DEEP / 2]))
            for item in planes
        ]
    elif planes and solids:
        body = plant.AddRigidBody(
            _STATIC_BODY, plant.AddModelInstance(_STATIC_BODY), SpatialInertia.SolidSphereWithMass(1.0, 1.0)
        )
        plant.WeldFrames(plant.world_frame(), body.body_frame())
    numbers = count()  # Drake needs unique names
    for item in planes:
        name = f"{item.name}/{next(numbers)}"
        plant.RegisterCollisionGeometry(plant.world_body(), item.pose, item.shape, name, item.friction)
    for item in solids:
        with suppress(RuntimeError):  # Qhull considers one of a mesh's solids too flat: the others suffice
            plant.RegisterCollisionGeometry(body, item.pose, item.shape, f"{item.name}/{next(numbers)}", item.friction)
    for item in visuals:
        name = f"{item.name}/{next(numbers)}"
        instance = GeometryInstance(item.pose, item.shape, name)
        if item.look is not None:
            instance.set_illustration_properties(item.look)
        if item.camera_look is not None:
            instance.set_perception_properties(item.camera_look)
        plant.RegisterVisualGeometry(plant.world_body(), instance)


def _different_planes(planes: Iterable[StaticShape]) -> list[StaticShape]:
    found: list[StaticShape] = []
    for plane in planes:
        if len(found) < _MOST_PLANES and not any(_same_plane(plane.pose, other.pose) for other in found):
            found.append(plane)
    return found


def _same_plane(one: RigidTransform, other: RigidTransform) -> bool:
    normal = one.rotation().matrix()[:, 2]
    distance = float(normal @ (one.translation() - other.translation()))
    return float(normal @ other.rotation().matrix()[:, 2]) > 1 - 1e-9 and abs(distance) < 1e-6


@dataclass(frozen=True)
class _StandIn:
    """The shapes behind a stand-in: the name in the file, the solids of a mesh, or a plane's size and rotation."""

    name: str
    solids: tuple[np.ndarray, ...] = ()
    size: tuple[float, float] | None = None
    turn: RotationMatrix | None = None

    def shapes(self, pose: RigidTransform) -> Iterator[tuple[Shape, RigidTransform]]:
        """Yield the shapes and their poses in the world, given the stand-in's pose."""
        for points in self.solids:
            yield Convex(points, "part of a mesh"), pose
        if self.size is not None:
            X = pose @ RigidTransform(self.turn, np.zeros(3))
            if X.rotation().matrix()[2, 2] > _GROUND_FACES:
                yield HalfSpace(), X
            else:
                from drake_twin.description.solid_mesh import THICKNESS

                yield Box(*self.size, THICKNESS), X @ RigidTransform(np.array([0.0, 0.0, -THICKNESS / 2]))


def _shapes(
    plant: MultibodyPlant, inspector: SceneGraphInspector, stand_ins: dict[str, _StandIn]
) -> Iterator[StaticShape]:
    # Copies of all, as what the inspector returns belongs to the scene graph, which ends with this.
    context = plant.CreateDefaultContext()
    for geometry in inspector.GetAllGeometryIds():
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        pose = plant.EvalBodyPoseInWorld(context, body) @ inspector.GetPoseInFrame(geometry)
        own = inspector.GetName(geometry).rpartition("::")[2]
        stand_in = stand_ins.get(own)
        scope = plant.GetModelInstanceName(body.model_instance()).replace("::", "/")
        name = f"{scope}/{body.name()}/{own if stand_in is None else stand_in.name}"
        proximity = inspector.GetProximityProperties(geometry)
        if proximity is not None:
            own_friction = proximity.GetProperty("material", "coulomb_friction")
            friction = CoulombFriction(own_friction.static_friction(), own_friction.dynamic_friction())
            found = [(inspector.GetShape(geometry).Clone(), pose)] if stand_in is None else stand_in.shapes(pose)
            for shape, X in found:
                yield StaticShape(name, shape, X, friction=friction)
        else:  # visible, with the material of Drake's parser
            look, camera_look = (
                inspector.GetIllustrationProperties(geometry),
                inspector.GetPerceptionProperties(geometry),
            )
            yield StaticShape(
                name,
                inspector.GetShape(geometry).Clone(),
                pose,
                look=None if look is None else IllustrationProperties(look),
                camera_look=None if camera_look is None else PerceptionProperties(camera_look),
            )


def _put_stand_ins(root: etree._Element, detail: float, warnings: list[str]) -> dict[str, _StandIn]:
    """Replace planes and meshes by small spheres; return the shapes behind each, by its new name."""
    from drake_twin.description.mesh_findings import said_of_solids
    from drake_twin.description.sdf_shapes import plane_normal, plane_size, turned_to
    from drake_twin.description.solid_mesh import solid_mesh

    found: dict[str, _StandIn] = {}
    for collision in [*root.iter("collision")]:
        plane, mesh = collision.find("geometry/plane"), collision.find("geometry/mesh")
        own = collision.get("name", "")
        if plane is not None:
            stand_in = _StandIn(own, size=plane_size(plane), turn=RotationMatrix(turned_to(plane_normal(plane))))
        elif mesh is not None:
            file, scale = _mesh_and_scale(mesh)
            try:
                solids = solid_mesh(Path(file), detail / max(map(abs, scale))).solids(scale)
                warnings += said_of_solids(Path(file))
            except InputError as error:
                warnings.append(f"a collision shape is left out: {str(error).rstrip('.')}")
                solids = []
            stand_in = _StandIn(own, solids=tuple(solids))
        else:
            continue
        name = f"stand_in_{len(found)}"
        collision.set("name", name)
        for geometry in collision.findall("geometry"):
            collision.remove(geometry)
        sphere = etree.SubElement(etree.SubElement(collision, "geometry"), "sphere")
        etree.SubElement(sphere, "radius").text = "0.001"
        found[name] = stand_in
    return found


def _mesh_and_scale(mesh: etree._Element) -> tuple[str, Vector3]:
    x, y, z = (float(part) for part in (mesh.findtext("scale") or "1 1 1").split())
    return mesh.findtext("uri") or "", (x, y, z)
