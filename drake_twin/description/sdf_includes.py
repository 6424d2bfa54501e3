"""``<include>`` in SDF files: which file an address names, and the model in it under the name and pose asked for."""

import contextlib
import os
import re
from collections.abc import Collection, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.source_file import read_xml
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Place

# What no world holds; more is a mistake or a bomb.
_MOST_INCLUDES = 10_000
_DEEPEST = 32

_SUN = '<sdf version="1.9"><light name="sun" type="directional"/></sdf>'
_GROUND_PLANE = """<sdf version="1.9"><model name="ground_plane"><static>true</static><link name="link">
<collision name="collision"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision>
<visual name="visual"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
<material><diffuse>0.8 0.8 0.8 1</diffuse></material></visual></link></model></sdf>"""

# The models that nearly every world includes, by their names in Gazebo's collections.
_BUILT_IN = {"ground_plane": _GROUND_PLANE, "sun": _SUN}

_FUEL = re.compile(r"https?://(?P<host>[^/]+)(?:/1\.0)?/(?P<owner>[^/]+)/models/(?P<name>[^/]+)", re.IGNORECASE)
_FUEL_CACHES = (".gz/fuel", ".ignition/fuel")

_SCOPED = ("link", "model", "frame", "joint")


class NotIncludedError(Exception):
    """What an ``<include>`` names cannot be had; Gazebo goes on without it, and so does the twin."""


_OF_INCLUDE = ("uri", "name", "pose", "static", "placement_frame")


