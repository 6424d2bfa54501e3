"""The model of an SDF robot's file where the file includes it, or parts of it, from other files."""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.sdf_document import sdf_version
from drake_twin.description.sdf_includes import SdfIncludes
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Weight
from drake_twin.values import is_true

_COMMENT_OR_INCLUDE = re.compile(
    r"<!--.*?-->|<include\b(?:\"[^\"]*\"|'[^']*'|[^>\"'])*(?:(?<=/)>|>.*?</include\s*>)", re.DOTALL
)


class ModelText(NamedTuple):
    """An SDF file's text, the file that it comes from, and what of the file that includes it is not used."""

    text: str
    file: Path
    findings: tuple[Finding, ...] = ()


def included_model(text: str, file: Path, packages: PackageIndex) -> ModelText:
    """Return the model that an SDF file includes, or the file's own model with what it includes by merging.

    A file that is only an ``<include>`` is that model, with the include's plugins. What ``<include merge="true">``
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
    if reader.root.tag == "sdf" and len(models) == 1:
        return _merged(text, models[0], reader, file, packages)
    return ModelText(text, file)


def _only_included(include: etree._Element, reader: XmlReader, file: Path, packages: PackageIndex) -> ModelText:
    includes = SdfIncludes(packages)
    found = includes.model(include, reader, (file,))
    if found is None:
        missing = [
            f"{name}: searched {each.searched}. {each.advice}" for name, each in includes.addresses.missing.items()
        ]
        reasons = missing or [finding.what for finding in includes.findings]
        raise reader.error(include, f"the model is not included: {'; '.join(reasons)}")
    root = etree.Element("sdf", version=".".join(map(str, found.version)))
    root.append(found.element)
    text = etree.tostring(root, encoding="unicode")
    return ModelText(text, found.reader.file or file, tuple(_lost(includes, include, reader)))


def _merged(text: str, model: etree._Element, reader: XmlReader, file: Path, packages: PackageIndex) -> ModelText:
    includes, brought = SdfIncludes(packages), {}
    merging = [
        (number, include)
        for number, include in enumerate(reader.root.iter("include"))
        if include.getparent() is model and is_true(include.get("merge"))
    ]
    if not merging:
        return ModelText(text, file)
    for number, include in merging:
        brought[number] = includes.merged(include, reader, sdf_version(reader.root), (file,))
    numbers = count()

    def one_line(match: re.Match[str]) -> str:
        if match[0].startswith("<!--") or (elements := brought.get(next(numbers))) is None:
            return match[0]
        return elements.replace("\n", " ") + "\n" * match[0].count("\n")

    return ModelText(_COMMENT_OR_INCLUDE.sub(one_line, text), file, tuple(_lost(includes, merging[0][1], reader)))


def _lost(includes: SdfIncludes, include: etree._Element, reader: XmlReader) -> Iterator[Finding]:
    lost = [finding for finding in includes.findings if not finding.what.startswith("<plugin>")]
    lost += includes.not_found(reader.place(include)) if includes.asked else ()
    for finding in lost:
        yield replace(finding, weight=Weight.LOST)
