"""The ``<include>``s of an MJCF file, and its sections that stand in several places, as MuJoCo reads them.

Drake's parser resolves an include against the working directory. Here its content takes its place before that.
https://mujoco.readthedocs.io/en/stable/XMLreference.html#include
"""

import os
from pathlib import Path

from lxml import etree

from drake_twin.description.source_file import read_xml
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Place

_NUMBER = "place-of-an-include"  # the attribute that keeps an element's place while it is moved


def included(reader: XmlReader, file: Path) -> XmlReader:
    """Return a document with the content of its includes in their places, and each of its sections once.

    A name is searched beside the file that has the include, then beside the main file.

    Args:
        reader: The document; it is changed if it has no includes.
        file: Its file.

    Raises:
        InputError: If an included file does not exist, is empty, is not well-formed, or is included twice.
    """
    if next(reader.root.iter("include"), None) is not None:
        places: list[Place] = []
        _mark(reader, places)
        _expand(reader, file, file, [file.resolve()], (file.resolve(),), places)
        order = [places[int(element.attrib.pop(_NUMBER))] for element in reader.root.iter(etree.Element)]
        reader = XmlReader(etree.tostring(reader.root, encoding="unicode"), file, places=order)
    _join_sections(reader.root)
    return reader


def _mark(reader: XmlReader, places: list[Place]) -> None:
    for element in reader.root.iter(etree.Element):
        element.set(_NUMBER, str(len(places)))
        places.append(reader.place(element))


def _expand(
    reader: XmlReader, file: Path, main: Path, seen: list[Path], above: tuple[Path, ...], places: list[Place]
) -> None:
    for include in list(reader.root.iter("include")):
        place = places[int(include.get(_NUMBER, ""))]
        name = include.get("file")
        if not name or len(include):
            raise _error(place, "<include> needs a file, and cannot have elements of its own")
        found = next((path for path in (file.parent / name, main.parent / name) if os.path.isfile(path)), None)
        if found is None:
            raise _error(place, f"the included file {name!r} does not exist", name)
        resolved = found.resolve()
        if resolved in above:
            chain = " → ".join(path.name for path in (*above, resolved))
            raise _error(place, f"the file includes itself: {chain}")
        if resolved in seen:
            raise _error(place, f"the file {name!r} is included twice", name)
        seen.append(resolved)
        inner = XmlReader(read_xml(found, "included file"), found)
        if not len(inner.root):
            raise _error(place, f"the included file {name!r} is empty", name)
        _mark(inner, places)
        _expand(inner, found, main, seen, (*above, resolved), places)
        parent = include.getparent()
        assert parent is not None, "an <include> is not the document"
        index = parent.index(include)
        parent[index : index + 1] = list(inner.root)


def _error(place: Place, message: str, value: str | None = None) -> InputError:
    return InputError(message, file=place.file or None, line=place.line, value=value)


def _join_sections(root: etree._Element) -> None:
    """Move the content of sections that stand in several places into the first of each; later values count."""
    first: dict[str, etree._Element] = {}
    for section in [item for item in root if isinstance(item.tag, str)]:
        known = first.setdefault(str(section.tag), section)
        if known is not section:
            known.attrib.update(section.attrib)
            for child in list(section):
                own = known.find(str(child.tag)) if section.tag == "default" and child.tag != "default" else None
                if own is None:
                    known.append(child)
                else:
                    own.attrib.update(child.attrib)
            root.remove(section)
