"""The world as a tree: robots with their links, joints and sensors, the models of the world, its lights."""

from collections.abc import Iterator
from dataclasses import replace

from pydrake.geometry import Role
from pydrake.multibody.tree import ModelInstanceIndex

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name, urdf_link_name
from drake_twin.description.robot_description import Sensor
from drake_twin.description.world_file import WorldModel
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.shared_viewer.shared_scene import WORLD, body_path, scene_graph_of
from drake_twin.twin.twin import Twin

ROBOT, LINK, JOINT, SENSOR, MODEL, LIGHT, GROUND = "robot", "link", "joint", "sensor", "model", "light", "ground"


@dataclass(frozen=True)
class Node:
    """A thing in the world.

    Attributes:
        kind: ``robot``, ``link``, ``joint``, ``sensor``, ``model``, ``light`` or ``ground``.
        owner: The robot or model that it belongs to; itself for those.
        name: Its name in its owner.
        paths: The paths of the scene, below the twin's folder, at which it is drawn.
        children: What belongs to it.
    """

    kind: str
    owner: str
    name: str
    paths: tuple[str, ...] = ()
    children: tuple["Node", ...] = ()

    @property
    def id(self) -> str:
        """A name that no other thing has."""
        return f"{self.kind}:{self.owner}::{self.name}"

    @property
    def entity(self) -> str:
        """The name of a robot, model or link in methods of the twin."""
        return f"{self.owner}::{self.name}" if self.kind == LINK else self.owner

    def as_plain(self) -> dict[str, object]:
        """Return the node and what is below it as plain data."""
        return {
            "id": self.id,
            "kind": self.kind,
            "name": self.name,
            "entity": self.entity,
            "paths": list(self.paths),
            "children": [child.as_plain() for child in self.children],
        }


def world_tree(twin: Twin) -> tuple[Node, ...]:
    """Return a twin's world: robots, models of the world, lights, in this order."""
    models = () if twin.built.world_file is None else twin.built.world_file.models
    lights = () if twin.built.world_file is None else twin.built.world_file.surroundings.lights
    nodes = [_robot(plan) for plan in twin.built.plans]
    nodes += [_static_model(twin, model) if model.is_static else _moving_model(twin, model) for model in models]
    if twin.scenario.world.has_own_ground:
        nodes.append(Node(GROUND, WORLD, "ground", (f"{WORLD}/ground",)))
    nodes += [Node(LIGHT, WORLD, f"{light.kind} {number}") for number, light in enumerate(lights, start=1)]
    return tuple(nodes)


def every_node(nodes: tuple[Node, ...]) -> Iterator[Node]:
    """Yield nodes and all that is below them."""
    for node in nodes:
        yield node
        yield from every_node(node.children)


def instances_of(twin: Twin, owner: str) -> list[ModelInstanceIndex]:
    """Return the model instances of a robot, or of a moving model with the models in it."""
    plant = twin.plant
    indices = map(ModelInstanceIndex, range(plant.num_model_instances()))
    names = {index: plant.GetModelInstanceName(index) for index in indices}
    return [index for index, name in names.items() if name == owner or name.startswith(f"{owner}::")]


def place_of(sensor: Sensor) -> str:
    """Return a sensor's name below its robot or model, which no other has."""
    return f"{sensor.link or sensor.joint}/{sensor.name}"


def _folder(instance: str) -> str:
    return body_path(f"{instance}::").rpartition("/")[0]


def _robot(plan: RobotPlan) -> Node:
    robot, name = plan.description, plan.name
    links = {link: Node(LINK, name, link, (body_path(f"{name}::{drake_link_name(link)}"),)) for link in robot.links}
    sensors: dict[str, list[Node]] = {}
    for sensor in robot.sensors:
        joint = robot.joints_by_name.get(sensor.joint)
        link = sensor.link or (joint.child if joint else robot.root_link)
        paths = links[link].paths if link in links else ()
        sensors.setdefault(link, []).append(Node(SENSOR, name, place_of(sensor), paths))

    def with_children(link: str) -> Node:
        joints = [joint for joint in robot.joints if joint.parent == link and joint.child in links]
        below = [Node(JOINT, name, each.name, links[each.child].paths, (with_children(each.child),)) for each in joints]
        return replace(links[link], children=(*sensors.get(link, ()), *below))

    return Node(ROBOT, name, name, (_folder(name),), (with_children(robot.root_link),))


def _moving_model(twin: Twin, model: WorldModel) -> Node:
    plant, instances = twin.plant, instances_of(twin, model.name)
    folders = tuple(_folder(plant.GetModelInstanceName(instance)) for instance in instances)
    bodies = [plant.get_body(index) for instance in instances for index in plant.GetBodyIndices(instance)]
    links = [
        Node(LINK, model.name, urdf_link_name(body.name()), (body_path(body.scoped_name().get_full()),))
        for body in bodies
    ]
    return Node(MODEL, model.name, model.name, folders, (*links, *_sensors(twin, model, folders)))


def _static_model(twin: Twin, model: WorldModel) -> Node:
    """Return a static model, whose shapes are the world's."""
    inspector = scene_graph_of(twin).model_inspector()
    world = inspector.world_frame_id()
    names = [
        inspector.GetName(geometry).rpartition("::")[2]
        for geometry in inspector.GetGeometries(world, Role.kIllustration)
    ]
    own = [name for name in names if name.startswith(f"{model.name}/")]
    paths = tuple(f"{WORLD}/{name.replace('/', '_')}" for name in own)
    return Node(MODEL, model.name, model.name, paths, tuple(_sensors(twin, model, paths)))


def _sensors(twin: Twin, model: WorldModel, paths: tuple[str, ...]) -> Iterator[Node]:
    """Yield the sensors of a model of the world, and of the models in it."""
    for owner, plan in twin.entities.sensors:
        if owner == model.name or owner.startswith(f"{model.name}::"):
            yield Node(SENSOR, owner, plan.place, paths)
