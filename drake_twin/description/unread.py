"""The elements and attributes of a URDF or SDF file that the twin ignores: all that `used_elements` does not list."""

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches

from lxml import etree

from drake_twin.description.gazebo_drives import is_drive, known_libraries
from drake_twin.description.gazebo_plugins import DONE_HERE, plugin_kind
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.sensors import SENSOR_PLUGINS
from drake_twin.description.unused_contact import is_unused, parameter, values_of
from drake_twin.description.used_elements import (
    DRAKE,
    REPORTED,
    ROS2_CONTROL,
    SDF_MODEL,
    SEVERAL,
    URDF,
    Part,
    weight_of,
)
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, Weight, merged

_PLUGINS = {
    **dict.fromkeys(("camera", "depth", "ray", "laser", "range"), "the twin simulates no such sensor"),
    "buoyancy": "the twin has no water and no air",
    "lift": "the twin has no water and no air",
    "hydrodynamics": "the twin has no water and no air",
    "wind": "the twin has no water and no air",
    "thruster": "the twin has no water and no air",
    "battery": "the twin has no batteries",
}

# Parameter → Gazebo's default, with which a file asks for nothing.
_DEFAULTS = {
    "gravity": 1.0,
    "turn_gravity_off": 0.0,
    "self_collide": 0.0,
    "kinematic": 0.0,
    "enable_wind": 0.0,
    "must_be_base_link": 0.0,
    "allow_auto_disable": 1.0,
    "cast_shadows": 1.0,
    "lighting": 1.0,
    "transparency": 0.0,
    "laser_retro": 0.0,
    "max_contacts": 10.0,
}


def unread_in_urdf(reader: XmlReader) -> list[Finding]:
    """Report each element and attribute of a URDF that is ignored, once with all its lines."""
    return list(_findings(reader, (*_unread(reader.root, URDF), *_about_nothing(reader.root))))


def _about_nothing(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """Yield each ``<gazebo reference>`` to a link or joint that the robot does not have."""
    known = {item.get("name", "").strip() for tag in ("link", "joint") for item in root.iterfind(tag)}
    for element in root.iterfind("gazebo[@reference]"):
        reference = element.get("reference", "").strip()
        if reference and reference not in known and len(element):
            yield element, f"<gazebo reference={reference!r}>: the robot has no such link or joint"


def unread_in_sdf(reader: XmlReader) -> tuple[Finding, ...]:
    """Report each element and attribute of an SDF file with one model that is ignored."""
    model = reader.root.find("model")
    return () if model is None else tuple(_findings(reader, _unread(model, SDF_MODEL)))


def _findings(reader: XmlReader, unread: Iterable[tuple[etree._Element, str]]) -> Iterator[Finding]:
    def found(element: etree._Element, what: str) -> Finding:
        weight, above = weight_of(element), element.getparent()
        cause = str(weight) if weight is Weight.LOOKS else ""
        if element.tag in ("param", "gazebo") and above is not None:
            cause = f"<{element.tag}> in <{above.tag}>"
        return Finding.at(Kind.IGNORED, what, reader.place(element), weight=weight, cause=cause)

    return merged(found(element, what) for element, what in unread)


def _unread(element: etree._Element, part: Part) -> Iterator[tuple[etree._Element, str]]:
    tag = etree.QName(element).localname
    seen: set[str] = set()
    for name in map(str, element.attrib):
        if name not in part.attributes and not name.startswith("{"):
            yield element, f"the attribute {name} of <{tag}>"
    for child in element:
        if not isinstance(child.tag, str) or child.tag.startswith(DRAKE):
            continue
        name = etree.QName(child).localname
        known = part.children.get(child.tag)
        if known is not None and child.tag in seen and (tag, name) not in SEVERAL:
            yield child, f"a second <{name}> in <{tag}>"
            continue
        seen.add(child.tag)
        if known is not None and known.names is not None and child.get("name", "") not in known.names:
            yield child, f'<{name} name="{child.get("name", "")}"> in <{tag}>'
        elif known is not None and known is not REPORTED:
            yield from _unread(child, known)
        elif tag in ("gazebo", "model", "sensor") and name == "plugin":
            yield from _unread_plugin(child)
        elif tag in ("gazebo", "link", "joint") and name == "sensor":
            continue  # `drake_twin.planning.sensor_plan` says what becomes of it
        elif known is not REPORTED and not is_unused(child) and not _is_default(child):
            yield child, f"<{name}>" + (f" in <{tag}>" if tag != "robot" else "")


def _is_default(element: etree._Element) -> bool:
    return values_of(element) == (_DEFAULTS.get(parameter(element)),)


def _unread_plugin(plugin: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    filename, name = plugin.get("filename", ""), plugin.get("name", "")
    if "ros2_control" in filename + name:
        yield from _unread(plugin, ROS2_CONTROL)
        return
    if is_drive(GazeboPlugin(filename, name)):
        for attribute in map(str, plugin.attrib):
            if attribute not in ROS2_CONTROL.attributes:
                yield plugin, f"the attribute {attribute} of <plugin>"
        return
    called = f"{name} ({filename})" if name and filename else name or filename or "?"
    kind = plugin_kind(GazeboPlugin(filename, name))
    if kind in SENSOR_PLUGINS or kind in DONE_HERE:
        return
    close = get_close_matches(filename.rpartition("/")[2], known_libraries(), n=1, cutoff=0.85)
    absent = "the twin has no such plugin" + (f". Did you mean {close[0]!r}?" if close else "")
    yield plugin, f"Gazebo plugin {called}: {_reason(_PLUGINS, filename + name, absent)}"


def _reason(reasons: Mapping[str, str], name: str, otherwise: str) -> str:
    return next((reason for part, reason in reasons.items() if part in name.lower()), otherwise)
