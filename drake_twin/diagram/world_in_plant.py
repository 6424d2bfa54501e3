"""The world in the plant: gravity, ground, and the models of an SDF world, those that move and those that do not."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree
from pydrake.geometry import CollisionFilterDeclaration, Convex, HalfSpace, Rgba, SceneGraph, Shape
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, SpatialInertia
from pydrake.systems.framework import DiagramBuilder

from drake_twin.description.drake_log import captured_warnings, without_literal
from drake_twin.description.sdf_model import plane_normal, turned_to
from drake_twin.description.solid_mesh import solid_mesh
from drake_twin.description.world_file import WorldFile, WorldModel
from drake_twin.errors import InputError
from drake_twin.scenario import Scenario, World

_GRAVITY = (0.0, 0.0, -9.81)
_FRICTION = 1.0

# Drake 1.51 crashes where a half space and more than about 250 other shapes stand on the world body (a tree of
# bounding boxes degenerates over an infinite one). Beyond this number the others stand on a body that is welded to the
# world, where each costs 0.1 µs a step instead of nothing.
_MOST_BESIDE_A_PLANE = 100

_STATIC = "static_world"


def add_world(
    plant: MultibodyPlant,
    scene_graph: SceneGraph,
    scenario: Scenario,
    world_file: WorldFile | None,
    warnings: list[str],
) -> dict[str, ModelInstanceIndex]:
    """Adds gravity, ground and the world file's models to a plant.

    Models that do not move become shapes of the world itself, which cost nothing in a step; they have no model
    instance and no bodies.

    Args:
        plant: the plant; it is changed.
        scene_graph: its scene graph.
        scenario: its world goes before the file, and no robot may have the name of a model.
        world_file: what the world file says.
        warnings: is extended by what was left out.

    Returns:
        Model name → model instance, of the models that move.

    Raises:
        InputError: a robot has the name of a model of the world.
    """
    world = scenario.world
    models = () if world_file is None else world_file.models
    for robot in scenario.robots:
        if any(model.name == robot.name for model in models):
            raise InputError(
                f"robot {robot.name!r} has the name of a model of the world: give it another",
                file=None if world_file is None else world_file.file,
            )
    gravity = world.gravity or (_GRAVITY if world_file is None else world_file.gravity)
    plant.mutable_gravity_field().set_gravity_vector(np.array(gravity))
    shapes: list[_StaticShape] = []
    moving = {}
    if world_file is not None:
        warnings.extend(world_file.warnings)
    for model in models:
        with captured_warnings() as messages:
            try:
                if model.is_static:
                    shapes += _static_shapes(model, world, warnings)
                else:
                    _try_out(model)
                    moving[model.name] = _add_moving(plant, scene_graph, model)
            except (RuntimeError, ValueError, SystemExit) as error:
                reason = without_literal(" ".join(str(error).split())) or "it gives no reason"
                warnings.append(f"{model.name}: the model is left out: Drake refuses it ({reason.rstrip('.')})")
        warnings.extend(dict.fromkeys(f"{model.name}: {without_literal(message)}" for message in messages))
    has_plane = any(isinstance(item.shape, HalfSpace) for item in shapes)
    if world.has_own_ground and not has_plane:
        friction = _FRICTION if world.ground_friction is None else world.ground_friction
        shapes.append(
            _StaticShape("ground", HalfSpace(), RigidTransform(), friction=CoulombFriction(friction, friction))
        )
    _register(plant, shapes)
    return moving


@dataclass(frozen=True)
class _StaticShape:
    """A shape that does not move: it collides where it has friction, and is seen where it has a colour."""

    name: str
    shape: Shape
    pose: RigidTransform
    friction: CoulombFriction | None = None
    color: np.ndarray | None = None


def _register(plant: MultibodyPlant, shapes: Sequence[_StaticShape]) -> None:
    colliding = [item for item in shapes if item.friction is not None]
    planes = [item for item in colliding if isinstance(item.shape, HalfSpace)]
    body = plant.world_body()
    if planes and len(colliding) - len(planes) > _MOST_BESIDE_A_PLANE:
        instance = plant.AddModelInstance(_STATIC)
        body = plant.AddRigidBody(_STATIC, instance, SpatialInertia.SolidSphereWithMass(1.0, 1.0))
        plant.WeldFrames(plant.world_frame(), body.body_frame())
    for number, item in enumerate(shapes):
        name = f"{item.name}/{number}"  # Drake wants names that differ
        if item.friction is not None:
            on = plant.world_body() if isinstance(item.shape, HalfSpace) else body
            plant.RegisterCollisionGeometry(on, item.pose, item.shape, name, item.friction)
        elif item.color is not None:
            plant.RegisterVisualGeometry(plant.world_body(), item.pose, item.shape, name, item.color)


def _static_shapes(model: WorldModel, world: World, warnings: list[str]) -> list[_StaticShape]:
    """The shapes of a model that does not move, in the world frame.

    Drake's parser says where they are; planes and meshes, which it would take for something else, are stand-ins then.
    """
    root = etree.fromstring(model.text)
    stand_ins = _put_stand_ins(root)
    plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), time_step=0.001)
    Parser(plant).AddModelsFromString(etree.tostring(root, encoding="unicode"), "sdf")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    inspector = scene_graph.model_inspector()
    found: list[_StaticShape] = []
    for geometry in inspector.GetAllGeometryIds():
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        pose = plant.EvalBodyPoseInWorld(context, body) @ inspector.GetPoseInFrame(geometry)
        own = inspector.GetName(geometry).rpartition("::")[2]
        name = f"{model.name}/{body.name()}/{own}"
        properties = inspector.GetProximityProperties(geometry)
        if properties is not None:
            friction = properties.GetProperty("material", "coulomb_friction")
            for shape, X in stand_ins.get(own, [(None, RigidTransform())]):
                if isinstance(shape, HalfSpace):
                    if world.ground is False:
                        continue
                    mu = world.ground_friction
                    friction = friction if mu is None else CoulombFriction(mu, mu)
                found.append(_StaticShape(name, shape or inspector.GetShape(geometry), pose @ X, friction=friction))
        else:
            illustration = inspector.GetIllustrationProperties(geometry)
            if illustration is not None:
                color = illustration.GetPropertyOrDefault("phong", "diffuse", Rgba(0.7, 0.7, 0.7, 1.0))
                found.append(_StaticShape(name, inspector.GetShape(geometry), pose, color=color.rgba))
    return found


def _put_stand_ins(root: etree._Element) -> dict[str, list[tuple[Shape, RigidTransform]]]:
    """Puts small spheres in the place of planes and meshes; returns what each stands for, by its new name."""
    found: dict[str, list[tuple[Shape, RigidTransform]]] = {}
    for collision in [*root.iter("collision")]:
        geometry = collision.find("geometry")
        assert geometry is not None
        plane, mesh = geometry.find("plane"), geometry.find("mesh")
        if plane is not None:
            turned = RigidTransform(RotationMatrix(turned_to(plane_normal(plane))), np.zeros(3))
            shapes: list[tuple[Shape, RigidTransform]] = [(HalfSpace(), turned)]
        elif mesh is not None:
            solids = solid_mesh(Path(mesh.findtext("uri") or ""))
            x, y, z = (float(part) for part in (mesh.findtext("scale") or "1 1 1").split())
            shapes = [(Convex(points, "part of a mesh"), RigidTransform()) for points in solids.solids((x, y, z))]
        else:
            continue
        name = f"stand_in_{len(found)}"
        collision.set("name", name)
        for child in list(geometry):
            geometry.remove(child)
        etree.SubElement(etree.SubElement(geometry, "sphere"), "radius").text = "0.001"
        found[name] = shapes
    return found


def _try_out(model: WorldModel) -> None:
    """Parses a model in a plant of its own: what Drake refuses must not break the twin's."""
    plant = MultibodyPlant(time_step=0.001)
    Parser(plant).AddModelsFromString(model.text, "sdf")
    plant.Finalize()


def _add_moving(plant: MultibodyPlant, scene_graph: SceneGraph, model: WorldModel) -> ModelInstanceIndex:
    instances = Parser(plant).AddModelsFromString(model.text, "sdf")
    every = [
        index
        for index in map(ModelInstanceIndex, range(plant.num_model_instances()))
        if index in instances or plant.GetModelInstanceName(index).startswith(f"{model.name}::")
    ]
    for actuator in map(plant.get_joint_actuator, plant.GetJointActuatorIndices()):
        if actuator.model_instance() in every:
            plant.RemoveJointActuator(actuator)
        # (Asked for one instance, the plant lists its actuators only once it is finalized.)
    for index in every:
        plant.set_gravity_enabled(index, model.falls)
    bodies = [plant.get_body(body) for index in every for body in plant.GetBodyIndices(index)]
    own = plant.CollectRegisteredGeometries(bodies)
    scene_graph.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(own))
    return instances[0]
