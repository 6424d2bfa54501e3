"""A robot's URDF, prepared for Drake's parser, which is stricter than ROS's tools and has other extensions.

Each rule is one function on the XML tree, applied in order by `prepare_urdf`. The robot that ROS sees (names, frames,
``robot_description``) stays the one in the file.
"""

from collections.abc import Collection, Sequence
from contextlib import suppress
from copy import deepcopy
from math import isfinite, pi
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_colors import GAZEBO_COLORS
from drake_twin.description.link_surface import LinkSurface
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Pose, RobotDescription
from drake_twin.description.sdf_document import free_name, numbers_in
from drake_twin.description.used_elements import is_known, weight_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Cause, Finding, Kind, Weight, merged

if TYPE_CHECKING:
    from drake_twin.description.meshes import Primitive

# Drake takes a link called "world" for the world itself: the robot would lose its spawn pose, and a second one
# would be spawned inside the first.
_WORLD_LINK_IN_DRAKE = "robot_world"

_DRAKE_NAMESPACE = "http://drake.mit.edu"

DRAKE_RULES = ("mesh_elsewhere", "missing_mesh", "undefined_material", "joint_friction")


@dataclass(frozen=True)
class PreparedUrdf:
    """URDF text that Drake's parser accepts without warnings.

    Attributes:
        text: The URDF; its meshes have absolute addresses and its visuals their own materials.
        findings: What was mended, and what is ignored.
        meshes: The mesh files that the robot refers to.
    """

    text: str
    findings: tuple[Finding, ...]
    meshes: tuple[Path, ...]


def drake_link_name(link: str) -> str:
    """Return the name of a link's body in the Drake model."""
    return _WORLD_LINK_IN_DRAKE if link == "world" else link


def urdf_link_name(body: str) -> str:
    """Return the link of a body in the Drake model."""
    return "world" if body == _WORLD_LINK_IN_DRAKE else body


def drake_shape_names(shapes: Sequence[etree._Element]) -> list[str]:
    """Return the names of a link's visuals or collisions in the Drake model: each once, empty where Drake gives one."""
    names: list[str] = []
    for name in (shape.get("name", "").strip() for shape in shapes):
        names.append(free_name(name, names) if name else "")
    return names


def prepare_urdf(
    reader: XmlReader,
    description: RobotDescription,
    model_name: str,
    packages: PackageIndex,
    *,
    without: Collection[str] = (),
    collision: str = "hull",
) -> PreparedUrdf:
    """Convert a URDF to the one that Drake is given.

    Args:
        reader: The document, already repaired; it is not changed.
        description: The robot that it describes.
        model_name: The name of its model instance in the plant.
        packages: Resolves the addresses of meshes.
        without: Names of `DRAKE_RULES` to leave out.
        collision: What a collision mesh becomes: its convex ``hull``, or a convex ``decomposition`` of it.

    Raises:
        InputError: If a mesh has no file name, or is missing when that rule is left out.
    """
    original, reader = reader, reader.copy()
    findings: list[Finding] = []
    reader.root.set("name", model_name)
    _drop_what_drake_does_not_know(reader)
    findings += _inline_materials(reader, original, without)
    _give_friction(reader, description)  # while each shape is still where the file has it
    meshes: list[Path] = []
    findings += _resolve_meshes(reader, packages, without, collision, meshes)
    _give_mimic(reader, description)
    _drop_what_drake_warns_of(reader)
    rubbing = [joint for joint in description.movable_joints if joint.friction > 0]
    is_left_out = "joint_friction" in without
    unmodelled = [joint.name for joint in rubbing if is_left_out or joint.mimic is not None]
    if unmodelled:
        why = "without the repair joint_friction" if is_left_out else "it follows another joint, whose friction counts"
        findings.append(Finding(Kind.IGNORED, f"friction of joint {', '.join(unmodelled)}: {why}"))
    _rename_world_link(reader)
    return PreparedUrdf(
        etree.tostring(reader.root, encoding="unicode"),
        tuple(findings),
        tuple(dict.fromkeys(meshes)),
    )


def _drop_what_drake_does_not_know(reader: XmlReader) -> None:
    """Remove what Drake does not know, and ``<transmission>``: actuators come from ``<ros2_control>``."""
    for tag in ("ros2_control", "gazebo"):
        for element in reader.root.findall(tag):
            reader.root.remove(element)
    for parent in [reader.root, *reader.root.iterfind("link"), *reader.root.iterfind("joint")]:
        for child in list(parent):
            if isinstance(child.tag, str) and not is_known(parent, child):
                parent.remove(child)
    for link in reader.root.iterfind("link"):
        for tag in ("visual", "collision"):
            shapes = link.findall(tag)
            for shape, name in zip(shapes, drake_shape_names(shapes), strict=True):
                shape.set("name", name)
                if not name:
                    del shape.attrib["name"]


def _rename_world_link(reader: XmlReader) -> None:
    for element in reader.root.iterfind("link"):
        element.set("name", drake_link_name(element.get("name", "")))
    for tag in ("joint/parent", "joint/child"):
        for element in reader.root.iterfind(tag):
            element.set("link", drake_link_name(element.get("link", "")))


