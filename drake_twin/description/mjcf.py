"""MJCF robots (MuJoCo's XML), prepared for Drake's parser."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from drake_twin.description.mesh_findings import said_of_mjcf_mesh
from drake_twin.description.meshes import mesh_for_mjcf
from drake_twin.description.mjcf_actuators import MjcfActuators
from drake_twin.description.mjcf_includes import included
from drake_twin.description.mjcf_names import unknown_mjcf_names
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places

# The link under a robot without a free joint, which the twin fixes where the robot is spawned.
_BASE = "robot_world"


class PreparedMjcf(NamedTuple):
    """An MJCF robot as Drake is given it.

    Attributes:
        text: The text.
        is_fixed: Whether the robot is fixed to the world.
        own_name: Its name in the file.
        actuators: Its actuators, and what belongs to them of its joints.
        findings: What of the file is ignored.
    """

    text: str
    is_fixed: bool
    own_name: str
    actuators: MjcfActuators
    findings: tuple[Finding, ...]


def prepare_mjcf(text: str, file: Path, model_name: str | None) -> PreparedMjcf:
    """Convert the MJCF text of one robot to the one that Drake is given.

    MuJoCo's actuators become command and state interfaces of their joints (`MjcfActuators`), so that the twin's
    controllers command them. Shapes that belong to the world (a floor) are left out: the twin has a world of its own.

    Raises:
        InputError: If the file is not an MJCF file with one robot.
    """
    reader = XmlReader(text, file)
    if reader.root.tag == "mujoco":
        reader = included(reader, file)
    root = reader.root
    world = root.find("worldbody")
    if root.tag != "mujoco" or world is None:
        raise reader.error(root, "an MJCF robot has a <worldbody>")
    own_name = root.get("model") or file.stem
    root.set("model", model_name or own_name)
    bodies = world.findall("body")
    if not bodies:
        raise reader.error(world, "it has no <body>")
    findings = [*unknown_mjcf_names(reader), *_ignored(reader, world)]
    for child in list(world):
        if child.tag != "body":
            world.remove(child)
    free = [body for body in bodies if body.find("freejoint") is not None or _has_free_joint(body)]
    is_fixed = not free
    if free and len(bodies) > 1:
        raise reader.error(bodies[1], "a robot is one tree of bodies, but there are several, and one of them is free")
    if is_fixed:
        base = etree.SubElement(world, "body", name=_BASE)
        etree.SubElement(base, "freejoint")
        base.extend(bodies)
    actuators = MjcfActuators(reader)
    _without_what_the_twin_reads(root)
    findings += _give_mesh_files(reader, file)
    findings += actuators.findings
    return PreparedMjcf(etree.tostring(root, encoding="unicode"), is_fixed, own_name, actuators, tuple(findings))


def _ignored(reader: XmlReader, world: etree._Element) -> Iterator[Finding]:
    """Report what belongs to the world, and what the twin does not support."""
    dropped = [(child, f"<{child.tag}> of the world") for child in world if child.tag not in ("body", "light")]
    for tag in ("sensor", "keyframe", "size"):
        dropped += [(item, f"<{item.tag}> of <{tag}>") for group in reader.root.findall(tag) for item in group]
    for path in ("worldbody/body//replicate", "asset/model"):  # of which Drake's parser says nothing
        dropped += [(item, f"<{item.tag}>") for item in reader.root.iterfind(path)]
    return at_places(Kind.IGNORED, ((what, reader.place(element)) for element, what in dropped))


def _has_free_joint(body: etree._Element) -> bool:
    return any(joint.get("type") == "free" for joint in body.findall("joint"))


def _without_what_the_twin_reads(root: etree._Element) -> None:
    """Leave out what Drake's parser ignores, and what is the twin's own: else Drake says that it is lost."""
    for tag in ("actuator", "sensor", "keyframe", "visual", "size", "statistic"):
        for element in root.findall(tag):
            root.remove(element)
    for joint in root.iter("joint"):
        for name in ("frictionloss", "stiffness", "springref", "springdamper", "armature", "ref"):
            joint.attrib.pop(name, "")


def _give_mesh_files(reader: XmlReader, file: Path) -> Iterator[Finding]:
    """Convert the meshes to files that Drake reads, and report what is otherwise in them."""
    compiler = reader.root.find("compiler")
    folder = file.parent / (compiler.get("meshdir", "") if compiler is not None else "")
    for mesh in reader.root.iterfind("asset/mesh"):
        name = mesh.get("file")
        if name is not None:
            mesh.set("name", mesh.get("name") or Path(name).stem)
            mesh.set("file", str(mesh_for_mjcf(folder / name)))
            for what in said_of_mjcf_mesh(folder / name):
                yield Finding.at(Kind.WARNING, what, reader.place(mesh))
    if compiler is not None:
        compiler.attrib.pop("meshdir", "")
