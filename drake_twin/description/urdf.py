"""URDF text as a ``RobotDescription``, with its ``<ros2_control>`` and ``<gazebo>`` tags."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from math import hypot, inf

from lxml import etree

from drake_twin.description.gazebo_plugins import read_plugins
from drake_twin.description.gazebo_tag import is_yes, text_or_value
from drake_twin.description.gpios import hardware_gpios
from drake_twin.description.link_surface import link_surfaces
from drake_twin.description.robot_description import (
    CommandInterface,
    ControlledJoint,
    HardwareSystem,
    Joint,
    JointLimits,
    Mimic,
    Pose,
    RobotDescription,
    StateInterface,
)
from drake_twin.description.sensors import hardware_sensors, sensors_in_urdf
from drake_twin.description.xml_reader import XmlReader, parameters_of
from drake_twin.findings import Finding, Kind
from drake_twin.values import parse_number

_JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic", "planar", "floating")


def describe_urdf(reader: XmlReader, text: str) -> RobotDescription:
    """Describe a parsed URDF.

    Args:
        reader: The document, xacro already expanded, with its repairs.
        text: The document's own text, which is published as ``robot_description``.

    Raises:
        InputError: If the document is not URDF, a value is wrong, or a link or joint is missing, duplicate or outside
            the tree.
    """
    root = reader.root
    if root.tag != "robot":
        raise reader.error(root, "a URDF's outermost element is <robot>")
    systems = tuple(_hardware_system(reader, element) for element in root.iterfind("ros2_control"))
    links = [reader.text(element, "name") for element in root.iterfind("link")]
    joints = [_joint(reader, element) for element in root.iterfind("joint")]
    _check_tree(reader, links, joints)
    joints = list(_with_mimic_of_ros2_control(reader, joints))
    _check_followers(reader, joints)
    return RobotDescription(
        name=root.get("name") or "robot",
        links=tuple(links),
        joints=tuple(joints),
        systems=systems,
        plugins=tuple(read_plugins(reader, "gazebo/plugin")),
        surfaces=link_surfaces(reader),
        sensors=tuple(sensors_in_urdf(reader)),
        text=text,
        file=reader.file,
        windy_links=_windy_links(root, text),
    )


def _windy_links(root: etree._Element, text: str) -> tuple[str, ...]:
    if "enable_wind" not in text:
        return ()
    from drake_twin.description.link_wind import windy_links_of_urdf

    return windy_links_of_urdf(root)


def _joint(reader: XmlReader, element: etree._Element) -> Joint:
    name = reader.text(element, "name")
    kind = reader.text(element, "type")
    if kind not in _JOINT_TYPES:
        raise reader.error(element, f"unknown joint type {kind!r}", value=kind, valid=_JOINT_TYPES)
    return Joint(
        name=name,
        type=kind,
        parent=_linked(reader, element, "parent"),
        child=_linked(reader, element, "child"),
        origin=_pose(reader, element),
        axis=_axis(reader, element, kind),
        limits=_limits(reader, element, kind),
        damping=_child_number(reader, element, "dynamics", "damping"),
        friction=_child_number(reader, element, "dynamics", "friction"),
        mimic=_mimic(reader, element),
    )


def _linked(reader: XmlReader, element: etree._Element, tag: str) -> str:
    child = element.find(tag)
    if child is None:
        raise reader.error(element, f"<{tag}> is missing")
    return reader.text(child, "link")


def _pose(reader: XmlReader, element: etree._Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return Pose()
    zero = (0.0, 0.0, 0.0)
    return Pose(reader.vector3(origin, "xyz", zero), reader.vector3(origin, "rpy", zero))


def _axis(reader: XmlReader, element: etree._Element, kind: str) -> tuple[float, float, float]:
    axis = element.find("axis")
    default = (1.0, 0.0, 0.0)
    if axis is None or kind in ("fixed", "floating"):  # a fixed joint's axis is often 0 0 0
        return default
    x, y, z = reader.vector3(axis, "xyz", default)
    length = hypot(x, y, z)
    if length < 1e-8:  # Drake's bound
        raise reader.error(axis, "the axis has no direction (its length is zero)")
    return x / length, y / length, z / length


def _limits(reader: XmlReader, element: etree._Element, kind: str) -> JointLimits:
    limit = element.find("limit")
    if limit is None:
        if kind in ("revolute", "prismatic"):
            raise reader.error(element, f"a {kind} joint needs <limit lower upper effort velocity>")
        return JointLimits()
    bounded = kind in ("revolute", "prismatic")
    lower = reader.number(limit, "lower", 0.0) if bounded else -inf
    upper = reader.number(limit, "upper", 0.0) if bounded else inf
    if lower > upper:
        raise reader.error(limit, f"lower ({lower:g}) is above upper ({upper:g})")
    # Nothing bounds where this is below zero, as in Gazebo. Zero would bound there; see the repairs of such limits.
    velocity = reader.number(limit, "velocity", 0.0)
    effort = reader.number(limit, "effort", 0.0)
    return JointLimits(lower, upper, velocity if velocity > 0 else inf, effort if effort > 0 else inf)


def _child_number(reader: XmlReader, element: etree._Element, tag: str, attribute: str) -> float:
    child = element.find(tag)
    return 0.0 if child is None else reader.number(child, attribute, 0.0)


def _mimic(reader: XmlReader, element: etree._Element) -> Mimic | None:
    mimic = element.find("mimic")
    if mimic is None:
        return None
    return Mimic(
        reader.text(mimic, "joint"), reader.number(mimic, "multiplier", 1.0), reader.number(mimic, "offset", 0.0)
    )


def _hardware_system(reader: XmlReader, element: etree._Element) -> HardwareSystem:
    joints = []
    for joint in element.iterfind("joint"):
        parameters = parameters_of(joint)
        joints.append(
            ControlledJoint(
                name=reader.text(joint, "name"),
                command_interfaces=tuple(
                    _command_interface(reader, item) for item in joint.iterfind("command_interface")
                ),
                state_interfaces=tuple(_state_interface(reader, item) for item in joint.iterfind("state_interface")),
                parameters=parameters,
            )
        )
    hardware = element.find("hardware")
    parameters = {} if hardware is None else parameters_of(hardware)
    return HardwareSystem(
        name=element.get("name", ""),
        type=element.get("type", "system"),
        plugin=(element.findtext("hardware/plugin") or "").strip(),
        joints=tuple(joints),
        parameters=parameters,
        sensors=tuple(hardware_sensors(reader, element)),
        gpios=tuple(hardware_gpios(reader, element, parameters)),
        place=reader.place(element if hardware is None else hardware),
    )


def _command_interface(reader: XmlReader, element: etree._Element) -> CommandInterface:
    bounds = {
        name: reader.parse_number(element, text, name)
        for name, text in parameters_of(element).items()
        if name in ("min", "max")
    }
    lower, upper = bounds.get("min", -inf), bounds.get("max", inf)
    if lower > upper:
        raise reader.error(element, f"min ({lower:g}) is above max ({upper:g})")
    # gazebo_ros2_control names an interface `position_pid` where its own PID is to follow the position.
    return CommandInterface(reader.text(element, "name").removesuffix("_pid"), lower, upper)


def _state_interface(reader: XmlReader, element: etree._Element) -> StateInterface:
    initial = parameters_of(element).get("initial_value")
    value = None if initial is None else reader.parse_number(element, initial, "initial_value")
    return StateInterface(reader.text(element, "name"), value)


def _with_mimic_of_ros2_control(reader: XmlReader, joints: Iterable[Joint]) -> Iterable[Joint]:
    """Add followers that only ``<ros2_control>`` declares (``<param name="mimic">``, as before ROS 2 Jazzy)."""
    followers: dict[str, Mimic] = {}
    for element in reader.root.iterfind("ros2_control/joint"):
        parameters = parameters_of(element)
        if "mimic" in parameters:
            followers[reader.text(element, "name")] = Mimic(
                parameters["mimic"],
                reader.parse_number(element, parameters.get("multiplier", "1"), "multiplier"),
                reader.parse_number(element, parameters.get("offset", "0"), "offset"),
            )
    for joint in joints:
        yield replace(joint, mimic=joint.mimic or followers.get(joint.name))


def _check_followers(reader: XmlReader, joints: list[Joint]) -> None:
    by_name = {joint.name: joint for joint in joints}
    for element, joint in zip(reader.root.iterfind("joint"), joints, strict=True):
        seen = {joint.name}
        leader = joint
        while leader.mimic is not None:
            if leader.mimic.joint not in by_name:
                raise reader.error(element, f"it mimics the unknown joint {leader.mimic.joint!r}")
            leader = by_name[leader.mimic.joint]
            if not joint.is_movable or not leader.is_movable or leader.name in seen:
                what = "it follows itself" if leader.name in seen else "one of the two does not move"
                raise reader.error(element, f"it mimics {leader.name!r}, but {what}")
            seen.add(leader.name)


def is_static_in_gazebo(root: etree._Element) -> bool:
    """Return whether a ``<gazebo>`` tag without a reference says ``<static>true</static>``."""
    found = [element for element in root.findall("gazebo") if element.get("reference") is None]
    return any(is_yes(text_or_value(element, "static")) for element in found)


def skip_wrong_bounds(reader: XmlReader) -> Iterator[Finding]:
    """Remove bounds of command interfaces that are not numbers, such as ``{-2*pi}``, as ros2_control skips them."""
    for interface in reader.root.iterfind("ros2_control/joint/command_interface"):
        for param in interface.findall("param"):
            name, text = param.get("name"), (param.text or "").strip()
            if name not in ("min", "max"):
                continue
            try:
                parse_number(text)
            except ValueError as error:
                common = f", which is {error}: the interface has no such bound"
                what = f"{name} of a command interface is {text!r}{common}"
                yield Finding.at(Kind.IGNORED, what, reader.place(param), common=common)
                interface.remove(param)


def _check_tree(reader: XmlReader, links: list[str], joints: list[Joint]) -> None:
    root = reader.root
    if not links:
        raise reader.error(root, "the robot has no <link>")
    for tag, names in (("link", links), ("joint", [joint.name for joint in joints])):
        for name, count in Counter(names).items():
            if count > 1:
                twice = [element for element in root.iterfind(tag) if element.get("name", "").strip() == name]
                raise reader.error(twice[1], f"two {tag}s have this name")
    parent_of: dict[str, str] = {}
    known = set(links)
    for element, joint in zip(root.iterfind("joint"), joints, strict=True):
        for link in (joint.parent, joint.child):
            if link not in known:
                raise reader.error(element, f"unknown link {link!r}", value=link, valid=links)
        if joint.child in parent_of:
            raise reader.error(element, f"link {joint.child!r} has two parents")
        parent_of[joint.child] = joint.parent
    roots = [link for link in links if link not in parent_of]
    if len(roots) != 1:
        what = f"several have no parent: {', '.join(roots)}" if roots else "all have a parent: the joints form a loop"
        raise reader.error(root, f"the links must form one tree, but {what}")
    for link in links:
        seen = {link}
        while link in parent_of:
            link = parent_of[link]
            if link in seen:
                raise reader.error(root, f"the joints form a loop through link {link!r}")
            seen.add(link)
