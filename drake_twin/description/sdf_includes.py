"""``<include>`` in SDF files: each is replaced by its model, under the name and pose asked for."""

import contextlib
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.frame_in_model import frame_in_model
from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.robot_description import Pose
from drake_twin.description.sdf_addresses import NotIncludedError, SdfAddresses
from drake_twin.description.sdf_document import free_name, modernize, read_sdf, sdf_version
from drake_twin.description.sdf_pose import transform_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Place, at_places
from drake_twin.values import is_true

# Bounds that worlds do not reach; a file beyond them is a mistake, or hostile.
_MOST_INCLUDES = 10_000
_DEEPEST = 32

_SCOPED = ("link", "model", "frame", "joint")  # what has a pose in the model's frame
_MERGED = (*_SCOPED, "gripper", "plugin")  # what <include merge="true"> takes over, as libsdformat's parser does
_OF_INCLUDE = ("uri", "name", "pose", "static", "placement_frame", "plugin")


@dataclass(frozen=True)
class IncludedModel:
    """A ``<model>`` element, with the version of SDF it is written in and the document it comes from."""

    element: etree._Element
    version: tuple[int, ...]
    reader: XmlReader


class SdfIncludes:
    """Replaces the includes of one world by their models.

    Args:
        packages: Resolves addresses.

    Attributes:
        addresses: Resolves addresses in SDF files, and records the packages that are missing.
        findings: What could not be included.
        asked: Missing package → where it is asked for.
        lights: The lights that were included, each with its document.
        documents: Sensor or plugin of a model inside a model → the document that it comes from.
    """

    def __init__(self, packages: PackageIndex):
        self.addresses = SdfAddresses(packages)
        self.findings: list[Finding] = []
        self.asked: dict[str, list[Place]] = {}
        self.lights: list[tuple[etree._Element, XmlReader]] = []
        self.documents: dict[etree._Element, XmlReader] = {}
        self._count = 0

    def model(self, include: etree._Element, reader: XmlReader, above: tuple[Path, ...]) -> IncludedModel | None:
        """Read the model of an ``<include>``, with what it includes itself.

        Args:
            include: The element.
            reader: The document it stands in.
            above: The files that led here, the outermost first.

        Returns:
            The model; None, with a finding, if it cannot be included.

        Raises:
            InputError: If the includes form a loop or never end, or a file is not SDF.
        """
        self._count += 1
        if self._count > _MOST_INCLUDES:
            raise reader.error(include, f"the world includes more than {_MOST_INCLUDES} models")
        for child in include:
            if isinstance(child.tag, str) and child.tag not in _OF_INCLUDE:
                what = f"<{etree.QName(child).localname}> in <include>"
                self.findings.append(Finding.at(Kind.IGNORED, what, reader.place(child)))
        address = (include.findtext("uri") or "").strip()
        if not address:
            raise reader.error(include, "<uri> is missing")
        try:
            return self._model(address, include, reader, above)
        except MissingPackageError as error:  # reported once for all that the package lacks
            self.asked.setdefault(error.package, []).append(reader.place(include))
            return None
        except NotIncludedError as reason:
            # A file's name that is the address is not said twice, so that the models that lack theirs are one line.
            why = f" is not included: {reason}".replace(f": {address.removeprefix('file://')}: ", ": ", 1)
            self.findings.append(Finding.at(Kind.IGNORED, address + why, reader.place(include), common=why))
            return None

    def _model(
        self, address: str, include: etree._Element, reader: XmlReader, above: tuple[Path, ...]
    ) -> IncludedModel | None:
        text, file = self.addresses.model_text(address, reader.file)
        if file in above:
            circle = " → ".join(path.name for path in (*above[above.index(file) :], file))
            raise reader.error(include, f"the includes form a loop: {circle}")
        if len(above) > _DEEPEST:
            raise reader.error(include, f"the includes go deeper than {_DEEPEST} files")
        try:
            inner = read_sdf(text, file)
        except InputError as error:
            raise NotIncludedError(str(error).rstrip(".")) from None
        if inner.root.tag != "sdf":
            raise NotIncludedError(f"{file} is not an SDF file (its outermost element is <{inner.root.tag}>)")
        model = inner.root.find("model")
        if model is None:
            kinds = [str(child.tag) for child in inner.root if isinstance(child.tag, str)]
            if "light" in kinds:  # as model://sun
                self.lights += [(light, inner) for light in inner.root.findall("light")]
                return None
            raise NotIncludedError(f"{file} has no <model>")
        version = sdf_version(inner.root)
        self._make_addresses_absolute(model, file)
        self.expand(model, inner, version, (*above, file))
        _override(model, include)
        for plugin in include.findall("plugin"):  # the model's own come first
            self.documents[plugin] = reader
            model.append(plugin)
        return IncludedModel(model, version, inner)

    def expand(
        self, model: etree._Element, reader: XmlReader, version: tuple[int, ...], above: tuple[Path, ...]
    ) -> dict[etree._Element, list[etree._Element]]:
        """Replace a model's own includes by their models, at any depth; return what stands for each include.

        Args:
            model: The element; it is changed.
            reader: The document it stands in.
            version: That document's version of SDF.
            above: The files that led here.
        """
        brought: dict[etree._Element, list[etree._Element]] = {}
        for include in list(model.iter("include")):
            parent = include.getparent()
            if parent is None or parent.tag != "model":
                continue
            found = self.model(include, reader, above)
            if found is None:
                parent.remove(include)
                brought[include] = []
                continue
            if found.version < (1, 7) <= version:
                modernize(found.element)
            found.element.tail = None
            for element in found.element.iter("sensor", "plugin"):
                self.documents.setdefault(element, found.reader)
            if is_true(include.get("merge")):
                brought[include] = _merge(found, include, reader)
            else:
                taken = {sibling.get("name", "") for sibling in parent.findall("model")}
                found.element.set("name", free_name(found.element.get("name", ""), taken))
                parent.replace(include, found.element)
                brought[include] = [found.element]
        return brought

    def not_found(self, place: Place) -> Iterator[Finding]:
        """Yield a finding of all models and packages that were not found in the same folders.

        Args:
            place: Where they are asked for, if it is not an ``<include>``.
        """
        groups: dict[tuple[str, str], list[str]] = {}
        for name, error in sorted(self.addresses.missing.items()):
            groups.setdefault((error.searched, error.advice), []).append(name)
        for (searched, advice), names in groups.items():
            what = f"these models and packages were not found: {', '.join(names)}. Searched: {searched}. {advice}"
            asked = [asked for name in names for asked in self.asked.get(name, ())] or [place]
            yield from at_places(Kind.IGNORED, ((what, each) for each in asked))

    def _make_addresses_absolute(self, model: etree._Element, file: Path) -> None:
        """Resolve the addresses of meshes, which are relative to the file that the model is about to leave."""
        for uri in model.iterfind(".//mesh/uri"):
            with contextlib.suppress(InputError):  # a missing mesh is reported where meshes are read
                uri.text = str(self.addresses.find((uri.text or "").strip(), file))


