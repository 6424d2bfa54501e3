"""What Gazebo's reader makes of a URDF's fixed joints: it folds the links together and renames their shapes.

The rules are those of libsdformat's src/parser_urdf.cc.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from lxml import etree

from drake_twin.description.gazebo_tag import is_yes, text_or_value

LUMP, _COLLISION = "_fixed_joint_lump__", "_collision"


class GazeboCollision(NamedTuple):
    """A collision shape of a URDF as Gazebo has it.

    Attributes:
        link: The link that it belongs to in Gazebo.
        name: Its name there.
        sources: The links whose ``<gazebo reference>`` gives it its surface; the last one counts.
    """

    link: str
    name: str
    sources: tuple[str, ...]


def lumped_links(root: etree._Element) -> dict[str, str]:
    """Return link → the link into which Gazebo folds it, for the links on fixed joints.

    ``FixedJointShouldBeReduced``: every fixed joint that is not marked by ``<preserveFixedJoint>`` or
    ``<disableFixedJointLumping>`` and whose parent is not ``world``.
    """
    parents = {child: parent for child, (_, parent) in _folded(root).items()}
    found = {}
    for link in parents:
        last, seen = link, {link}
        while last in parents and parents[last] not in seen:
            last = parents[last]
            seen.add(last)
        found[link] = last
    return found


def link_families(root: etree._Element) -> dict[str, tuple[str, ...]]:
    """Return each link that Gazebo has → itself and the links that are folded into it, in Gazebo's order."""
    folded = _folded(root)
    children: defaultdict[str, list[tuple[str, str]]] = defaultdict(list)
    for child, (joint, parent) in folded.items():
        children[parent].append((joint, child))
    links = map(_name, root.iterfind("link"))
    return {link: tuple(_family(link, children)) for link in links if link not in folded}


def gazebo_collisions(root: etree._Element) -> dict[tuple[str, int], GazeboCollision]:
    """Return link and index of each collision shape of a URDF → the shape in Gazebo, in Gazebo's order.

    ``CreateCollisions`` and ``CreateCollision``: a shape is called ``NAME_collision``, or ``LINK_collision`` without a
    name, with a number from the second on; where that does not begin with the name of the link that has it, it is
    ``LINK_fixed_joint_lump__NAME_collision``. ``InsertSDFExtensionCollision``: by this name Gazebo also tells whose
    ``<gazebo reference>`` is meant, so that one with a name of its own usually has the default surface.
    """
    shapes = {
        _name(element): [shape.get("name", "") for shape in element.iterfind("collision")]
        for element in root.iterfind("link")
    }
    found = {}
    for link, family in link_families(root).items():
        places = [(own, index) for own in family for index in range(len(shapes.get(own, ())))]
        for count, (own, index) in enumerate(places):
            name = f"{shapes[own][index] or own}{_COLLISION}" + (f"_{count}" if count else "")
            name = name if name.startswith(link) else f"{link}{LUMP}{name}"
            sources = tuple(other for other in family if _is_source(other, link, name))
            found[own, index] = GazeboCollision(link, name, sources)
    return found


def _folded(root: etree._Element) -> dict[str, tuple[str, str]]:
    """Return child → joint and parent, of the joints that Gazebo removes."""
    kept = {
        (element.get("reference") or "").strip()
        for element in root.iterfind("gazebo[@reference]")
        for tag in ("preserveFixedJoint", "disableFixedJointLumping")
        if is_yes(text_or_value(element, tag))
    }
    found = {}
    for joint in root.iterfind("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if joint.get("type") == "fixed" and _name(joint) not in kept and parent is not None and child is not None:
            above = parent.get("link", "").strip()
            if above != "world":
                found[child.get("link", "").strip()] = (_name(joint), above)
    return found


def _family(link: str, children: Mapping[str, list[tuple[str, str]]]) -> Iterator[str]:
    """Yield a link and those that are folded into it, in Gazebo's order: by the names of their joints."""
    waiting = [link]
    while waiting:
        yield (following := waiting.pop())
        waiting += [child for _, child in sorted(children.get(following, ()), reverse=True)]


def _is_source(other: str, link: str, name: str) -> bool:
    return LUMP not in name if other == link else f"{LUMP}{other}{_COLLISION}" in name


def _name(element: etree._Element) -> str:
    return element.get("name", "").strip()
