"""Caster balls: a ball joint whose child link is a sphere, or spheres, about the joint's centre.

A ball that rolls freely keeps its base at its height and does not resist the base's motion. A frictionless sphere does
the same, and on its joint it moves exactly as if it were welded on with all its mass in its centre. The ball is
replaced by that: it costs least, and moves alike in every engine. What is lost is the spin of the ball, and the force
that it takes to spin it up (0.4 of the ball's mass more to accelerate).
"""

from collections.abc import Iterator

import numpy as np
from lxml import etree

from drake_twin.description.sdf_pose import pose_transform

_OFF_CENTER = 0.02  # of the radius


def weld_caster_balls(model: etree._Element) -> Iterator[str]:
    """Change the ball joints of caster balls to fixed ones, and the balls to frictionless point masses.

    A pose that is relative to a frame other than the link's own is not followed: that joint stays a ball joint.

    Args:
        model: The model, with Drake's friction, and ``<sphere>``s in place of collision meshes that are spheres.

    Yields:
        What was changed.
    """
    for each in model.iter("model"):
        links = {link.get("name"): link for link in each.findall("link")}
        joints = each.findall("joint")
        ends = [(joint.findtext(end) or "").strip() for joint in joints for end in ("parent", "child")]
        for joint in joints:
            link = links.get((joint.findtext("child") or "").strip())
            if joint.get("type") == "ball" and link is not None and ends.count(link.get("name", "")) == 1:
                center = _center(joint, link)
                if center is not None and _is_ball(link, center):
                    joint.set("type", "fixed")
                    _make_frictionless_point(link)
                    yield f"joint {joint.get('name', '')}: its caster ball slides without friction instead of rolling"


def _center(joint: etree._Element, link: etree._Element) -> np.ndarray | None:
    """Return the joint's centre in the link's frame (m); None where other frames would have to be followed."""
    pose, own = joint.find("pose"), link.find("pose")
    try:
        if pose is None:
            return np.zeros(3)
        if pose.get("relative_to", "") in ("", link.get("name")):
            return np.asarray(pose_transform(pose).translation())
        if own is not None and own.get("relative_to") == joint.get("name"):
            return np.asarray(pose_transform(own).inverse().translation())
    except ValueError:  # Drake's parser reports it
        pass
    return None


def _is_ball(link: etree._Element, center: np.ndarray) -> bool:
    """Tell whether a link has collision shapes, all of them spheres about a point (m)."""
    shapes = link.findall("collision")
    return bool(shapes) and all(_is_sphere_about(shape, center, link) for shape in shapes)


def _is_sphere_about(shape: etree._Element, center: np.ndarray, link: etree._Element) -> bool:
    radius, pose = shape.findtext("geometry/sphere/radius"), shape.find("pose")
    if radius is None or (pose is not None and pose.get("relative_to", "") not in ("", link.get("name"))):
        return False
    try:
        place = np.zeros(3) if pose is None else pose_transform(pose).translation()
    except ValueError:
        return False
    return bool(np.linalg.norm(place - center) <= _OFF_CENTER * float(radius))


def _make_frictionless_point(link: etree._Element) -> None:
    for coefficient in link.iterfind("collision/{*}proximity_properties/*"):
        coefficient.text = "0"
    inertial = link.find("inertial")
    if inertial is None:
        inertial = etree.SubElement(link, "inertial")
    for inertia in inertial.findall("inertia"):
        inertial.remove(inertia)
    inertia = etree.SubElement(inertial, "inertia")
    for moment in ("ixx", "iyy", "izz"):
        etree.SubElement(inertia, moment).text = "0"
