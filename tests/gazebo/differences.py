"""What differs between Gazebo's values of a file and the twin's, and which of it is so on purpose."""

from collections.abc import Iterator, Mapping
from math import inf
from typing import Any, NamedTuple

import numpy as np

from gazebo.gazebo_values import transform

SAME = 2e-5  # m and rad: libsdformat writes the poses of folded links with six digits

# urdfdom takes a pitch within 4.5e-3 rad of 90 degrees for 90 degrees, wherever libsdformat folds or writes a pose.
UPRIGHT, NEARLY_UPRIGHT = 0.99999, 5e-3


# Older name of a kind of sensor → the one that libsdformat prints.
SYNONYMS = {"ray": "lidar", "gpu_ray": "gpu_lidar", "depth": "depth_camera", "wideanglecamera": "wide_angle_camera"}
SYNONYMS |= {"gps": "navsat", "rgbd": "rgbd_camera", "thermal": "thermal_camera"}
SYNONYMS |= {"segmentation": "segmentation_camera", "boundingbox": "boundingbox_camera"}
NEWER = ("air_speed",)  # kinds that libsdformat 12 does not know yet


class Difference(NamedTuple):
    """A value that differs: what kind of value, of what, Gazebo's, the twin's, and why if it is so on purpose."""

    kind: str
    of: str
    gazebo: object
    twin: object
    reason: str = ""


_FLAT = "the models of a robot are one, whose parts have flat names"


def _flat(name: str) -> str:
    """Return the name of a part of a robot of several models: ``arm_elbow`` for ``arm::elbow``."""
    return name.replace("::", "_")


def robot_differences(gazebo: Mapping[str, Any], twin: Mapping[str, Any]) -> Iterator[Difference]:
    """Yield the differences of a robot, of what Gazebo has."""
    links, joints = by_name(twin["links"]), by_name(twin["joints"])
    for link in gazebo["links"]:
        if link["name"] not in links:
            part = links.get(_flat(link["name"]))
            yield Difference("name", f"link {link['name']}", link["name"], None, "" if part is None else _FLAT)
            if part is not None:
                yield from pose_difference(f"link {link['name']}", link["pose"], part["pose"])
            continue
        yield from link_differences(link, links[link["name"]], f"link {link['name']}", twin.get("casters", ()))
    for joint in gazebo.get("joints", ()):
        if joint["name"] not in joints:
            reason = "a joint to the world fixes the robot where it is spawned" if joint["parent"] == "world" else ""
            reason = _FLAT if _flat(joint["name"]) in joints else reason
            yield Difference("name", f"joint {joint['name']}", joint["name"], None, reason)
            continue
        ambiguous = {each["name"] for each in gazebo["joints"]} & {*links}
        yield from joint_differences(joint, joints[joint["name"]], ambiguous, twin.get("casters", ()))


def link_differences(
    gazebo: Mapping[str, Any], twin: Mapping[str, Any], where: str, casters: Any = ()
) -> Iterator[Difference]:
    """Yield the differences of a link, its collision shapes and its sensors."""
    yield from pose_difference(where, gazebo["pose"], twin["pose"])
    if twin.get("self_collide", gazebo["self_collide"]) != gazebo["self_collide"]:
        yield Difference("surface", where, gazebo["self_collide"], twin["self_collide"])
    for kind in ("collisions", "sensors"):
        ours = by_name(twin[kind])
        for item in gazebo.get(kind, ()):
            of = f"{where}, {kind[:-1]} {item['name']}"
            own = ours.get(item["name"])
            if own is None and kind == "sensors":
                own = next((each for name, each in ours.items() if name.startswith(f"{item['name']}/")), None)
            if own is None:
                reason = "a shape that Drake cannot have, or whose mesh is missing, is left out" if twin["lost"] else ""
                yield Difference("name", of, item["name"], sorted(ours), reason)
                continue
            if kind == "sensors" and own["type"] in NEWER:
                yield Difference("sensor", of, item["type"], own["type"], "libsdformat 12 does not know this kind yet")
                continue
            if not item.get("is_other"):  # the twin has a mesh's hull or the primitive that it is, and a plane's slab
                yield from pose_difference(of, item["pose"], own["pose"])
            for name in ("type", "topic", "rate") if kind == "sensors" else ():
                value = SYNONYMS.get(own[name], own[name]) if name == "type" else own[name]
                if item[name] != value:
                    yield Difference("sensor", f"{name} of {of}", item[name], own[name])
            if kind == "collisions":
                friction = max(0.0, min(item["mu"], item["mu2"]))
                if not np.isclose(friction, own["mu"], rtol=1e-6, atol=1e-9):
                    reason = "a caster's ball slides instead of rolling" if gazebo["name"] in casters else ""
                    yield Difference("surface", of, (item["mu"], item["mu2"]), own["mu"], reason)


