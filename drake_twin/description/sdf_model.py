"""A ``<model>`` of an SDF file, prepared for Drake's parser: what Drake cannot use is removed and reported.

Each rule is one function on the XML tree of the file that the model stands in, applied by `mend_model`.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from pathlib import Path

import numpy as np
from lxml import etree

from drake_twin.description.caster_balls import weld_caster_balls
from drake_twin.description.possible_inertia import LEAST_MASS, MOMENTS, possible_inertia
from drake_twin.description.robot_description import NO_LIMIT
from drake_twin.description.sdf_defaults import asks_for_nothing
from drake_twin.description.sdf_document import free_name, has_weight, is_within_static, number_in, sdf_version
from drake_twin.description.sdf_mimic import couple
from drake_twin.description.sdf_nested import join_across_models, rename
from drake_twin.description.sdf_shapes import FindFile, mend_meshes, mend_planes, mend_shapes
from drake_twin.description.used_elements import weight_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Cause, Finding, Kind, Weight
from drake_twin.values import is_true

# What Drake's parser is given of each element; of the rest there are findings.
KEPT = {
    "model": {"static", "pose", "link", "joint", "frame", "model"},
    "link": {"pose", "inertial", "collision", "visual", "kinematic", "gravity"},
    "joint": {"parent", "child", "pose", "axis", "axis2", "screw_thread_pitch", "thread_pitch"},
    "axis": {"xyz", "limit", "dynamics", "use_parent_model_frame", "mimic"},
    "axis2": {"xyz", "limit", "dynamics", "use_parent_model_frame", "mimic"},
    "collision": {"pose", "geometry", "surface"},
    "visual": {"pose", "geometry", "material", "transparency"},
}
# They do not affect the motion, and are not worth a finding.
_SILENT = {"allow_auto_disable", "must_be_base_link", "max_contacts", "laser_retro", "cast_shadows", "meta", "physics"}
_SILENT |= {"visibility_flags", "plugin_data", "density", "auto_inertia_params", "audio_sink", "lighting"}
_SILENT |= {"description", "origin", "pose_publish", "enable_wind"}

_LIMITLESS = ("ball", "universal", "screw")
_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "planar", *_LIMITLESS)


def mend_model(model: etree._Element, reader: XmlReader, find: FindFile) -> list[Finding]:
    """Change a model so that Drake's parser accepts it, except for the meshes and planes of static models.

    Args:
        model: The element, with its includes replaced.
        reader: The document it stands in.
        find: Resolves an address in a file.

    Returns:
        What was left out and what was changed, each once.
    """
    found = [Finding(Kind.WARNING, what) for what in _auto_inertias(model, reader, find)]
    unknown = [
        Finding(Kind.IGNORED, what, weight=weight, cause=Cause.UNREAD) for what, weight in _unknown_elements(model)
    ]
    if sdf_version(reader.root) >= (1, 7):  # Gazebo does not know it any more, Drake refuses it
        for axis in [*model.iter("axis", "axis2")]:
            for old in axis.findall("use_parent_model_frame"):
                axis.remove(old)
    hold_by_links(model)
    for rule in (_frames_of_old_poses, _names, join_across_models, _joints, couple, _inertias):
        found += (Finding(Kind.WARNING, what) for what in rule(model))
    found += (Finding(Kind.WARNING, what, weight=weight) for what, weight in mend_shapes(model))
    mend_planes(model)
    meshes = mend_meshes(model, reader, find)
    found += (Finding(Kind.WARNING, what, weight=weight, cause=Cause.MESH) for what, weight in meshes)
    found += (Finding(Kind.WARNING, what, cause=Cause.CONTACT) for what in weld_caster_balls(model))
    for nested in [*model.iter("model")][:0:-1]:  # the innermost first
        parent = nested.getparent()
        if parent is not None and nested.find("link") is None and nested.find("model") is None:
            parent.remove(nested)
    return [
        replace(finding, what=finding.what + (f" ({count} times)" if count > 1 else ""))
        for finding, count in Counter((*unknown, *found)).items()
    ]


def _auto_inertias(model: etree._Element, reader: XmlReader, find: FindFile) -> Iterator[str]:
    if model.find(".//link/inertial[@auto]") is None:
        return
    from drake_twin.description.auto_inertia import give_auto_inertias

    yield from give_auto_inertias(model, reader, find)


def hold_by_links(model: etree._Element) -> None:
    """Attach the frames that a joint holds to its child link: Drake places them there without the joint's own pose."""
    for each in model.iter("model"):
        children = {joint.get("name"): (joint.findtext("child") or "").strip() for joint in each.findall("joint")}
        for frame in each.findall("frame"):
            joint = frame.get("attached_to", "")
            if joint in children:
                pose = frame.find("pose")
                pose = etree.SubElement(frame, "pose") if pose is None else pose
                pose.text = pose.text if (pose.text or "").split() else "0 0 0 0 0 0"
                pose.set("relative_to", pose.get("relative_to") or joint)
                frame.set("attached_to", children[joint])


