"""The elements and attributes of a URDF or SDF file that the twin ignores: all that `used_elements` does not list."""

from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from lxml import etree

from drake_twin.description.flags import wrong_flags
from drake_twin.description.gazebo_drives import is_drive, known_libraries
from drake_twin.description.gazebo_plugins import DONE_HERE, plugin_kind
from drake_twin.description.plugin_names import misspelt_plugin
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.sdf_defaults import asks_for_nothing
from drake_twin.description.sensors import SENSOR_PLUGINS
from drake_twin.description.used_elements import (
    DRAKE,
    NO_EFFECT_IN_WORLDS,
    ROS2_CONTROL,
    SDF_LIGHT,
    SDF_MODEL,
    SDF_PHYSICS,
    SDF_SPHERICAL,
    SDF_WIND,
    SEVERAL,
    URDF,
    Part,
    weight_of,
)
from drake_twin.description.world_plugins import is_world_plugin
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import did_you_mean
from drake_twin.findings import Cause, Finding, Kind, merged

_Unread: TypeAlias = tuple[etree._Element, str, str]  # what is not read, its name, and where it stands or why

_PLUGINS = {
    **dict.fromkeys(("camera", "depth", "ray", "laser", "range"), "the twin simulates no such sensor"),
    "wind": "the wind is that of the world, where gz-sim's WindEffects can let it change",
    "battery": "the twin has no batteries",
}


def unread_in_urdf(reader: XmlReader) -> list[Finding]:
    """Report each element and attribute of a URDF that is ignored, once with all its lines."""
    return list(_findings(reader, (*_unread(reader.root, URDF), *_about_nothing(reader.root))))


def _about_nothing(root: etree._Element) -> Iterator[_Unread]:
    """Yield each ``<gazebo reference>`` to a link or joint that the robot does not have."""
    known = {item.get("name", "").strip() for tag in ("link", "joint") for item in root.iterfind(tag)}
    for element in root.iterfind("gazebo[@reference]"):
        reference = element.get("reference", "").strip()
        if reference and reference not in known and len(element):
            yield element, f"<gazebo reference={reference!r}>", ": the robot has no such link or joint"


def unread_in_sdf(reader: XmlReader) -> tuple[Finding, ...]:
    """Report each element and attribute of an SDF file with one model that is ignored."""
    model = reader.root.find("model")
    return () if model is None else tuple(_findings(reader, _unread(model, SDF_MODEL)))


def unread_in_world_model(model: etree._Element) -> Iterator[Finding]:
    """Report the elements and attributes of a world's model, and of those inside it, that are not SDF's.

    What SDF knows and the twin does not use there has no finding of this kind: `drake_twin.description.sdf_model`
    reports what affects the motion.
    """
    from drake_twin.description.sdf_document import number_in
    from drake_twin.description.sdf_model import KEPT

    for each in model.iter("model"):
        for element, thing, common in _unread(each, SDF_MODEL):
            above = element.getparent()
            is_reported = above is not None and above.tag in KEPT and not _is_attribute(thing)
            if not (is_reported or _has_no_effect(element, thing)):
                yield Finding(Kind.IGNORED, thing + common, weight=weight_of(element), cause=Cause.UNREAD)
    for friction in model.iterfind(".//joint//dynamics/friction"):
        if number_in(friction) != 0.0:
            joint = next(friction.iterancestors("joint")).get("name", "")
            yield Finding(Kind.IGNORED, f"friction of joint {joint}: only those of robots have it")


