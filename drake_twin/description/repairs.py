"""What is wrong with so many robot files that the twin mends it: one rule a function, applied in the order of `RULES`.

A rule changes the parsed XML and says what it did. Each can be switched off by its name (``without_repairs`` of a
scenario's robot); then the file is used as it is, or refused. ``docs/repairs.md`` lists them for users.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import combinations
from math import isfinite
from pathlib import Path

import numpy as np
from lxml import etree

from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind

_MOVABLE = ("revolute", "continuous", "prismatic")
_DENSITY_LEVER = 0.4  # of a solid sphere: I = 0.4 m r²
_LEAST_RADIUS = 0.01  # m: the sphere that a link without inertia is taken for
_LEAST_SCALE = 1e-8  # of a mesh: Drake takes none that is smaller
_LEAST_MASS = 1e-3  # kg: what a link that moves and carries nothing is taken to weigh
_PHYSICAL_MARGIN = 1e-9  # relative
_LEAST_MOMENT = 1e-6  # relative to the largest: Drake cannot turn what has none


Rule = Callable[[XmlReader], Iterator[tuple[etree._Element, str]]]


def repair_urdf(reader: XmlReader, without: Collection[str] = ()) -> list[Finding]:
    """Applies the structural rules to a URDF's tree.

    Args:
        reader: the document; its tree is changed.
        without: names of rules to leave out.

    Returns:
        What was mended, in order.
    """
    done = []
    for name, rule in RULES.items():
        if name not in without:
            done += [Finding.at(Kind.MENDED, what, reader.place(element), name) for element, what in rule(reader)]
    return done


def check_rule_names(names: Collection[str], all_names: Collection[str]) -> None:
    """Refuses a name that is no rule's.

    Raises:
        InputError: with the names there are.
    """
    for name in names:
        if name not in all_names:
            raise InputError(f"there is no repair {name!r}", value=name, valid=sorted(all_names))


def _robot_without_name(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """``<robot>`` without a name is called after its file."""
    if not (reader.root.get("name") or "").strip():
        name = Path(reader.file).name.split(".")[0] if reader.file is not None else "robot"
        reader.root.set("name", name)
        yield reader.root, f"the robot has no name: it is called {name!r} after its file"


def _robot_without_links(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A robot without any link is an empty frame."""
    if reader.root.find("link") is None and reader.root.find("joint") is None:
        etree.SubElement(reader.root, "link", name="world")
        yield reader.root, "the robot has no link (a part for other files to include?): it is an empty frame"