def _inline_materials(reader: XmlReader, original: XmlReader, without: Collection[str]) -> list[Finding]:
    """Give each visual its own material.

    Drake refuses a material that is defined twice, even with the same colour; ROS's tools use the first. Of a ``<gazebo
    reference="link">``, ``<material>Gazebo/Red</material>`` colours a link that has no colour of its own, and
    ``<visual><material>`` the visuals without a name.
    """
    colors: dict[str, str] = {}
    for material in reader.root.iter("material"):
        color = material.find("color")
        if color is not None and color.get("rgba"):
            colors.setdefault(material.get("name", ""), color.get("rgba", ""))
    defined = {material.get("name") for material in reader.root.findall("material")}
    for material in reader.root.findall("material"):
        reader.root.remove(material)
    gazebo_colors = {
        element.get("reference"): GAZEBO_COLORS.get((element.findtext("material") or "").strip().rpartition("/")[2])
        for element in original.root.iterfind("gazebo")
    }
    in_gazebo = {element.get("reference"): _diffuse(element) for element in original.root.iterfind("gazebo[visual]")}
    repairs = []
    undefined: set[str] = set()
    for index, visual in enumerate(reader.root.iterfind("link/visual")):
        link = visual.getparent()
        material = visual.find("material")
        text = gazebo_colors.get(None if link is None else link.get("name"))
        if material is not None:
            own = material.find("color")
            name = material.get("name", "")
            text = (own.get("rgba") if own is not None else colors.get(name)) or text
            for each in visual.findall("material"):
                visual.remove(each)
            if text is None and name not in undefined | defined and material.find("texture") is None:
                undefined.add(name)
                what = f"material {name!r} is not defined: its visuals keep the colours of their meshes, or grey"
                if "undefined_material" in without:
                    raise reader.error(material, f"the material {name!r} is not defined")
                place = reader.place(material)
                repairs.append(Finding.at(Kind.MENDED, what, place, "undefined_material", weight=Weight.LOOKS))
        if link is not None and not visual.get("name"):
            text = in_gazebo.get(link.get("name")) or text
        if text is not None:
            inlined = etree.SubElement(visual, "material", name=f"material_{index}")
            etree.SubElement(inlined, "color", rgba=text)
    return repairs


def _diffuse(element: etree._Element) -> str | None:
    """Return the colour that Gazebo merges into a link's visuals; None without a valid one."""
    text = element.findtext("visual/material/diffuse") or element.findtext("visual/material/ambient")
    parts = [part for part in numbers_in(text) if part is not None and isfinite(part)]
    clamped = [min(max(part, 0.0), 1.0) for part in (*parts, 1.0)[:4]]
    return " ".join(f"{part:g}" for part in clamped) if len(parts) in (3, 4) else None


def _resolve_meshes(
    reader: XmlReader, packages: PackageIndex, without: Collection[str], collision: str, meshes: list[Path]
) -> list[Finding]:
    """Convert each mesh to a form that Drake reads.

    A shape whose mesh is missing or broken is left out, as in RViz and Gazebo: the robot still runs. An absolute path
    of another machine is searched in the packages that its folders are named after.
    """
    shapes = [*reader.root.iterfind("link/visual"), *reader.root.iterfind("link/collision")]
    if not any(shape.find("geometry/mesh") is not None for shape in shapes):
        return []
    from drake_twin.description.mesh_findings import said_of_hull, said_of_hulls, said_of_visual
    from drake_twin.description.meshes import mesh_address, visual_mesh

    findings: list[Finding] = []
    colliding: dict[Path, None] = {}

    def mended(what: str, mesh: etree._Element, rule: str) -> None:
        findings.append(Finding.at(Kind.MENDED, what, reader.place(mesh), rule, weight=weight_of(mesh)))

    for shape in shapes:
        for mesh in shape.findall("geometry/mesh"):
            address = reader.text(mesh, "filename")
            try:
                file, elsewhere = _find_mesh(address, packages, reader.file, "mesh_elsewhere" not in without)
                if elsewhere:
                    what = f"mesh {address!r} is not on this machine: {file} is used"
                    mended(what, mesh, "mesh_elsewhere")
                place = reader.place(mesh)
                if shape.tag == "visual":
                    mesh.set("filename", mesh_address(visual_mesh(file)))
                    said = said_of_visual(file)
                else:
                    _give_collision_shape(reader, shape, mesh, file, collision)
                    said = said_of_hull(file)
                    colliding[file] = None
                findings += [
                    Finding.at(Kind.WARNING, what, place, weight=weight_of(mesh), cause=Cause.MESH) for what in said
                ]
                meshes.append(file)
            except InputError as error:
                if "missing_mesh" in without:
                    raise reader.error(mesh, str(error)) from None
                link = shape.getparent()
                if link is not None:
                    what = f"the {shape.tag} mesh of link {link.get('name')!r} is left out: {str(error).rstrip('.')}"
                    mended(what, mesh, "missing_mesh")
                    link.remove(shape)
    findings += [
        Finding(Kind.WARNING, what, weight=Weight.LOOKS, cause=Cause.MESH) for what in said_of_hulls(colliding)
    ]
    return [*merged(findings)]


