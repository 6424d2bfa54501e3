"""The model of an SDF robot's file where the file includes it, or parts of it, from other files."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.sdf_document import sdf_version
from drake_twin.description.sdf_includes import SdfIncludes
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Place, Weight

_COMMENT_OR_INCLUDE = re.compile(
    r"<!--.*?-->|<include\b(?:\"[^\"]*\"|'[^']*'|[^>\"'])*(?:(?<=/)>|>.*?</include\s*>)", re.DOTALL
)


class ModelText(NamedTuple):
    """An SDF file's text, the file that it comes from, and what of the file that includes it is not used."""

    text: str
    file: Path
    findings: tuple[Finding, ...] = ()


def included_model(text: str, file: Path, packages: PackageIndex) -> ModelText:
    """Return the model that an SDF file includes, or the file's own model with what it includes.

    A file that is only an ``<include>`` is that model, with the include's plugins. What an ``<include>`` in a model
    brings stands on the include's own line, so that all other elements keep theirs.

    Raises:
        InputError: If the model that the file consists of is not found, or includes form a loop.
    """
    if "<include" not in text:
        return ModelText(text, file)
    reader = XmlReader(text, file)
    includes, models = reader.root.findall("include"), reader.root.findall("model")
    if reader.root.tag == "sdf" and len(includes) == 1 and not models:
        return _only_included(includes[0], reader, file, packages)
    if reader.root.tag == "sdf" and len(models) == 1 and models[0].find(".//include") is not None:
        return _with_included(text, models[0], reader, file, packages)
    return ModelText(text, file)


def _only_included(include: etree._Element, reader: XmlReader, file: Path, packages: PackageIndex) -> ModelText:
    includes = SdfIncludes(packages)
    found = includes.model(include, reader, (file,))
    if found is None:
        raise _not_included(includes, include, reader)
    root = etree.Element("sdf", version=".".join(map(str, found.version)))
    root.append(found.element)
    text = etree.tostring(root, encoding="unicode")
    return ModelText(text, found.reader.file or file, tuple(_lost(includes, reader.place(include))))


def _with_included(
    text: str, model: etree._Element, reader: XmlReader, file: Path, packages: PackageIndex
) -> ModelText:
    includes, every = SdfIncludes(packages), [*reader.root.iter("include")]
    place = reader.place(every[0])
    brought = includes.expand(model, reader, sdf_version(reader.root), (file,))
    if includes.addresses.missing and model.find(".//link") is None:  # nothing is left
        raise _not_included(includes, every[0], reader)
    upcoming = iter(every)

    def one_line(match: re.Match[str]) -> str:
        if match[0].startswith("<!--") or (include := next(upcoming)) not in brought:
            return match[0]
        elements = (etree.tostring(element, encoding="unicode", with_tail=False) for element in brought[include])
        return "".join(elements).replace("\n", " ") + "\n" * match[0].count("\n")

    return ModelText(_COMMENT_OR_INCLUDE.sub(one_line, text), file, tuple(_lost(includes, place)))


def _not_included(includes: SdfIncludes, include: etree._Element, reader: XmlReader) -> InputError:
    missing = [f"{name}: searched {each.searched}. {each.advice}" for name, each in includes.addresses.missing.items()]
    reasons = missing or [finding.what for finding in includes.findings]
    return reader.error(include, f"the model is not included: {'; '.join(reasons)}")


def _lost(includes: SdfIncludes, place: Place) -> Iterator[Finding]:
    found = (*includes.findings, *(includes.not_found(place) if includes.asked else ()))
    return (replace(finding, weight=Weight.LOST) for finding in found)