def _joint_without_limits(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A revolute joint without ``<limit>`` turns without end; limits in the wrong order change places."""
    for joint in reader.root.iterfind("joint"):
        kind, limit = joint.get("type"), joint.find("limit")
        if limit is None and kind == "revolute":
            joint.set("type", "continuous")
            yield joint, f"{described(joint)} is revolute without <limit>: it turns without end"
        elif limit is None and kind == "prismatic":
            etree.SubElement(joint, "limit", lower="-1e3", upper="1e3", effort="0", velocity="0")
            yield joint, f"{described(joint)} is prismatic without <limit>: it slides a kilometre either way"
        elif limit is not None and kind in ("revolute", "prismatic"):
            lower, upper = _number(limit.get("lower")), _number(limit.get("upper"))
            if lower is not None and upper is not None and lower > upper:
                limit.set("lower", f"{upper:.17g}")
                limit.set("upper", f"{lower:.17g}")
                yield joint, f"{described(joint)}: lower {lower:g} is above upper {upper:g}: they change places"


def _continuous_joint_with_limits(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A continuous joint turns without end, whatever bounds are written: so in ROS and Gazebo; Drake would stop it."""
    for joint in reader.root.iterfind("joint[@type='continuous']"):
        limit = joint.find("limit")
        bounds: dict[str, str] = {}
        for name in ("lower", "upper"):
            if limit is not None and name in limit.attrib:
                bounds[name] = str(limit.attrib.pop(name))
        if any(_number(value) != 0 for value in bounds.values()):
            written = ", ".join(f"{name} {value}" for name, value in bounds.items())
            yield joint, f"{described(joint)} is continuous and turns without end: its {written} bounds nothing"


def _floating_joint(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A floating joint from ``world`` to the robot makes the robot free, as it is anyway; any other becomes fixed."""
    for joint in reader.root.findall("joint"):
        parent = joint.find("parent")
        if joint.get("type") != "floating" or parent is None:
            continue
        siblings = [other for other in reader.root.iterfind("joint/parent") if other.get("link") == "world"]
        world = next((link for link in reader.root.iterfind("link") if link.get("name") == "world"), None)
        if parent.get("link") == "world" and world is not None and len(siblings) == 1:
            reader.root.remove(joint)
            reader.root.remove(world)
            yield world, f"{described(joint)} to the world is what a robot that is not fixed has anyway: it is left out"
        else:
            joint.set("type", "fixed")
            yield (
                joint,
                f"{described(joint)} floats, which a joint between two links of a robot cannot here: it is fixed",
            )


def _effort_limit(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """An effort limit of zero on a joint that is commanded stands for "not known"."""
    commanded = {
        joint.get("name")
        for joint in reader.root.iterfind("ros2_control/joint")
        if joint.find("command_interface") is not None
    }
    for joint in reader.root.iterfind("joint"):
        limit = joint.find("limit")
        effort = None if limit is None else _number(limit.get("effort"))
        if joint.get("name") in commanded and limit is not None and effort is not None and effort <= 0:
            del limit.attrib["effort"]
            yield joint, f"{described(joint)} is commanded, but its effort limit is {effort:g}: it has none"


def _mimic(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A joint that mimics nothing that moves moves on its own, or stays fixed."""
    kinds = {_name(joint): joint.get("type") for joint in reader.root.iterfind("joint")}
    followers = list(_followers(reader.root))
    leaders = {name: leader for name, leader, *_ in followers}
    for name, leader, joint, mimic in followers:
        reason = None
        if kinds[name] not in _MOVABLE:
            reason = "it does not move itself"
        elif leader not in kinds:
            reason = "there is no such joint"
        elif kinds[leader] not in _MOVABLE:
            reason = "that joint does not move"
        elif _follows_itself(name, leaders):
            reason = "it follows itself"
        if reason is not None:
            joint.remove(mimic)
            leaders.pop(name, None)
            yield joint, f"{described(joint)} mimics {leader!r}, but {reason}: it mimics nothing"


def _followers(root: etree._Element) -> Iterator[tuple[str, str, etree._Element, etree._Element]]:
    """Follower, leader, and the element that says so with its joint: ``<mimic>``, else a parameter of ros2_control."""
    own = {_name(joint): joint.find("mimic") for joint in root.iterfind("joint")}
    for joint in root.iterfind("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            yield _name(joint), _name(mimic, "joint"), joint, mimic
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


def _shape_without_size(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A shape of no size is left out: Drake ends the process over it."""
    for kind in ("visual", "collision"):
        for shape in reader.root.findall(f"link/{kind}"):
            for tag, attributes in _SIZES.items():
                for element in shape.iterfind(f"geometry/{tag}"):
                    link = shape.getparent()
                    if link is not None and _has_no_size(element, attributes):
                        text = " ".join(f"{name}={element.get(name, '')!r}" for name in attributes)
                        link.remove(shape)
                        yield link, f"{described(link)}: a {kind} <{tag} {text}> has no size: it is left out"


_SIZES = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("scale",),
}


def _has_no_size(element: etree._Element, attributes: Collection[str]) -> bool:
    if element.tag == "mesh":  # mirrored where its scale is negative, as it is where there is none
        sizes = [_number(part) for part in element.get("scale", "1").split()]
        return any(size is not None and abs(size) < _LEAST_SCALE for size in sizes)
    texts = [element.get(name, "").split() for name in attributes]
    return not all(texts) or any(size is not None and size <= 0 for text in texts for size in map(_number, text))


def _shape_without_geometry(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A visual or collision without a shape is left out."""
    for kind in ("visual", "collision"):
        for shape in reader.root.findall(f"link/{kind}"):
            geometry = shape.find("geometry")
            if geometry is None or not any(child.tag in _SIZES for child in geometry):
                link = shape.getparent()
                assert link is not None
                link.remove(shape)
                yield link, f"{described(link)}: a {kind} has no shape: it is left out"


def _color(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A colour's parts lie between 0 and 1; what is beyond is drawn as RViz draws it, at the nearest of them."""
    for color in (*reader.root.iterfind("material/color"), *reader.root.iterfind("link/visual/material/color")):
        text = color.get("rgba", "")
        parts = [part for part in map(_number, text.split()) if part is not None]
        if len(parts) == len(text.split()) and any(not 0 <= part <= 1 for part in parts):
            color.set("rgba", " ".join(f"{min(max(part, 0.0), 1.0):g}" for part in parts))
            material = color.getparent()
            yield color, f"{described(color if material is None else material)}: {text!r} is not between 0 and 1"


def _inertia(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """Principal moments that no body has become the nearest possible; mass without inertia is a small sphere."""
    for link in reader.root.iterfind("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        mass_element, inertia = inertial.find("mass"), inertial.find("inertia")
        mass = None if mass_element is None else _number(mass_element.get("value"))
        if mass_element is None or mass == 0:
            # Drake would take such a link for one of 1 kg.
            link.remove(inertial)
            if inertia is not None and any(_number(inertia.get(name, "0")) for name in _MOMENTS):
                yield link, f"{described(link)} has inertia but no mass: it has neither"
            continue
        if mass is None or mass < 0:
            continue  # refused where it is read
        if inertia is None:
            inertia = etree.SubElement(inertial, "inertia")
        values = {name: _number(inertia.get(name, "0")) for name in _MOMENTS}
        if any(value is None or not isfinite(value) for value in values.values()):
            continue  # what is no number is refused where it is read
        numbers = {name: float(value or 0.0) for name, value in values.items()}
        possible, why = possible_inertia(mass, _tensor(numbers))
        if why is not None:
            _set_tensor(inertia, possible)
            yield link, f"{described(link)}: {why}"


def possible_inertia(mass: float, tensor: np.ndarray) -> tuple[np.ndarray, str | None]:
    """The inertia nearest to a given one (kg·m², 3×3) that a body of a mass (kg) can have, and why it differs if so."""
    if not np.any(tensor):
        sphere = _DENSITY_LEVER * mass * _LEAST_RADIUS**2 * np.eye(3)
        return sphere, f"it has mass but no inertia: that of a sphere of {_LEAST_RADIUS:g} m is used"
    moments, axes = np.linalg.eigh(tensor)
    repaired = _physical(moments)
    if np.abs(repaired - moments).max() <= _PHYSICAL_MARGIN * float(np.abs(moments).max()):
        return tensor, None
    changes = ", ".join(_change(*pair) for pair in zip(moments, repaired, strict=True))
    given = ", ".join(f"{moment:.3g}" for moment in moments)
    nearest = np.asarray(axes @ np.diag(repaired) @ axes.T)
    return nearest, f"no body has the principal moments {given} kg·m²: the nearest possible are used: {changes}"


def _change(moment: float, repaired: float) -> str:
    """What becomes of a principal moment (kg·m²)."""
    has_share = moment > 1e-3 * repaired  # what was next to nothing has become something
    return f"{repaired:.3g} ({100 * (repaired / moment - 1):+.3g} %)" if has_share else f"{repaired:.3g}"


_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def _tensor(numbers: Mapping[str, float]) -> np.ndarray:
    ixx, ixy, ixz, iyy, iyz, izz = (numbers[name] for name in _MOMENTS)
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def _set_tensor(inertia: etree._Element, tensor: np.ndarray) -> None:
    rows, columns = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    for name, row, column in zip(_MOMENTS, rows, columns, strict=True):
        inertia.set(name, f"{float(tensor[row, column]):.17g}")


def _physical(moments: np.ndarray) -> np.ndarray:
    """The principal moments nearest to given ones that a body can have.

    None is larger than the other two together: they are those of three rods, one along each axis, whose moments are not
    negative. The nearest are on the face of that cone which leaves the least difference.
    """
    largest = float(np.abs(moments).max())
    if moments.min() >= _LEAST_MOMENT * largest and 2 * moments.max() <= moments.sum() + _PHYSICAL_MARGIN * largest:
        return moments
    nearest = np.zeros(3)
    for count in (1, 2, 3):
        for rods in combinations(1.0 - np.eye(3), count):
            parts = np.linalg.lstsq(np.transpose(rods), moments, rcond=None)[0]
            found = parts @ rods
            if parts.min() >= 0 and np.linalg.norm(found - moments) < np.linalg.norm(nearest - moments):
                nearest = found
    parts = np.maximum(nearest.sum() / 2 - nearest, _LEAST_MOMENT * largest)  # the rods': no moment is zero then
    return np.asarray(parts.sum() - parts)


def _massless_link(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    """A joint that moves no mass moves a little one: Drake cannot accelerate nothing."""
    parents: dict[str, str] = {}
    moved: list[str] = []
    rigid_parents: dict[str, str] = {}
    for joint in reader.root.iterfind("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            return  # refused where it is read
        parents[child.get("link", "")] = parent.get("link", "")
        if joint.get("type") == "fixed":
            rigid_parents[child.get("link", "")] = parent.get("link", "")
        else:
            moved.append(child.get("link", ""))
    links = {link.get("name", ""): link for link in reader.root.iterfind("link")}
    heavy = [
        name
        for name, link in links.items()
        if (mass := link.find("inertial/mass")) is not None and (_number(mass.get("value")) or 0.0) > 0
    ]
    # A joint's child may leave the mass to what it carries; a floating root may turn about what it carries, so it, or
    # what is fixed to it, must weigh something itself.
    carrying = _with_all_above(heavy, parents)
    roots = [name for name in links if name not in parents and name != "world"]
    light = [name for name in roots if name not in _with_all_above(heavy, rigid_parents)]
    light += [name for name in moved if name in links and name not in carrying]
    for name in dict.fromkeys(light):
        link = links[name]
        for inertial in link.findall("inertial"):
            link.remove(inertial)
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "mass", value=f"{_LEAST_MASS:g}")
        _set_tensor(etree.SubElement(inertial, "inertia"), _DENSITY_LEVER * _LEAST_MASS * _LEAST_RADIUS**2 * np.eye(3))
        yield link, f"{described(link)} moves, but has no mass: it weighs {_LEAST_MASS:g} kg"


def _with_all_above(names: Iterable[str], parents: Mapping[str, str]) -> set[str]:
    found: set[str] = set()
    for name in names:
        above: str | None = name
        while above is not None and above not in found:
            found.add(above)
            above = parents.get(above)
    return found


def _number(text: str | None) -> float | None:
    """Text as a number; None where it is none, which is refused where the value is used."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


RULES: Mapping[str, Rule] = {
    "robot_without_name": _robot_without_name,
    "robot_without_links": _robot_without_links,
    "joint_without_limits": _joint_without_limits,
    "continuous_joint_with_limits": _continuous_joint_with_limits,
    "floating_joint": _floating_joint,
    "effort_limit": _effort_limit,
    "mimic": _mimic,
    "shape_without_size": _shape_without_size,
    "shape_without_geometry": _shape_without_geometry,
    "color": _color,
    "inertia": _inertia,
    "massless_link": _massless_link,
}