def _find_mesh(address: str, packages: PackageIndex, near: Path | None, look_elsewhere: bool) -> tuple[Path, bool]:
    try:
        return packages.resolve(address, near), False
    except InputError:
        if look_elsewhere:
            with suppress(InputError):
                return packages.resolve_elsewhere(address, near), True
        raise


def _give_collision_shape(
    reader: XmlReader, shape: etree._Element, mesh: etree._Element, file: Path, collision: str
) -> None:
    from drake_twin.description.meshes import collision_mesh, collision_pieces, mesh_address, mesh_primitive

    pieces = collision_pieces(file) if collision == "decomposition" else ()
    primitive = mesh_primitive(file, reader.vector3(mesh, "scale", (1.0, 1.0, 1.0)))
    link = shape.getparent()
    if primitive is not None and len(pieces) <= 1:  # an open bin is several pieces, though its hull is a box
        _replace_by_primitive(reader, shape, mesh, primitive)
    elif pieces and link is not None:
        for piece in pieces:
            copy = deepcopy(shape)
            copy.attrib.pop("name", "")
            for copied in copy.iterfind("geometry/mesh"):
                copied.set("filename", mesh_address(piece))
            link.append(copy)
        link.remove(shape)
    else:
        mesh.set("filename", mesh_address(collision_mesh(file)))


def _replace_by_primitive(
    reader: XmlReader, shape: etree._Element, mesh: etree._Element, primitive: "Primitive"
) -> None:
    import numpy as np
    from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

    geometry = mesh.getparent()
    assert geometry is not None
    geometry.remove(mesh)
    if primitive.kind == "box":
        etree.SubElement(geometry, "box", size=" ".join(f"{side:.17g}" for side in primitive.size))
    elif primitive.kind == "sphere":
        etree.SubElement(geometry, "sphere", radius=f"{primitive.size[0]:.17g}")
    else:
        radius, length = primitive.size
        etree.SubElement(geometry, "cylinder", radius=f"{radius:.17g}", length=f"{length:.17g}")
    origin, zero = shape.find("origin"), (0.0, 0.0, 0.0)
    if origin is None:
        origin = etree.SubElement(shape, "origin")
    X = Pose(reader.vector3(origin, "xyz", zero), reader.vector3(origin, "rpy", zero)).transform()
    # URDF's cylinders are along z: turn z to the mesh's axis first, then turn with the shape.
    along = RollPitchYaw(*((0.0, pi / 2, 0.0), (-pi / 2, 0.0, 0.0), zero)[primitive.axis])
    moved = Pose.of(RigidTransform(X.rotation() @ RotationMatrix(along), X @ np.array(primitive.center)))
    origin.set("xyz", " ".join(f"{value:.17g}" for value in moved.xyz))
    origin.set("rpy", " ".join(f"{value:.17g}" for value in moved.rpy))


def _give_friction(reader: XmlReader, description: RobotDescription) -> None:
    """Apply the frictions of surfaces: Drake has one coefficient a shape, the smaller of the two directions'."""
    for link in reader.root.iterfind("link"):
        frictions = description.surfaces.get(link.get("name", ""), LinkSurface()).frictions
        for collision, friction in zip(link.findall("collision"), frictions, strict=False):
            if friction is None:
                continue
            properties = etree.SubElement(
                collision, f"{{{_DRAKE_NAMESPACE}}}proximity_properties", nsmap={"drake": _DRAKE_NAMESPACE}
            )
            for name in ("mu_dynamic", "mu_static"):
                value = f"{max(0.0, min(friction.mu, friction.mu2)):.17g}"
                etree.SubElement(properties, f"{{{_DRAKE_NAMESPACE}}}{name}", value=value)


def _give_mimic(reader: XmlReader, description: RobotDescription) -> None:
    """Add ``<mimic>`` to a follower that only ``<ros2_control>`` declares, so that Drake couples it too."""
    for joint in reader.root.iterfind("joint"):
        mimic = description.joints_by_name[reader.text(joint, "name")].mimic
        if mimic is not None and joint.find("mimic") is None:
            multiplier, offset = f"{mimic.multiplier:.17g}", f"{mimic.offset:.17g}"
            etree.SubElement(joint, "mimic", joint=mimic.joint, multiplier=multiplier, offset=offset)


def _drop_what_drake_warns_of(reader: XmlReader) -> None:
    """Remove dry friction in joints, which the plant models with an actuator of its own, and negative bounds.

    Also the ``type`` of links, an attribute that `unread_in_urdf` reports.
    """
    for link in reader.root.iterfind("link"):
        link.attrib.pop("type", "")
    for dynamics in reader.root.iterfind("joint/dynamics"):
        dynamics.attrib.pop("friction", "")
    for limit in reader.root.iterfind("joint/limit"):
        for name in ("effort", "velocity"):
            if limit.get(name, "0").strip().startswith("-"):  # stands for "no bound"; Drake warns of it
                del limit.attrib[name]