def _override(model: etree._Element, include: etree._Element) -> None:
    """Give a model what its ``<include>`` says, in place of what the model's file says."""
    for tag in ("static", "pose"):
        value = include.find(tag)
        if value is not None:
            for own in model.findall(tag):
                model.remove(own)
            model.insert(0, deepcopy(value))
    name, placement = (include.findtext("name") or "").strip(), (include.findtext("placement_frame") or "").strip()
    if name:
        model.set("name", name)
    if placement:
        model.set("placement_frame", placement)


def _unplaced(found: IncludedModel, pose: etree._Element, include: etree._Element, reader: XmlReader) -> etree._Element:
    """Return the pose of a model's own frame, of one whose pose is that of its placement frame."""
    placement = found.element.get("placement_frame", "")
    X_MP = frame_in_model(found.element, placement)
    if X_MP is None:
        raise reader.error(include, f"the placement frame {placement!r} does not exist", value=placement)
    X = transform_of(pose, found.reader) @ X_MP.inverse()
    own = etree.Element("pose")
    if to := pose.get("relative_to"):
        own.set("relative_to", to)
    own.text = Pose.of(X).text
    return own


def _merge(found: IncludedModel, include: etree._Element, reader: XmlReader) -> list[etree._Element]:
    """Move what has a name in the model of ``<include merge="true">`` into the including model: links, plugins, …"""
    model = found.element
    frame = f"_merged_{model.get('name', '')}_model_"
    into = include.getparent()
    assert into is not None
    at = into.index(include)
    into.remove(include)
    placed = etree.Element("frame", name=frame)
    pose = model.find("pose")
    if model.get("placement_frame"):
        placed.append(_unplaced(found, etree.Element("pose") if pose is None else pose, include, reader))
    elif pose is not None:
        placed.append(deepcopy(pose))
    moved = [placed]
    for child in [child for child in model if child.tag in _MERGED]:
        moved.append(child)
        if child.tag not in _SCOPED:
            continue
        own = child.find("pose")
        if own is None and child.tag in ("link", "model"):
            own = etree.SubElement(child, "pose")
            own.text = "0 0 0 0 0 0"
        if own is not None and child.tag != "joint" and not own.get("relative_to") and not child.get("attached_to"):
            own.set("relative_to", frame)
        for element in child.iter():
            for attribute in ("relative_to", "attached_to", "expressed_in"):
                if element.get(attribute) == "__model__" and child.tag != "model":
                    element.set(attribute, frame)
    for offset, child in enumerate(moved):
        into.insert(at + offset, child)
    return moved