def unread_in_world(reader: XmlReader, world: etree._Element) -> list[Finding]:
    """Report what of a world is not SDF: flags, numbers, elements of its lights, physics, wind and place on Earth."""
    from drake_twin.description.sdf_values import wrong_numbers

    parts = {"light": SDF_LIGHT, "physics": SDF_PHYSICS, "spherical_coordinates": SDF_SPHERICAL, "wind": SDF_WIND}
    found = ((element, part) for tag, part in parts.items() for element in world.iterfind(tag))
    unread = (each for element, part in found for each in _unread(element, part))
    names = _findings(reader, (each for each in unread if not _has_no_effect(each[0], each[1])))
    plugins = [(item, GazeboPlugin(item.get("filename", ""), item.get("name", ""))) for item in world.iter("plugin")]
    misspelt = ((item, why, "") for item, plugin in plugins if (why := misspelt_plugin(plugin)))
    return [*names, *_findings(reader, misspelt), *wrong_flags(reader, world), *wrong_numbers(reader, world)]


def _has_no_effect(element: etree._Element, thing: str) -> bool:
    return not _is_attribute(thing) and (element.tag in NO_EFFECT_IN_WORLDS or thing.startswith("a second"))


def _is_attribute(thing: str) -> bool:
    return thing.startswith("the attribute")


def _findings(reader: XmlReader, unread: Iterable[_Unread]) -> Iterator[Finding]:
    return merged(
        Finding.at(
            Kind.IGNORED,
            thing + common,
            reader.place(element),
            weight=weight_of(element),
            common=common,
            cause=Cause.UNREAD,
        )
        for element, thing, common in unread
    )


def _unread(element: etree._Element, part: Part) -> Iterator[_Unread]:
    tag = etree.QName(element).localname
    seen: set[str] = set()
    for name in map(str, element.attrib):
        if name not in part.attributes and not name.startswith("{"):
            yield element, f"the attribute {name}", f" of <{tag}>"
    for child in element:
        if not isinstance(child.tag, str) or child.tag.startswith(DRAKE):
            continue
        name = etree.QName(child).localname
        known = part.children.get(child.tag)
        if known is not None and child.tag in seen and (tag, name) not in SEVERAL:
            yield child, f"a second <{name}>", f" in <{tag}>"
            continue
        seen.add(child.tag)
        if known is not None and known.names is not None and child.get("name", "") not in known.names:
            yield child, f'<{name} name="{child.get("name", "")}">', f" in <{tag}>"
        elif known is not None:
            yield from _unread(child, known)
        elif tag in ("gazebo", "model", "sensor") and name == "plugin":
            yield from _unread_plugin(child)
        elif tag in ("gazebo", "link", "joint") and name == "sensor":
            continue  # `drake_twin.planning.sensor_plan` says what becomes of it
        elif not asks_for_nothing(child):
            yield child, f"<{name}>", f" in <{tag}>" if tag != "robot" else ""


def _unread_plugin(plugin: etree._Element) -> Iterator[_Unread]:
    filename, name = plugin.get("filename", ""), plugin.get("name", "")
    if why := misspelt_plugin(GazeboPlugin(filename, name)):
        yield plugin, why, ""
    if "ros2_control" in filename + name:
        yield from _unread(plugin, ROS2_CONTROL)
        return
    if is_drive(GazeboPlugin(filename, name)):
        for attribute in map(str, plugin.attrib):
            if attribute not in ROS2_CONTROL.attributes:
                yield plugin, f"the attribute {attribute}", " of <plugin>"
        return
    called = f"{name} ({filename})" if name and filename else name or filename or "?"
    kind = plugin_kind(GazeboPlugin(filename, name))
    if kind in SENSOR_PLUGINS or kind in DONE_HERE:
        return
    if is_world_plugin(GazeboPlugin(filename, name)):
        yield plugin, f"Gazebo plugin {called}", ": it does something in a <world> alone"
        return
    absent = "the twin has no such plugin" + did_you_mean(filename.rpartition("/")[2], known_libraries(), 0.85)
    yield plugin, f"Gazebo plugin {called}", f": {_reason(_PLUGINS, filename + name, absent)}"


def _reason(reasons: Mapping[str, str], name: str, otherwise: str) -> str:
    return next((reason for part, reason in reasons.items() if part in name.lower()), otherwise)