def falls(model: etree._Element) -> bool:
    """Tell whether gravity acts on a model: not where all its links have ``<gravity>false``."""
    links = [*model.iter("link")]
    return not links or any(map(has_weight, links))


def _unknown_elements(model: etree._Element) -> Iterator[tuple[str, Weight]]:
    falling = falls(model)
    for parent in [*model.iter(*KEPT)]:
        for child in list(parent):
            if child.tag in KEPT[str(parent.tag)]:
                continue
            weight, is_default = weight_of(child), asks_for_nothing(child)
            parent.remove(child)
            if isinstance(child.tag, str) and child.tag not in _SILENT and not is_default:
                named = child.get("filename") or child.get("type") or ""
                named = f" {Path(named).name}" if child.tag in ("plugin", "sensor") else ""
                yield f"<{etree.QName(child).localname}>{named} is not used", weight
    for inertial in model.iter("inertial"):
        for child in list(inertial):
            if child.tag not in ("mass", "inertia", "pose"):
                inertial.remove(child)
    for link in model.iter("link"):
        for flag in [*link.findall("gravity"), *link.findall("kinematic")]:
            link.remove(flag)
            is_gravity = flag.tag == "gravity"
            if (
                is_gravity != is_true(flag.text or str(is_gravity))
                and not is_within_static(link)
                and (falling or not is_gravity)
            ):
                yield f"<{flag.tag}>{(flag.text or '').strip()}</{flag.tag}> of a link is not used", Weight.MOVES


def _frames_of_old_poses(model: etree._Element) -> Iterator[str]:
    """Remove ``<pose frame="…">``, which never had a meaning in Gazebo but has one for newer parsers."""
    for pose in model.iter("pose"):
        pose.attrib.pop("frame", "")
        if not (pose.text or "").split():
            pose.text = "0 0 0 0 0 0"
    yield from ()


def _names(model: etree._Element) -> Iterator[str]:
    """Give shapes unique names, and flattened models plain ones.

    Gazebo classic saved nested models as one, with links named ``inner::link``, which newer parsers take apart.
    """
    for each in model.iter("model"):
        _rename_flattened(each)
        yield from _same_names(each)
    for link in model.iter("link"):
        for tag in ("collision", "visual"):
            taken: set[str] = set()
            for index, shape in enumerate(link.findall(tag)):
                if not shape.get("name", "").strip() or shape.get("name", "") in taken:
                    shape.set("name", f"{shape.get('name') or tag}_{index}")
                taken.add(shape.get("name", ""))


def _same_names(model: etree._Element) -> Iterator[str]:
    """Give a model inside a model a name of its own, and leave out frames whose names are taken."""
    taken = {child.get("name", "") for tag in ("link", "joint") for child in model.findall(tag)}
    for child in (*model.findall("model"), *model.findall("frame")):
        name = child.get("name", "")
        if name not in taken:
            taken.add(name)
        elif child.tag == "frame":
            model.remove(child)
            yield f"a <frame> has the name of another part, {name}: it is left out"
        else:
            child.set("name", free_name(name, taken))
            taken.add(child.get("name", ""))
            yield f"a model inside it has the name of another part, {name}: it is called {child.get('name')}"


