"""Models inside a model of SDF: joints between them, and robots that consist of several."""

import re
from collections.abc import Iterator, Mapping
from copy import deepcopy

from lxml import etree

from drake_twin.description.sdf_defaults import asks_for_nothing
from drake_twin.description.sdf_document import free_name, modernize
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places

_FLAGS = ("self_collide", "enable_wind")  # of a model, for its links
_REFERENCES = ("relative_to", "attached_to", "expressed_in")
_NAMES_OF_OTHERS = re.compile(r"(.*_)?(topic|namespace)", re.IGNORECASE)


def join_across_models(model: etree._Element) -> Iterator[str]:
    """Move each joint that holds a link of a model around its own there.

    Gazebo classic searches for a joint's links from the joint's model outwards, and files such as RMF's lifts, whose
    doors slide along the cabin, count on it. Gazebo Sim resolves names inside the model only, and makes no such joint.

    Args:
        model: The outermost model.

    Yields:
        What was changed.
    """
    moved: dict[tuple[str, str], list[str]] = {}
    for nested in [*model.iter("model")][:0:-1]:  # the innermost first
        for joint in nested.findall("joint"):
            ends = [end for end in (joint.find("parent"), joint.find("child")) if end is not None]
            absent = [end for end in ends if not _is_in_scope(end.text, nested)]
            found = _around(nested, [(end.text or "").strip() for end in absent]) if absent else None
            if found is None:
                continue
            above, path = found
            modernize(joint)
            inside = [end for end in ends if end not in absent and (end.text or "").strip() != "world"]
            for end in inside:
                end.text = f"{path}::{(end.text or '').strip()}"
            _prefix(joint, f"{path}::")
            names = ", ".join(repr((end.text or "").strip()) for end in absent)
            moved.setdefault((path, names), []).append(joint.get("name", ""))
            joint.set("name", free_name(f"{path.replace('::', '_')}_{joint.get('name', '')}", _names(above)))
            above.append(joint)
    for (path, names), joints in moved.items():
        yield (
            f"{', '.join(joints)} of the model {path} inside it: joined to {names} of the model around, as in Gazebo"
            " classic; Gazebo Sim makes no such joint"
        )


def _is_in_scope(text: str | None, model: etree._Element) -> bool:
    name = (text or "").strip()
    return "::" in name or name in ("", "world", "__model__") or name in _names(model)


def _names(model: etree._Element) -> set[str]:
    return {child.get("name", "") for tag in ("link", "joint", "frame", "model") for child in model.findall(tag)}


def _around(nested: etree._Element, names: list[str]) -> tuple[etree._Element, str] | None:
    """Return the nearest model around one that has all names, and the path from there."""
    path = nested.get("name", "")
    above = nested.getparent()
    while above is not None and above.tag == "model":
        if _names(above).issuperset(names):
            return above, path
        path = f"{above.get('name', '')}::{path}"
        above = above.getparent()
    return None


def _prefix(element: etree._Element, prefix: str) -> None:
    """Put a model's path before the frames that an element and what is in it name."""
    for each in element.iter(etree.Element):
        for attribute in _REFERENCES:
            if (name := each.get(attribute)) and name != "world":
                each.set(attribute, prefix + name)


def flatten_models(model: etree._Element, reader: XmlReader) -> Iterator[Finding]:
    """Move what the models inside a robot's model hold into it, under names such as ``arm_elbow``.

    Names such as ``arm::elbow`` in the robot, its plugins included, follow.

    Args:
        model: The robot's model.
        reader: The document it stands in.

    Yields:
        What was changed and what was left out.

    Raises:
        InputError: If a model inside has a ``placement_frame``.
    """
    yield from (Finding.at(Kind.WARNING, what, reader.place(model)) for what in join_across_models(model))
    lost: list[etree._Element] = []
    _flatten(model, reader, lost)
    yield from at_places(
        Kind.IGNORED, ((f"<{each.tag}> of a model inside the robot's", reader.place(each)) for each in lost)
    )


