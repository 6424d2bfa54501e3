"""The names that Gazebo gives the collision shapes of a link, with those of the links that it folds into it."""

from collections.abc import Iterator

from lxml import etree
from pydrake.geometry import GeometryId, Role, SceneGraphInspector
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex

from drake_twin.description.drake_urdf import drake_link_name, drake_shape_names
from drake_twin.description.fixed_joint_lumping import gazebo_collisions
from drake_twin.description.robot_description import RobotDescription


def collision_names(description: RobotDescription, link: str) -> dict[tuple[str, int], str]:
    """Return link and index of each collision shape that a link has in Gazebo → its name there.

    An SDF's names are kept.
    """
    root = etree.fromstring(description.text.encode())
    if root.tag != "robot":
        collisions = root.iterfind(f"model/link[@name='{link}']/collision")
        return {(link, index): item.get("name", "") for index, item in enumerate(collisions)}
    return {place: shape.name for place, shape in gazebo_collisions(root).items() if shape.link == link}


def static_geometries(
    description: RobotDescription, links: list[str], inspector: SceneGraphInspector
) -> Iterator[tuple[GeometryId, tuple[str, int]]]:
    """Yield the geometries of some links of a static model, as `collision_geometries` does."""
    root = etree.fromstring(description.text.encode())
    places = {
        f"{description.name.replace('::', '/')}/{link}/{item.get('name', '')}": (link, index)
        for link in links
        for index, item in enumerate(root.iterfind(f"model/link[@name='{link}']/collision"))
    }
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        place = places.get(static_shape_name(inspector, geometry))
        if place is not None:
            yield geometry, place


def static_shape_name(inspector: SceneGraphInspector, geometry: GeometryId) -> str:
    """Return the name ``MODEL/LINK/SHAPE`` of a shape of a static model; see `drake_twin.diagram.static_world`."""
    name = str(inspector.GetName(geometry))
    return name.rpartition("::")[2].partition("|")[0].rpartition("/")[0]


def collision_geometries(
    description: RobotDescription,
    links: list[str],
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    inspector: SceneGraphInspector,
) -> Iterator[tuple[GeometryId, tuple[str, int]]]:
    """Yield the geometries of some links, with link and index of the collision shape that each one is of."""
    root = etree.fromstring(description.text.encode())
    for link in links:
        elements = root.findall(f"{'link' if root.tag == 'robot' else 'model/link'}[@name='{link}']/collision")
        names = drake_shape_names(elements)
        named = {name: index for index, name in enumerate(names) if name}
        unnamed = [index for index, name in enumerate(names) if not name]
        known: dict[str, int] = {}
        body = plant.GetBodyByName(drake_link_name(link), instance)
        for geometry in inspector.GetGeometries(plant.GetBodyFrameIdOrThrow(BodyIndex(body.index())), Role.kProximity):
            name = inspector.GetName(geometry).rpartition("::")[2].partition("|")[0]
            if name not in known:
                known[name] = named[name] if name in named else unnamed.pop(0) if len(unnamed) > 1 else -1
                if known[name] < 0:
                    known[name] = unnamed[0] if unnamed else 0
            yield geometry, (link, known[name])
