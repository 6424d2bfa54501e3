"""Repairs of visuals and collisions: shapes without a size, without geometry, with impossible colours."""

from collections.abc import Collection

from lxml import etree

from drake_twin.description.repairs import Mended, repair
from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.values import number_or_none

_LEAST_SCALE = 1e-8  # of a mesh: Drake refuses a smaller one

_SIZES = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("scale",),
}


@repair("shape_without_size")
def shape_without_size(reader: XmlReader) -> Mended:
    """Leave out a shape without a size: Drake ends the process over it."""
    for kind in ("visual", "collision"):
        for shape in reader.root.findall(f"link/{kind}"):
            for tag, attributes in _SIZES.items():
                for element in shape.iterfind(f"geometry/{tag}"):
                    link = shape.getparent()
                    if link is not None and _has_no_size(element, attributes):
                        text = " ".join(f"{name}={element.get(name, '')!r}" for name in attributes)
                        link.remove(shape)
                        yield shape, f"{described(link)}: a {kind} <{tag} {text}> has no size: it is left out"


def _has_no_size(element: etree._Element, attributes: Collection[str]) -> bool:
    if element.tag == "mesh":  # a negative scale mirrors it, a missing one keeps its size
        sizes = [number_or_none(part) for part in element.get("scale", "1").split()]
        return any(size is not None and abs(size) < _LEAST_SCALE for size in sizes)
    texts = [element.get(name, "").split() for name in attributes]
    return not all(texts) or any(size is not None and size <= 0 for text in texts for size in map(number_or_none, text))


@repair("shape_without_geometry")
def shape_without_geometry(reader: XmlReader) -> Mended:
    """Leave out a visual or collision without a shape."""
    for kind in ("visual", "collision"):
        for shape in reader.root.findall(f"link/{kind}"):
            geometry = shape.find("geometry")
            if geometry is None or not any(child.tag in _SIZES for child in geometry):
                link = shape.getparent()
                assert link is not None
                link.remove(shape)
                yield shape, f"{described(link)}: a {kind} has no shape: it is left out"


@repair("color")
def color(reader: XmlReader) -> Mended:
    """Clamp the parts of a colour to the range from 0 to 1, as RViz draws them."""
    for element in (*reader.root.iterfind("material/color"), *reader.root.iterfind("link/visual/material/color")):
        text = element.get("rgba", "")
        parts = [part for part in map(number_or_none, text.split()) if part is not None]
        if len(parts) == len(text.split()) and any(not 0 <= part <= 1 for part in parts):
            element.set("rgba", " ".join(f"{min(max(part, 0.0), 1.0):g}" for part in parts))
            material = element.getparent()
            yield element, f"{described(element if material is None else material)}: {text!r} is not between 0 and 1"
