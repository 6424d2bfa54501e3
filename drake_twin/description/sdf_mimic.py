"""Joints of SDF that follow another one: ``<mimic>`` of an axis, which Drake's parser knows under a name of its own."""

from collections.abc import Iterator
from math import isfinite

from lxml import etree

from drake_twin.description.robot_description import Mimic
from drake_twin.description.sdf_document import number_in

_DRAKE = "http://drake.mit.edu"
_TYPES = ("revolute", "continuous", "prismatic")


def followers(model: etree._Element) -> Iterator[tuple[etree._Element, Mimic]]:
    """Yield each joint of a model that follows another one of it, and how: m (leader - reference) + offset."""
    joints = {joint.get("name", ""): joint for joint in model.findall("joint")}
    for joint in joints.values():
        mimic = joint.find("axis/mimic")
        leader = None if mimic is None else joints.get(mimic.get("joint", ""))
        if mimic is None or leader is None or leader is joint or mimic.get("axis", "axis") != "axis":
            continue
        if not all(each.get("type") in _TYPES for each in (joint, leader)):
            continue
        values = [number_in(mimic.find(tag)) for tag in ("multiplier", "reference", "offset")]
        multiplier, reference, offset = (
            default if value is None else value for value, default in zip(values, (1.0, 0.0, 0.0), strict=True)
        )
        if not isfinite(multiplier) or not isfinite(offset - multiplier * reference):
            continue
        yield joint, Mimic(leader.get("name", ""), multiplier, offset - multiplier * reference)


def couple(model: etree._Element) -> Iterator[str]:
    """Give each follower in a model, and in those inside it, Drake's own element; yield those that follow nothing."""
    for each in model.iter("model"):
        for joint, mimic in [*followers(each)]:
            values = {"multiplier": f"{mimic.multiplier:.17g}", "offset": f"{mimic.offset:.17g}"}
            tag = f"{{{_DRAKE}}}mimic"
            etree.SubElement(joint, tag, {"joint": mimic.joint, **values}, nsmap={"drake": _DRAKE})
            for axis in joint.iterfind("axis"):
                for old in axis.findall("mimic"):
                    axis.remove(old)
    for left in [*model.iter("mimic")]:
        joint = next(left.iterancestors("joint"))
        parent = left.getparent()
        assert parent is not None
        parent.remove(left)
        what = f"it cannot follow {left.get('joint', '')!r} as <mimic> of its axis says"
        yield f"joint {joint.get('name', '')} moves freely: {what}"