@dataclass
class SdfIncludes:
    """Replaces the includes of one world by what they name.

    Args:
        packages: resolves addresses.

    Attributes:
        findings: what could not be included.
        missing: packages and models that are nowhere, with the places where they were looked for.
        asked: where they are asked for.
    """

    packages: PackageIndex
    findings: list[Finding] = field(default_factory=list)
    missing: dict[str, str] = field(default_factory=dict)
    asked: list[Place] = field(default_factory=list)
    _count: int = 0

    def model(self, include: etree._Element, reader: XmlReader, above: tuple[Path, ...]) -> "IncludedModel | None":
        """The model that an ``<include>`` names, with what it includes itself; None with a warning without it.

        Args:
            include: the element.
            reader: the document it stands in.
            above: the files that led here, the outermost first.

        Raises:
            InputError: the includes form a loop or never end, or a file is no SDF.
        """
        self._count += 1
        if self._count > _MOST_INCLUDES:
            raise reader.error(include, f"the world includes more than {_MOST_INCLUDES} models")
        for child in include:
            if isinstance(child.tag, str) and child.tag not in _OF_INCLUDE:
                named = f" {child.get('name') or child.get('filename')}" if child.tag == "plugin" else ""
                what = f"<{etree.QName(child).localname}>{named} in <include>"
                self.findings.append(Finding.at(Kind.IGNORED, what, reader.place(child)))
        address = (include.findtext("uri") or "").strip()
        if not address:
            raise reader.error(include, "<uri> is missing")
        try:
            return self._model(address, include, reader, above)
        except NotIncludedError as reason:
            what = f"{address} is not included: {reason}"
            self.findings.append(Finding.at(Kind.IGNORED, what, reader.place(include)))
            return None

    def _model(
        self, address: str, include: etree._Element, reader: XmlReader, above: tuple[Path, ...]
    ) -> "IncludedModel | None":
        found = self._text(address, reader.file)
        if found is None:
            self.asked.append(reader.place(include))
            return None  # told once for all that the package lacks
        text, file = found
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
            raise NotIncludedError(f"{file} is no SDF file (its outermost element is <{inner.root.tag}>)")
        model = inner.root.find("model")
        if model is None:
            kinds = [str(child.tag) for child in inner.root if isinstance(child.tag, str)]
            if "light" in kinds:  # as model://sun: lights are the page's own
                return None
            raise NotIncludedError(f"{file} holds no <model>")
        version = sdf_version(inner.root)
        self._make_addresses_absolute(model, file)
        self.expand(model, inner, version, (*above, file))
        _override(model, include)
        return IncludedModel(model, version, inner)

    def expand(
        self, model: etree._Element, reader: XmlReader, version: tuple[int, ...], above: tuple[Path, ...]
    ) -> None:
        """Puts models in the place of a model's own includes, at any depth.

        Args:
            model: the element; it is changed.
            reader: the document it stands in.
            version: that document's version of SDF.
            above: the files that led here.
        """
        for include in list(model.iter("include")):
            parent = include.getparent()
            if parent is None or parent.tag != "model":
                continue
            found = self.model(include, reader, above)
            if found is None:
                parent.remove(include)
                continue
            if found.version < (1, 7) <= version:
                modernize(found.element)
            found.element.tail = None
            if include.get("merge", "").strip().lower() in ("1", "true"):
                _merge(found.element, include)
            else:
                taken = {sibling.get("name", "") for sibling in parent.findall("model")}
                found.element.set("name", free_name(found.element.get("name", ""), taken))
                parent.replace(include, found.element)

    def _make_addresses_absolute(self, model: etree._Element, file: Path) -> None:
        """Addresses of meshes are meant from the file they stand in, which the model is about to leave."""
        for uri in model.iterfind(".//mesh/uri"):
            with contextlib.suppress(InputError):  # what is not there is told where meshes are looked at
                uri.text = str(self.find((uri.text or "").strip(), file))

    def _text(self, address: str, base: Path | None) -> tuple[str, Path] | None:
        """The text of the SDF file that an include's address names; None where its package is missing."""
        fuel = _FUEL.match(address)
        name = (fuel["name"] if fuel else address.partition("://")[2] or address).strip("/")
        built_in = _BUILT_IN.get(name.lower().replace("%20", "_").replace(" ", "_"))
        try:
            place = _fuel_cache(fuel) if fuel else self.find(address, base)
        except InputError as error:
            if built_in is not None:
                self.missing.pop(name, None)
                return built_in, Path(name)
            if isinstance(error, MissingPackageError):
                return None
            raise NotIncludedError(str(error).rstrip(".")) from None
        if place is None:
            if built_in is not None:
                return built_in, Path(name)
            raise NotIncludedError("the twin downloads nothing; download it and name it as model://")
        file = _model_file(place) if place.is_dir() else place
        try:
            return read_xml(file, "model"), file
        except InputError as error:
            raise NotIncludedError(str(error).rstrip(".")) from None

    def find(self, address: str, base: Path | None) -> Path:
        """The file or folder of an address in an SDF file.

        Beyond what the package index knows, a model is found in the folders above the file at hand and in their
        ``models`` folders, where worlds keep theirs.

        Raises:
            InputError: it is not there.
        """
        scheme, separator, rest = address.partition("://")
        rest = rest if separator else address
        if separator and scheme not in ("model", "package", "file"):
            raise InputError(
                f"{address!r} has a scheme that is not understood", valid=["model://", "package://", "file://"]
            )
        relative = not Path(rest).is_absolute() and base is not None
        if relative and scheme != "package":
            for folder in _folders_near(Path(str(base))):
                if (folder / rest).exists():
                    return Path(os.path.abspath(folder / rest))
        try:
            return self.packages.resolve(address, base)
        except InputError as error:
            for folder in self.packages.resource_folders:
                if relative and (folder / rest).exists():
                    return Path(os.path.abspath(folder / rest))
            if isinstance(error, MissingPackageError):
                self.missing.setdefault(rest.partition("/")[0], str(error))
            raise


@dataclass(frozen=True)
class IncludedModel:
    """A ``<model>`` element, with the version of SDF it is written in and the document it comes from."""

    element: etree._Element
    version: tuple[int, ...]
    reader: XmlReader


_PREFIX = re.compile(r"(?:</?|\s)([A-Za-z_][\w.-]*):[A-Za-z_][\w.-]*(?=[\s=/>])")


