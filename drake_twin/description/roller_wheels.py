"""Wheels with friction in one direction, as Gazebo's models of mecanum and omni wheels have it.

Such a wheel is one sphere or cylinder in place of its rollers: along ``<fdir1>`` it has friction, across it slides
freely, as over a roller. The direction is a link's that does not turn with the wheel, by ``expressed_in``, or it is
along the wheel's own axle.
"""

from collections.abc import Iterable, Iterator, Mapping
from math import pi

import numpy as np
from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.fixed_joint_lumping import gazebo_collisions
from drake_twin.description.gazebo_plugins import track_links
from drake_twin.description.link_surface import SURFACE_FRICTION
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.description.sdf_document import numbers_in
from drake_twin.description.wheel_geometry import link_poses, wheel_radius
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Place

_FREE = 0.1  # the largest share of the friction along the direction that the friction across may have
_LEAST = 3  # wheels: fewer do not say how a base moves in the plane
_ALONG_AXLE = 0.999  # of the cosine
_FRICTION = {"mu": ("mu", "mu1"), "mu2": ("mu2",), "fdir1": ("fdir1",)}


@dataclass(frozen=True)
class RollerWheel:
    """A wheel with friction in one direction of the ground.

    Attributes:
        joint: The joint that turns it.
        link: Its link.
        center: Its center in the root link, along x and y (m).
        direction: The direction of its friction in the root link, along x and y, of length 1.
        rim: How far a point of the base at the wheel moves along that direction in a turn by 1 rad (m).
        friction: Its coefficient of friction along the direction.
        place: Where the direction is written.
    """

    joint: str
    link: str
    center: tuple[float, float]
    direction: tuple[float, float]
    rim: float
    friction: float
    place: Place


def roller_wheels(description: RobotDescription) -> tuple[RollerWheel, ...]:
    """Return these wheels of a robot; empty if they are too few to say how its base moves."""
    if "fdir1" not in description.text:
        return ()
    reader = XmlReader(description.text, description.file)
    poses = link_poses(description)
    tracks = track_links(description.plugins)
    joints = {
        joint.child: joint
        for joint in description.movable_joints
        if joint.type != "prismatic" and joint.child not in tracks and _turns_round(joint)
    }
    found = tuple(
        wheel
        for link, friction in _one_way_frictions(reader.root)
        if link in joints and (wheel := _wheel(description, reader, joints[link], poses, friction)) is not None
    )
    return found if len(found) >= _LEAST else ()


def _turns_round(joint: Joint) -> bool:
    """Tell whether a joint can turn as a wheel does; the arm of a flipper cannot."""
    return joint.type != "revolute" or joint.limits.upper - joint.limits.lower >= 2 * pi


def roller_links(description: RobotDescription) -> frozenset[str]:
    """Return the links of these wheels."""
    return frozenset(wheel.link for wheel in roller_wheels(description))


def _one_way_frictions(root: etree._Element) -> Iterator[tuple[str, Mapping[str, etree._Element]]]:
    """Yield link → its elements of friction, for each link with a direction of friction."""
    links: dict[str, list[etree._Element]] = {}
    told = {place[0] for place, shape in gazebo_collisions(root).items() if place[0] in shape.sources}
    for element in root.iterfind("gazebo"):
        if element.get("reference", "") in told:
            links.setdefault(element.get("reference", ""), []).append(element)
    for link in root.iter("link"):
        surfaces = link.iterfind(SURFACE_FRICTION)
        links.setdefault(link.get("name", ""), []).extend(surfaces)
    for name, above in links.items():
        elements = {
            ours: element for ours, theirs in _FRICTION.items() for tag in theirs for element in _below(above, tag)
        }
        if "fdir1" in elements:
            yield name, elements


def _below(above: Iterable[etree._Element], tag: str) -> Iterator[etree._Element]:
    for element in above:
        yield from element.iterfind(tag)
        yield from element.iterfind(f"{SURFACE_FRICTION}/{tag}")


def _wheel(
    description: RobotDescription,
    reader: XmlReader,
    joint: Joint,
    poses: Mapping[str, np.ndarray],
    friction: Mapping[str, etree._Element],
) -> RollerWheel | None:
    """Return a link's wheel; None where the friction has no single direction that stays, or no radius is known."""
    along, across = (_coefficient(friction.get(tag)) for tag in ("mu", "mu2"))
    direction, frame = _vector(friction["fdir1"]), _expressed_in(friction["fdir1"]) or joint.child
    radius = wheel_radius(description, joint.name)
    if direction is None or radius is None or frame not in poses:
        return None
    pose = poses[joint.child]
    axle = pose[:3, :3] @ _child_axis(joint)
    towards = poses[frame][:3, :3] @ direction
    turning = _joints_above(description, frame)
    along_axle = abs(towards @ axle) >= _ALONG_AXLE * np.linalg.norm(towards)
    if turning and not (turning == [joint.name] and along_axle):
        return None
    if across > along:
        along, across, towards = across, along, np.cross((0.0, 0.0, 1.0), towards)
    flat = towards[:2]
    if not np.linalg.norm(flat) or across > _FREE * along:
        return None
    x, y = (flat / np.linalg.norm(flat)).tolist()
    rolls = radius * np.cross(axle, (0.0, 0.0, 1.0))  # where the center of a wheel that grips moves, for 1 rad
    center_x, center_y, _ = pose[:3, 3].tolist()
    rim = float(rolls[0] * x + rolls[1] * y)
    return RollerWheel(
        joint.name, joint.child, (center_x, center_y), (x, y), rim, along, reader.place(friction["fdir1"])
    )


def _child_axis(joint: Joint) -> np.ndarray:
    """Return a joint's axis in its child link."""
    return np.asarray(joint.child_origin.transform().rotation().inverse().matrix() @ np.array(joint.axis))


def _joints_above(description: RobotDescription, link: str) -> list[str]:
    """Return the joints that move a link relative to the root link."""
    by_child = {joint.child: joint for joint in description.joints}
    found = []
    while link in by_child:
        if by_child[link].type != "fixed":
            found.append(by_child[link].name)
        link = by_child[link].parent
    return found


def _expressed_in(element: etree._Element) -> str:
    return next((str(value) for name, value in element.attrib.items() if str(name).endswith("expressed_in")), "")


def _coefficient(element: etree._Element | None) -> float:
    """Return a coefficient of friction; 1 in place of a missing or wrong one."""
    numbers = numbers_in(None if element is None else element.get("value") or element.text)
    return numbers[0] if len(numbers) == 1 and numbers[0] is not None and numbers[0] >= 0.0 else 1.0


def _vector(element: etree._Element) -> np.ndarray | None:
    numbers = [number for number in numbers_in(element.get("value") or element.text) if number is not None]
    return np.array(numbers) if len(numbers) == 3 and np.all(np.isfinite(numbers)) else None