def joint_differences(
    gazebo: Mapping[str, Any], twin: Mapping[str, Any], ambiguous: Any = (), casters: Any = ()
) -> Iterator[Difference]:
    """Yield the differences of a joint."""
    of = f"joint {gazebo['name']}"
    if gazebo["child"] in casters:
        yield Difference("type", of, gazebo["type"], twin["type"], "a caster's ball slides instead of rolling")
        return
    if gazebo["type"] in ("universal", "screw", "revolute2", "gearbox"):
        yield Difference("type", of, gazebo["type"], twin["type"], "Drake has its own frames and no limits for these")
        return
    yield from pose_difference(of, gazebo["pose"], twin["pose"])
    kinds = {"continuous": "revolute"}
    if kinds.get(gazebo["type"], gazebo["type"]) != kinds.get(twin["type"], twin["type"]):
        reason = "an unmoved joint stays fixed" if twin["type"] == "fixed" and gazebo["limits"][:2] == [0, 0] else ""
        yield Difference("type", of, gazebo["type"], twin["type"], reason)
    for end in ("parent", "child"):
        if gazebo[end] != twin[end]:
            reason = "a joint has the name of a link" if twin[end] in ambiguous else ""
            reason = _FLAT if twin[end] == _flat(gazebo[end]) else reason
            yield Difference("name", f"{end} of {of}", gazebo[end], twin[end], reason)
    if "axis" not in gazebo or twin["type"] in ("fixed", "ball"):
        return
    if not np.allclose(gazebo["axis"], twin["axis"], atol=SAME):
        reason = "a joint has the name of a link" if ambiguous else ""
        yield Difference("axis", of, gazebo["axis"], twin["axis"], reason)
    lower, upper, velocity, effort = (inf if value is None else value for value in gazebo["limits"])
    theirs = [lower, upper, *(inf if value < 0 else value for value in (velocity, effort))]  # SDF's "no limit"
    for name in ("damping", "friction"):
        if not np.isclose(gazebo[name], twin[name], rtol=1e-5):
            yield Difference("dynamics", f"{name} of {of}", gazebo[name], twin[name])
    for name, value, own in zip(("lower", "upper", "velocity", "effort"), theirs, twin["limits"], strict=True):
        if not same_bound(value, own):
            is_zero = value == 0.0 and own == inf and name in ("velocity", "effort")
            reason = "a limit of zero means that the file has none" if is_zero else ""
            yield Difference("limit", f"{name} of {of}", value, own, reason)


def pose_difference(of: str, gazebo: Any, twin: Any) -> Iterator[Difference]:
    """Yield the difference of two poses, if any."""
    if gazebo is None:
        yield Difference("pose", of, None, twin, "what it is relative to is folded away, so that it has no pose")
        return
    X_G, X_T = transform(gazebo), transform(twin)
    X = X_G.inverse() @ X_T
    angle = X.rotation().ToAngleAxis().angle()
    same = np.linalg.norm(X.translation()) <= SAME * max(1.0, np.linalg.norm(gazebo[:3]))
    if not same or angle > SAME:
        is_upright = max(abs(X_G.rotation().matrix()[2, 0]), abs(X_T.rotation().matrix()[2, 0])) > UPRIGHT
        reason = "urdfdom rounds a pitch near 90 degrees" if same and is_upright and angle < NEARLY_UPRIGHT else ""
        yield Difference("pose", of, gazebo, twin, reason)


def same_bound(value: float, own: float) -> bool:
    """Tell whether two bounds are the same; SDF has 1e16 for none."""
    if abs(value) >= 1e16 or abs(own) >= 1e16:
        return abs(value) >= 1e16 and abs(own) >= 1e16 and (value > 0) == (own > 0)
    return bool(np.isclose(value, own, rtol=1e-5, atol=1e-7))


def by_name(items: Any) -> dict[str, Any]:
    """Return name → item."""
    return {item["name"]: item for item in items}
