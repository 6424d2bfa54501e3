"""A robot's URDF made ready for Drake's parser, which is stricter than ROS's tools and knows other extensions.

Each rule is one function on the XML tree, applied in order by `prepare_urdf`; what a rule gives up is returned as a
warning. The robot that ROS sees (names, frames, ``robot_description``) stays the one in the file.
"""

from lxml import etree

from drake_twin.description.meshes import mesh_address, mesh_for_drake
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import LinkSurface, RobotDescription
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

# Drake takes a link called "world" for the world itself: the robot would lose its spawn pose, and a second one
# would stand inside the first.
_WORLD_LINK_IN_DRAKE = "robot_world"

_DRAKE_NAMESPACE = "http://drake.mit.edu"


def drake_link_name(link: str) -> str:
    """The name of a link's body in the Drake model."""
    return _WORLD_LINK_IN_DRAKE if link == "world" else link


def prepare_urdf(
    description: RobotDescription, model_name: str, packages: PackageIndex, *, lines_are_the_files: bool = True
) -> tuple[str, list[str]]:
    """The URDF that Drake is given.

    Args:
        description: the robot, with its expanded text.
        model_name: the name of its model instance in the plant.
        packages: resolves the addresses of meshes.
        lines_are_the_files: false for text that xacro made.

    Returns:
        URDF text without mesh addresses to resolve, materials to look up or transmissions, and the warnings.

    Raises:
        InputError: a mesh without a file name.
    """
    reader = XmlReader(description.text, description.file, lines_are_the_files=lines_are_the_files)
    warnings: list[str] = []
    reader.root.set("name", model_name)
    _drop_what_drake_must_not_act_on(reader)
    _inline_materials(reader, warnings)
    _resolve_meshes(reader, packages, warnings)
    _give_friction(reader, description)
    _give_mimic(reader, description)
    _drop_joint_friction(reader, warnings)
    _rename_world_link(reader)
    return etree.tostring(reader.root, encoding="unicode"), warnings


def _drop_what_drake_must_not_act_on(reader: XmlReader) -> None:
    """Actuators come from ``<ros2_control>``; Drake would make others from ``<transmission>``."""
    for tag in ("ros2_control", "gazebo", "transmission"):
        for element in reader.root.findall(tag):
            reader.root.remove(element)


def _rename_world_link(reader: XmlReader) -> None:
    for element in reader.root.iterfind("link"):
        element.set("name", drake_link_name(element.get("name", "")))
    for tag in ("joint/parent", "joint/child"):
        for element in reader.root.iterfind(tag):
            element.set("link", drake_link_name(element.get("link", "")))


def _inline_materials(reader: XmlReader, warnings: list[str]) -> None:
    """Drake refuses a material that is defined twice, even with the same colour; ROS's tools take the first."""
    colors: dict[str, str] = {}
    for material in reader.root.iter("material"):
        color = material.find("color")
        if color is not None and color.get("rgba"):
            colors.setdefault(material.get("name", ""), color.get("rgba", ""))
    for material in reader.root.findall("material"):
        reader.root.remove(material)
    for index, visual in enumerate(reader.root.iterfind("link/visual")):
        material = visual.find("material")
        if material is None:
            continue
        own = material.find("color")
        name = material.get("name", "")
        color_text = own.get("rgba") if own is not None else colors.get(name)
        visual.remove(material)
        if color_text is None:
            warnings.append(f"material {name!r} is not defined; the visual keeps its own colours")
            continue
        inlined = etree.SubElement(visual, "material", name=f"material_{index}")
        etree.SubElement(inlined, "color", rgba=color_text)


def _resolve_meshes(reader: XmlReader, packages: PackageIndex, warnings: list[str]) -> None:
    """A shape whose mesh is missing or broken is left out, as in RViz and Gazebo: the robot still runs."""
    for shape in [*reader.root.iterfind("link/visual"), *reader.root.iterfind("link/collision")]:
        for mesh in shape.iterfind("geometry/mesh"):
            address = reader.text(mesh, "filename")
            try:
                mesh.set("filename", mesh_address(mesh_for_drake(packages.resolve(address, reader.file))))
            except InputError as error:
                link = shape.getparent()
                warnings.append(f"link {link.get('name')!r} goes without its {shape.tag} mesh: {error}")
                link.remove(shape)


def _give_friction(reader: XmlReader, description: RobotDescription) -> None:
    """``<gazebo reference="link"><mu1>``: Drake has one coefficient a shape, so the smaller of mu1 and mu2 counts."""
    for link in reader.root.iterfind("link"):
        surface = description.surfaces.get(link.get("name", ""), LinkSurface())
        coefficients = [mu for mu in (surface.mu1, surface.mu2) if mu is not None]
        if not coefficients:
            continue
        friction = f"{max(0.0, min(coefficients)):.17g}"
        for collision in link.iterfind("collision"):
            properties = etree.SubElement(
                collision, f"{{{_DRAKE_NAMESPACE}}}proximity_properties", nsmap={"drake": _DRAKE_NAMESPACE}
            )
            for name in ("mu_dynamic", "mu_static"):
                etree.SubElement(properties, f"{{{_DRAKE_NAMESPACE}}}{name}", value=friction)


def _give_mimic(reader: XmlReader, description: RobotDescription) -> None:
    """A follower that only ``<ros2_control>`` declares becomes one that Drake couples too."""
    for joint in reader.root.iterfind("joint"):
        mimic = description.joints_by_name[reader.text(joint, "name")].mimic
        if mimic is not None and joint.find("mimic") is None:
            multiplier, offset = f"{mimic.multiplier:.17g}", f"{mimic.offset:.17g}"
            etree.SubElement(joint, "mimic", joint=mimic.joint, multiplier=multiplier, offset=offset)


def _drop_joint_friction(reader: XmlReader, warnings: list[str]) -> None:
    """Drake has no dry friction in joints."""
    joints = [
        joint.get("name", "")
        for joint in reader.root.iterfind("joint")
        if any(float(dynamics.attrib.pop("friction", "0")) != 0.0 for dynamics in joint.iterfind("dynamics"))
    ]
    if joints:
        warnings.append(f"joint friction is not simulated (joints {', '.join(joints)})")
