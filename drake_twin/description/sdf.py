"""SDF robots, prepared for Drake's parser."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.sdf_addresses import SdfAddresses
from drake_twin.description.sdf_model import mend_model
from drake_twin.description.sdf_nested import flatten_models
from drake_twin.description.sdf_shapes import lay_slabs
from drake_twin.description.sdf_unknown_frames import forget_unknown_frames
from drake_twin.description.used_elements import weight_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, Place
from drake_twin.values import is_true


class PreparedSdf(NamedTuple):
    """SDF text of one model as Drake is given it.

    Attributes:
        text: The text, without the model's own weld to the world.
        is_fixed: Whether the model was welded to the world, or ``<static>``.
        own_name: The model's name in the file.
        findings: What was changed or left out.
    """

    text: str
    is_fixed: bool
    own_name: str
    findings: tuple[Finding, ...] = ()


def read_robot_sdf(text: str, file: Path) -> tuple[XmlReader, list[Finding]]:
    """Read an SDF file of a robot, with the models inside it as parts of its one model.

    Raises:
        InputError: If the file is not an SDF file with one model.
    """
    reader = XmlReader(text, file)
    models = reader.root.findall("model")
    if reader.root.tag != "sdf" or len(models) != 1:
        what = "a world" if reader.root.find("world") is not None else f"{len(models)} models"
        raise reader.error(reader.root, f"a robot is an SDF file with one <model>, but this holds {what}")
    findings = list(flatten_models(models[0], reader))
    for pose, what in forget_unknown_frames(models[0]):
        findings.append(Finding.at(Kind.WARNING, what, reader.place(pose), weight=weight_of(pose)))
    return reader, findings


def prepare_sdf(reader: XmlReader, model_name: str | None, packages: PackageIndex) -> PreparedSdf:
    """Convert a robot's model to the one that Drake is given, with the twin's name and meshes that Drake reads.

    Raises:
        InputError: If a value is invalid.
    """
    reader = reader.copy()
    file = reader.file
    (model,) = reader.root.findall("model")
    own_name = reader.text(model, "name")
    model.set("name", model_name or own_name)
    for plugin in model.findall("plugin"):
        model.remove(plugin)
    is_fixed = False
    for static in model.findall("static"):
        is_fixed = is_fixed or is_true(static.text)
        model.remove(static)
    if is_fixed:
        _weld(model, _roots(model))  # none of its links moves
        lay_slabs(model)
    held: list[str] = []
    for joint in model.findall("joint"):
        parent = joint.find("parent")
        if parent is None or (parent.text or "").strip() != "world":
            continue
        if joint.get("type") == "fixed":
            held.append((joint.findtext("child") or "").strip())
            model.remove(joint)
        else:
            parent.text = _world_link(model)
            held.insert(0, parent.text)
    held = list(dict.fromkeys(held))
    if held and not is_fixed:
        if len(_roots(model)) > 1:
            _weld(model, held)
            _put_first(model, held[0])
        is_fixed = True
    for sensor in [*model.iter("sensor")]:  # they are read separately
        parent = sensor.getparent()
        assert parent is not None
        parent.remove(sensor)
    findings: list[Finding] = []
    addresses = SdfAddresses(packages)
    mended = mend_model(model, reader, addresses.find)
    findings += [finding for finding in mended if finding.kind is not Kind.IGNORED]  # `unread` reports those with lines
    for name, error in addresses.missing.items():
        what = f"the meshes of {name} are left out: it was not found. Searched: {error.searched}. {error.advice}"
        findings.append(Finding(Kind.WARNING, what, file=str(file)))
    text = etree.tostring(reader.root, encoding="unicode")
    return PreparedSdf(text, is_fixed, own_name, tuple(findings))


def joint_frictions(reader: XmlReader, model: etree._Element) -> Iterator[tuple[str, float, Place]]:
    """Yield each joint of a model with dry friction: its name, the friction (N·m or N) and its place.

    Raises:
        InputError: If a friction is not a number, or is negative.
    """
    for joint in model.iterfind("joint"):
        for element in joint.iterfind(".//dynamics/friction"):
            friction = reader.parse_number(element, (element.text or "").strip(), "it")
            if friction < 0:
                raise reader.error(element, f"it is {friction:g}, and must not be negative")
            if friction > 0:
                yield joint.get("name", ""), friction, reader.place(element)


def _roots(model: etree._Element) -> list[str]:
    """Return the links that no joint holds."""
    children = {(joint.findtext("child") or "").strip() for joint in model.findall("joint")}
    return [name for link in model.findall("link") if (name := link.get("name", "")) not in children]


def _world_link(model: etree._Element) -> str:
    """Return the link that stands for the world in a model's movable joints to it, as a URDF's ``world``; add it."""
    name = drake_link_name("world")
    if all(link.get("name") != name for link in model.findall("link")):
        link = etree.Element("link", name=name)
        model.insert(0, link)
    return name


def _weld(model: etree._Element, links: Sequence[str]) -> None:
    """Weld links to the first of them."""
    for name in links[1:]:
        joint = etree.SubElement(model, "joint", name=f"{name}_to_{links[0]}", type="fixed")
        etree.SubElement(joint, "parent").text = links[0]
        etree.SubElement(joint, "child").text = name


def _put_first(model: etree._Element, link: str) -> None:
    """Make a link the model's first one, which is the base of a robot with several trees of links."""
    every = model.findall("link")
    first = next((each for each in every if each.get("name") == link), every[0])
    if first is not every[0]:
        every[0].addprevious(first)
