"""The pose of a frame, link or joint in its SDF model, before anything of the model is in a plant."""

from copy import deepcopy
from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.description.drake_log import DRAKE_RAISES, captured_warnings
from drake_twin.description.sdf_document import free_name, modernize
from drake_twin.description.sdf_model import hold_by_links

if TYPE_CHECKING:
    from pydrake.math import RigidTransform


def frame_in_model(model: etree._Element, frame: str) -> "RigidTransform | None":
    """Return the pose of a frame in the model that has it; None if the model has none of this name.

    Args:
        model: The ``<model>``, which is not changed.
        frame: The frame; ``INNER::FRAME`` for one of a model inside that.
    """
    from drake_twin.description.model_frames import model_frames

    root = etree.Element("sdf", version="1.9")
    root.append(deepcopy(model))
    own = root[0]
    own.attrib.pop("placement_frame", "")
    for each in (*own.findall("pose"), *own.findall("static")):  # Drake refuses joints in a static model
        own.remove(each)
    modernize(own)
    for joint in own.iter("joint"):  # whatever it is, and whether Drake knows it
        joint.set("type", "fixed")
        for axis in (*joint.findall("axis"), *joint.findall("axis2")):
            joint.remove(axis)
    asked = free_name("asked", [each.get("name", "") for each in own.iter(etree.Element)])
    etree.SubElement(own, "frame", name=asked, attached_to=frame)
    hold_by_links(own)
    try:
        with captured_warnings():
            found = model_frames(etree.tostring(root, encoding="unicode"))
        return next(frames[asked] for frames in found.values() if asked in frames)
    except (*DRAKE_RAISES, StopIteration):
        return None
