"""Flags of URDF's ``<gazebo>`` and of SDF that are neither true nor false."""

from collections.abc import Iterator

from lxml import etree

from drake_twin.description.gazebo_tag import CONVERTED_FLAGS, GRAVITY_OFF, NO, YES
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places

_FLAGS = (
    *(
        *CONVERTED_FLAGS,
        "gravity",
        "kinematic",
        "self_collide",
        "enable_wind",
        "shadows",
        "use_parent_model_frame",
        "cast_shadows",
    ),
)
_ATTRIBUTES = ("degrees", "merge", "default")
_VALUES = ("true", "false", "1", "0", "")


def wrong_flags(reader: XmlReader, root: etree._Element) -> Iterator[Finding]:
    """Report each flag of a robot or a world that is another word, once with all its lines."""
    return at_places(Kind.WARNING, ((what, reader.place(element)) for element, what in _wrong(root)))


def _wrong(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    for element in root.iter(*_FLAGS):
        text = (element.get("value") or element.text or "").strip()
        above = "" if (parent := element.getparent()) is None else str(parent.tag)
        is_vector = element.tag == "gravity" and above in ("world", "physics")
        is_converted = above == "gazebo" and element.tag in CONVERTED_FLAGS
        valid = (*YES, *NO, "") if is_converted else _VALUES
        if not is_vector and not len(element) and text.lower() not in valid:
            counts = str(element.tag == GRAVITY_OFF).lower()
            yield element, f"<{element.tag}> is {text!r}, which is neither true nor false: it counts as {counts}"
    for tag in ("pose", "include", "physics"):
        for element in root.iter(tag):
            for name in (name for name in _ATTRIBUTES if element.get(name, "").strip().lower() not in _VALUES):
                text = element.get(name, "")
                yield element, f"{name} of <{tag}> is {text!r}, which is neither true nor false: it counts as false"