def read_sdf(text: str, file: Path | None, places: Sequence[Place] | None = None) -> XmlReader:
    """An SDF document, with what Gazebo's reader lets pass.

    That is blank lines before the XML declaration, prefixes that nothing declares, and ``--`` inside a comment.

    Raises:
        InputError: it is not well-formed all the same.
    """
    text = re.sub(r"<!--.*?-->", lambda comment: "\n" * comment[0].count("\n"), text, flags=re.DOTALL)
    text = re.sub(r"(</?[A-Za-z_]\w*)::(?=\w)", r"\1:", text)
    head = re.match(r"\s*<\?xml.*?\?>", text, re.DOTALL)
    if head is not None:
        text = "\n" * head[0].count("\n") + text[head.end() :]
    declared = set(re.findall(r"\bxmlns:([\w.-]+)\s*=", text)) | {"xml", "xmlns"}
    unknown = sorted(set(_PREFIX.findall(text)) - declared)
    if unknown:
        declarations = "".join(f' xmlns:{prefix}="{prefix}"' for prefix in unknown)
        text = re.sub(r"<sdf\b", lambda tag: tag[0] + declarations, text, count=1)
    return XmlReader(text, file, places=places)


def free_name(name: str, taken: Collection[str]) -> str:
    """A name, or the name with the first number that makes it one of its own."""
    candidate, number = name, 0
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    return candidate


def sdf_version(root: etree._Element) -> tuple[int, ...]:
    """The version of an SDF document as numbers; the newest where it says none."""
    text = (root.get("version") or "").strip()
    return tuple(int(part) for part in text.split(".")) if re.fullmatch(r"\d+(\.\d+)*", text) else (1, 11)


def modernize(model: etree._Element) -> None:
    """Rewrites what meant something else before SDF 1.7, so that a model can stand inside a newer one."""
    for axis in [*model.iter("axis"), *model.iter("axis2")]:
        for old in axis.findall("use_parent_model_frame"):
            xyz = axis.find("xyz")
            if xyz is not None and (old.text or "").strip().lower() in ("1", "true"):
                xyz.set("expressed_in", "__model__")
            axis.remove(old)


def _override(model: etree._Element, include: etree._Element) -> None:
    """What an ``<include>`` says of its model goes before what the model's file says."""
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


def _merge(model: etree._Element, include: etree._Element) -> None:
    """``<include merge="true">``: the included links become the including model's own."""
    frame = f"_merged_{model.get('name', '')}_model_"
    into = include.getparent()
    assert into is not None
    at = into.index(include)
    into.remove(include)
    placed = etree.Element("frame", name=frame)
    pose = model.find("pose")
    if pose is not None:
        placed.append(deepcopy(pose))
    moved = [placed]
    for child in [child for child in model if child.tag in _SCOPED]:
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
        moved.append(child)
    for offset, child in enumerate(moved):
        into.insert(at + offset, child)


def _folders_near(file: Path) -> Iterator[Path]:
    """A file's own folder, and those above it with their ``models``, up to the package's neighbours."""
    yield file.parent
    for folder in list(file.absolute().parents)[:5]:
        yield folder / "models"
        yield folder
        if (folder / "package.xml").is_file():
            yield folder.parent
            return


def _model_file(folder: Path) -> Path:
    """The newest SDF file that a model's ``model.config`` names."""
    for name in ("model.config", "manifest.xml"):
        try:
            found = etree.parse(folder / name).getroot().findall("sdf")
        except (OSError, etree.XMLSyntaxError):
            continue
        files = [(sdf_version(element), (element.text or "").strip()) for element in found]
        if files:
            return folder / max(files)[1]
    return folder / "model.sdf"


def _fuel_cache(fuel: "re.Match[str]") -> Path | None:
    """Where Gazebo keeps a model that it downloaded once; the newest version of it."""
    folders = [Path(os.environ["GZ_FUEL_CACHE_PATH"])] if os.environ.get("GZ_FUEL_CACHE_PATH") else []
    folders += [Path.home() / name for name in _FUEL_CACHES]
    for folder in folders:
        name = fuel["name"].replace("%20", " ").lower()
        model = folder / fuel["host"].lower() / fuel["owner"].lower() / "models" / name
        versions = [path for path in model.glob("*") if path.name.isdigit() and path.is_dir()]
        if versions:
            return max(versions, key=lambda path: int(path.name))
    return None
