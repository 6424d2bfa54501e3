"""Poses of an SDF model that are relative to frames that it does not have."""

from collections.abc import Iterator

from lxml import etree

_SHAPES = ("link/collision", "link/visual", "link/sensor", "joint/sensor")


def forget_unknown_frames(model: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """Let a pose that is relative to a frame that its model lacks be relative to the link or joint around it.

    gz-sim does so for what a link or a joint holds (`ResolveSdfPose` of `SdfEntityCreator.cc`). For links, joints and
    frames libsdformat refuses the file.

    Args:
        model: The ``<model>``; it is changed, as are the models inside it.

    Yields:
        Each changed ``<pose>``, with what was changed.
    """
    for each in [*model.iter("model")]:
        for holder in (found for path in _SHAPES for found in each.findall(path)):
            pose = holder.find("pose")
            frame = "" if pose is None else (pose.get("relative_to") or "").strip()
            if pose is None or not frame or _has_frame(each, frame):
                continue
            del pose.attrib["relative_to"]
            above = holder.getparent()
            assert above is not None
            what = f"{holder.tag} {holder.get('name', '')!r}: its pose is relative to the unknown frame {frame!r}"
            yield pose, f"{what}; it is taken as relative to the {above.tag} {above.get('name', '')!r}, as in Gazebo"


def _has_frame(model: etree._Element, frame: str) -> bool:
    """Tell whether a model has a frame; ``INNER::FRAME`` is one of a model inside it."""
    own, _, inside = frame.partition("::")
    if inside:
        inner = next((each for each in model.findall("model") if each.get("name") == own), None)
        if inner is not None:
            return _has_frame(inner, inside)
    names = {child.get("name") for tag in ("link", "joint", "frame", "model") for child in model.findall(tag)}
    return frame == "__model__" or frame in names