def _flatten(model: etree._Element, reader: XmlReader, lost: list[etree._Element]) -> dict[str, str]:
    """Dissolve the models inside a model; return scoped name → name in the model."""
    scoped: dict[str, str] = {}
    for nested in model.findall("model"):
        if nested.get("placement_frame"):
            raise reader.error(nested, "the placement_frame of a model inside a robot is not supported")
        modernize(nested)
        inner = _flatten(nested, reader, lost)
        own, taken = reader.text(nested, "name"), _names(model)
        names: dict[str, str] = {}
        for name in (*_names(nested), "__model__"):
            names[name] = free_name(f"{own}_{name.strip('_') if name == '__model__' else name}", taken)
            taken.add(names[name])
        rename(nested, names)
        scoped |= {f"{own}::{name}": new for name, new in names.items()}
        scoped |= {f"{own}::{name}": names[middle] for name, middle in inner.items() if middle in names}
        scoped[own] = names["__model__"]
        links = [link.get("name", "") for link in nested.findall("link")]
        canonical_link = names.get(nested.get("canonical_link", ""), links[0] if links else "")
        _move(nested, model, names["__model__"], canonical_link, lost)
    rename(model, scoped)
    return scoped


def _move(
    nested: etree._Element, model: etree._Element, frame: str, canonical_link: str, lost: list[etree._Element]
) -> None:
    """Move what a model holds into the one around it.

    Args:
        nested: The model.
        model: The one around it.
        frame: The name of its frame there.
        canonical_link: The link that its frame is attached to, so that joints can name the model.
        lost: What is left out is added.
    """
    placed = etree.SubElement(model, "frame", name=frame)
    if nested.find("pose") is None:
        etree.SubElement(nested, "pose").text = "0 0 0 0 0 0"
    if canonical_link:
        placed.set("attached_to", canonical_link)
    flags = [flag for tag in _FLAGS if (flag := nested.find(tag)) is not None]
    for child in list(nested):
        if child.tag == "pose":
            placed.append(child)
            if canonical_link and not child.get("relative_to"):
                child.set("relative_to", "__model__")
        elif child.tag in ("link", "frame", "joint", "plugin"):
            model.append(child)
            if child.tag == "frame" and not child.get("attached_to"):
                child.set("attached_to", frame)
            if child.tag == "link":
                _place(child, frame)
            for flag in flags if child.tag == "link" else ():
                if child.find(flag.tag) is None:
                    child.append(deepcopy(flag))
        elif child not in flags and isinstance(child.tag, str) and not asks_for_nothing(child):
            lost.append(child)
    model.remove(nested)


def _place(link: etree._Element, frame: str) -> None:
    pose = link.find("pose")
    if pose is None:
        pose = etree.SubElement(link, "pose")
        pose.text = "0 0 0 0 0 0"
    if not pose.get("relative_to"):
        pose.set("relative_to", frame)


def rename(model: etree._Element, names: Mapping[str, str]) -> None:
    """Rename a model's own parts, and each reference to one; the texts of plugins are such where they are names.

    The model's own pose is relative to what is around it.
    """
    pose = model.find("pose")
    for child in model:
        if child.tag in ("link", "joint", "frame") and child.get("name") in names:
            child.set("name", names[child.get("name", "")])
    for element in model.iter(etree.Element):
        others = ("joint",) if element.tag == "mimic" else ()
        for attribute in (*_REFERENCES, *others) if element is not pose else ():
            if element.get(attribute) in names:
                element.set(attribute, names[element.get(attribute, "")])
        text = (element.text or "").strip()
        if text in names and (element.tag in ("parent", "child") or _may_name_a_part(element)):
            element.text = names[text]


def _may_name_a_part(element: etree._Element) -> bool:
    """Tell whether an element of a plugin may name a link, a joint or a model; not so a topic of that name."""
    if next(element.iterancestors("plugin"), None) is None:
        return False
    return _NAMES_OF_OTHERS.fullmatch(str(element.tag)) is None