def _rename_flattened(model: etree._Element) -> None:
    taken: set[str] = set()
    renamed: dict[str, str] = {}
    for child in model:
        if child.tag in ("link", "joint", "frame"):
            old = child.get("name", "")
            new = free_name(old.replace("::", "_"), taken) if "::" in old else old
            child.set("name", new)
            taken.add(new)
            if new != old:
                renamed.setdefault(old, new)
    if renamed:
        rename(model, renamed)


def _joints(model: etree._Element) -> Iterator[str]:
    for joint in [*model.iter("joint")]:
        kind = joint.get("type", "")
        if is_within_static(joint):
            _fix_for_good(joint)
        elif kind not in _JOINTS:
            joint.set("type", "fixed")
            yield f"joint {joint.get('name', '')} is fixed: Drake does not support {kind or 'nameless'} joints"
        elif kind in _LIMITLESS and any(map(_is_bound, joint.iterfind("*/limit/*"))):
            yield f"joint {joint.get('name', '')} moves without limits: Drake does not support limits of {kind} joints"
        for limit in joint.iterfind("axis/limit"):
            lower, upper = limit.find("lower"), limit.find("upper")
            low, high = number_in(lower), number_in(upper)
            if lower is not None and upper is not None and low is not None and high is not None and low > high:
                lower.text, upper.text = upper.text, lower.text
                yield f"joint {joint.get('name', '')}: lower {low:g} is above upper {high:g}: they are swapped"


def _is_bound(limit: etree._Element) -> bool:
    value = number_in(limit)
    if value is None or limit.tag not in ("lower", "upper", "velocity") or abs(value) >= NO_LIMIT:
        return False
    return limit.tag != "velocity" or value >= 0  # a negative one is SDF's old default


def _fix_for_good(joint: etree._Element) -> None:
    """Remove a joint of a static model; make it fixed where a pose is relative to it."""
    parent = joint.getparent()
    assert parent is not None
    name = joint.get("name")
    if any(pose.get("relative_to") == name for pose in parent.iter("pose")):
        joint.set("type", "fixed")
    else:
        parent.remove(joint)


def _inertias(model: etree._Element) -> Iterator[str]:
    for link in model.iter("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        if is_within_static(link):
            link.remove(inertial)
            continue
        mass_element = inertial.find("mass")
        mass = 1.0 if mass_element is None else number_in(mass_element)
        inertia = inertial.find("inertia")
        if mass is None or not isfinite(mass) or mass <= 0:
            given = mass
            for child in list(inertial):
                if child.tag != "pose":
                    inertial.remove(child)
            etree.SubElement(inertial, "mass").text = f"{LEAST_MASS:g}"
            inertia, mass = etree.SubElement(inertial, "inertia"), LEAST_MASS
            _set_inertia(inertia, possible_inertia(mass, np.zeros((3, 3)))[0])
            weight = f"its mass is {given:g}, below zero" if given is not None and given < 0 else "has no mass"
            yield f"link {link.get('name', '')} moves, but {weight}: it weighs {LEAST_MASS:g} kg"
        elif inertia is not None:
            tensor = _inertia(inertia)
            if tensor is not None:
                possible, why = possible_inertia(mass, tensor)
                if why is not None:
                    _set_inertia(inertia, possible)
                    yield f"link {link.get('name', '')}: {why}"


def _inertia(element: etree._Element) -> np.ndarray | None:
    tensor = np.eye(3)  # SDF's default
    for name, (row, column) in MOMENTS.items():
        child = element.find(name)
        value = tensor[row, column] if child is None else number_in(child)
        if value is None or not isfinite(value):
            return None  # Drake's parser reports it
        tensor[row, column] = tensor[column, row] = value
    return tensor


def _set_inertia(element: etree._Element, tensor: np.ndarray) -> None:
    for child in list(element):
        element.remove(child)
    for name, (row, column) in MOMENTS.items():
        etree.SubElement(element, name).text = f"{float(tensor[row, column]):.17g}"
