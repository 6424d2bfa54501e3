"""What differs between Gazebo's values of a file and the twin's."""

from collections.abc import Iterator
from math import inf
from typing import NamedTuple

import numpy as np
from gazebo.gazebo_values import transform

SAME = 2e-5  # m and rad: libsdformat prints poses of folded links with six digits


class Difference(NamedTuple):
    """A value that differs: what kind of value, of what, Gazebo's and the twin's."""

    kind: str
    of: str
    gazebo: object
    twin: object


def robot_differences(gazebo, twin) -> Iterator[Difference]:
    """Yield the differences of a robot, of what Gazebo has."""
    links, joints = by_name(twin["links"]), by_name(twin["joints"])
    for link in gazebo["links"]:
        if link["name"] not in links:
            yield Difference("name", f"link {link['name']}", link["name"], None)
            continue
        yield from link_differences(link, links[link["name"]], f"link {link['name']}")
    for joint in gazebo["joints"]:
        if joint["name"] not in joints:
            yield Difference("name", f"joint {joint['name']}", joint["name"], None)
            continue
        yield from joint_differences(joint, joints[joint["name"]])


def link_differences(gazebo, twin, where) -> Iterator[Difference]:
    yield from pose_difference("pose", where, gazebo["pose"], twin["pose"])
    for kind in ("collisions", "sensors"):
        ours = by_name(twin[kind])
        for item in gazebo[kind]:
            of = f"{where}, {kind[:-1]} {item['name']}"
            own = ours.get(item["name"])
            if own is None and kind == "sensors":
                of_camera = [name for name in ours if name.startswith(f"{item['name']}/")]  # of a multicamera
                own = ours[of_camera[0]] if of_camera else None
            if own is None:
                yield Difference("name", of, item["name"], sorted(ours))
                continue
            if not item.get("is_mesh"):  # the twin has the primitive or the hull that it is
                yield from pose_difference("pose", of, item["pose"], own["pose"])
            if kind == "collisions":
                friction = max(0.0, min(item["mu"], item["mu2"]))
                if not np.isclose(friction, own["mu"], rtol=1e-6, atol=1e-9):
                    yield Difference("surface", of, (item["mu"], item["mu2"]), own["mu"])


def joint_differences(gazebo, twin) -> Iterator[Difference]:
    of = f"joint {gazebo['name']}"
    yield from pose_difference("pose", of, gazebo["pose"], twin["pose"])
    kinds = {"continuous": "revolute"}
    if kinds.get(gazebo["type"], gazebo["type"]) != kinds.get(twin["type"], twin["type"]):
        yield Difference("type", of, gazebo["type"], twin["type"])
    for end in ("parent", "child"):
        if gazebo[end] != twin[end]:
            yield Difference("name", f"{end} of {of}", gazebo[end], twin[end])
    if "axis" not in gazebo or twin["type"] in ("fixed", "ball"):
        return
    if not np.allclose(gazebo["axis"], twin["axis"], atol=SAME):
        yield Difference("axis", of, gazebo["axis"], twin["axis"])
    lower, upper, velocity, effort = (inf if value is None else value for value in gazebo["limits"])
    theirs = [lower, upper, *(inf if value < 0 else value for value in (velocity, effort))]  # SDF's "no limit"
    for name, value, own in zip(("lower", "upper", "velocity", "effort"), theirs, twin["limits"], strict=True):
        if not same_bound(value, own):
            yield Difference("limit", f"{name} of {of}", value, own)
    for name in ("damping", "friction"):
        if not np.isclose(gazebo[name], twin[name], rtol=1e-5):
            yield Difference("dynamics", f"{name} of {of}", gazebo[name], twin[name])


def pose_difference(kind, of, gazebo, twin) -> Iterator[Difference]:
    if gazebo is None:  # what it is relative to has been folded away
        return
    X = transform(gazebo).inverse() @ transform(twin)
    angle = X.rotation().ToAngleAxis().angle()
    if np.linalg.norm(X.translation()) > SAME * max(1.0, np.linalg.norm(gazebo[:3])) or angle > SAME:
        yield Difference(kind, of, gazebo, twin)


def same_bound(value, own):
    if abs(value) >= 1e16 or abs(own) >= 1e16:
        return abs(value) >= 1e16 and abs(own) >= 1e16 and (value > 0) == (own > 0)
    return bool(np.isclose(value, own, rtol=1e-5, atol=1e-7))


def by_name(items):
    return {item["name"]: item for item in items}
