"""Repairs of what moves: the robot as a whole, its joints, their limits and followers."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from lxml import etree

from drake_twin.description.repairs import Mended, repair
from drake_twin.description.robot_description import MOVABLE_JOINT_TYPES
from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.findings import first_of
from drake_twin.values import number_or_none

_MOST_NAMED = 6  # joints in a sentence


@repair("robot_without_name")
def robot_without_name(reader: XmlReader) -> Mended:
    """Name a ``<robot>`` without a name after its file."""
    if not (reader.root.get("name") or "").strip():
        name = Path(reader.file).name.split(".")[0] if reader.file is not None else "robot"
        reader.root.set("name", name)
        yield reader.root, f"the robot has no name: it is called {name!r} after its file"


@repair("robot_without_links")
def robot_without_links(reader: XmlReader) -> Mended:
    """Make a robot without any link an empty frame."""
    if reader.root.find("link") is None and reader.root.find("joint") is None:
        etree.SubElement(reader.root, "link", name="world")
        yield reader.root, "the robot has no link (a part for other files to include?): it is an empty frame"


@repair("joint_without_limits")
def joint_without_limits(reader: XmlReader) -> Mended:
    """Let a revolute joint without ``<limit>`` turn without end; swap limits that are in the wrong order."""
    for joint in reader.root.iterfind("joint"):
        kind, limit = joint.get("type"), joint.find("limit")
        if limit is None and kind == "revolute":
            joint.set("type", "continuous")
            yield joint, f"{described(joint)} is revolute without <limit>: it turns without end"
        elif limit is None and kind == "prismatic":
            etree.SubElement(joint, "limit", lower="-1e3", upper="1e3")
            yield joint, f"{described(joint)} is prismatic without <limit>: it slides a kilometre either way"
        elif limit is not None and kind in ("revolute", "prismatic"):
            lower, upper = number_or_none(limit.get("lower")), number_or_none(limit.get("upper"))
            if lower is not None and upper is not None and lower > upper:
                limit.set("lower", f"{upper:.17g}")
                limit.set("upper", f"{lower:.17g}")
                yield joint, f"{described(joint)}: lower {lower:g} is above upper {upper:g}: they are swapped"


@repair("continuous_joint_with_limits")
def continuous_joint_with_limits(reader: XmlReader) -> Mended:
    """Remove the bounds of a continuous joint: it turns without end in ROS and Gazebo, but Drake would stop it."""
    for joint in reader.root.iterfind("joint[@type='continuous']"):
        limit = joint.find("limit")
        bounds: dict[str, str] = {}
        for name in ("lower", "upper"):
            if limit is not None and name in limit.attrib:
                bounds[name] = str(limit.attrib.pop(name))
        if any(number_or_none(value) != 0 for value in bounds.values()):
            written = ", ".join(f"{name} {value}" for name, value in bounds.items())
            yield joint, f"{described(joint)} is continuous and turns without end: its {written} has no effect"


@repair("floating_joint")
def floating_joint(reader: XmlReader) -> Mended:
    """Remove a floating joint from ``world`` to the robot, which is free without it; make any other one fixed."""
    for joint in reader.root.findall("joint"):
        parent = joint.find("parent")
        if joint.get("type") != "floating" or parent is None:
            continue
        siblings = [other for other in reader.root.iterfind("joint/parent") if other.get("link") == "world"]
        world = next((link for link in reader.root.iterfind("link") if link.get("name") == "world"), None)
        if parent.get("link") == "world" and world is not None and len(siblings) == 1:
            reader.root.remove(joint)
            reader.root.remove(world)
            yield world, f"{described(joint)} to the world is left out: a robot that is not fixed is free without it"
        else:
            joint.set("type", "fixed")
            what = "floating joints between two links of a robot are not supported: it is fixed"
            yield joint, f"{described(joint)}: {what}"


@repair("effort_limit")
def effort_limit(reader: XmlReader) -> Mended:
    """Remove an effort limit of zero from a joint that is commanded: it stands for "not known"."""
    commanded = {
        joint.get("name")
        for joint in reader.root.iterfind("ros2_control/joint")
        if joint.find("command_interface") is not None
    }
    for plugin in reader.root.iterfind("gazebo/plugin"):
        if "publisher" not in f"{plugin.get('filename')}{plugin.get('name')}".lower():
            commanded |= {(element.text or "").strip() for element in plugin.iter(etree.Element)}
    for joint in reader.root.iterfind("joint"):
        limit = joint.find("limit")
        effort = None if limit is None else number_or_none(limit.get("effort"))
        if joint.get("name") in commanded and limit is not None and effort is not None and effort <= 0:
            del limit.attrib["effort"]
            yield joint, f"{described(joint)} is commanded, but its effort limit is {effort:g}: it has no limit"


@repair("velocity_limit")
def velocity_limit(reader: XmlReader) -> Mended:
    """Remove a velocity limit of zero, at which Gazebo would hold a joint still, or below: it stands for "not known".

    Below zero it does not limit in Gazebo either; -1 is how SDF says so.
    """
    found: dict[float, list[etree._Element]] = {}
    for joint in reader.root.iterfind("joint"):
        limit = joint.find("limit")
        velocity = None if limit is None else number_or_none(limit.get("velocity"))
        if joint.get("type") not in MOVABLE_JOINT_TYPES or limit is None or velocity is None:
            continue
        if velocity <= 0 and velocity != -1:
            del limit.attrib["velocity"]
            found.setdefault(velocity, []).append(joint)
    for velocity, joints in found.items():
        names = [joint.get("name", "") for joint in joints]
        why = "at which Gazebo holds a joint still" if velocity == 0 else "below zero"
        yield (
            joints[0],
            f"joint {first_of(names, _MOST_NAMED)}: the velocity limit is {velocity:g}, {why}: it has no limit",
        )


@repair("mimic")
def mimic(reader: XmlReader) -> Mended:
    """Remove the mimic of a joint that cannot follow, or whose leader does not move."""
    kinds = {_name(joint): joint.get("type") for joint in reader.root.iterfind("joint")}
    followers = list(_followers(reader.root))
    leaders = {name: leader for name, leader, *_ in followers}
    for name, leader, joint, element in followers:
        reason = None
        if kinds[name] not in MOVABLE_JOINT_TYPES:
            reason = "it does not move itself"
        elif leader not in kinds:
            reason = "the robot has no such joint"
        elif kinds[leader] not in MOVABLE_JOINT_TYPES:
            reason = "that joint does not move"
        elif _follows_itself(name, leaders):
            reason = "it follows itself"
        if reason is not None:
            joint.remove(element)
            leaders.pop(name, None)
            yield joint, f"{described(joint)} mimics {leader!r}, but {reason}: its mimic is removed"


def _followers(root: etree._Element) -> Iterator[tuple[str, str, etree._Element, etree._Element]]:
    """Yield follower, leader, joint and the element that says so: ``<mimic>``, else a parameter of ros2_control."""
    own = {_name(joint): joint.find("mimic") for joint in root.iterfind("joint")}
    for joint in root.iterfind("joint"):
        element = joint.find("mimic")
        if element is not None:
            yield _name(joint), _name(element, "joint"), joint, element
    for joint in root.iterfind("ros2_control/joint"):
        for parameter in joint.findall("param"):
            if parameter.get("name") == "mimic" and _name(joint) in own and own[_name(joint)] is None:
                yield _name(joint), (parameter.text or "").strip(), joint, parameter


def _name(element: etree._Element, attribute: str = "name") -> str:
    return (element.get(attribute) or "").strip()


def _follows_itself(name: str, leaders: Mapping[str, str]) -> bool:
    seen = {name}
    while name in leaders:
        name = leaders[name]
        if name in seen:
            return True
        seen.add(name)
    return False
