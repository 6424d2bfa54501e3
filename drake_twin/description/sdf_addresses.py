"""Which file an address in an SDF file names: in the packages, near the file, or where Gazebo keeps its downloads."""

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from urllib.parse import unquote

from lxml import etree

from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.sdf_document import sdf_version
from drake_twin.description.source_file import file_bytes, read_xml
from drake_twin.errors import InputError

_SUN = """<sdf version="1.9"><light name="sun" type="directional"><cast_shadows>true</cast_shadows>
<pose>0 0 10 0 0 0</pose><diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light></sdf>"""


def ground_plane(surface: str = "") -> str:
    """Return Gazebo's model of level ground as SDF, its collision with a ``<surface>`` or with SDF's defaults."""
    plane = "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"
    collision = f'<collision name="collision">{plane}{surface}</collision>'
    visual = f'<visual name="visual">{plane}<material><diffuse>0.8 0.8 0.8 1</diffuse></material></visual>'
    return f'<model name="ground_plane"><static>true</static><link name="link">{collision}{visual}</link></model>'


# The friction of the model in Gazebo's collections; the ground in gz-sim's own worlds has SDF's.
_FRICTION = "<surface><friction><ode><mu>100</mu><mu2>50</mu2></ode></friction></surface>"

# The models that nearly every world includes, by their names in Gazebo's collections.
_BUILT_IN = {"ground_plane": f'<sdf version="1.9">{ground_plane(_FRICTION)}</sdf>', "sun": _SUN}

_FUEL = re.compile(r"https?://(?P<host>[^/]+)(?:/1\.0)?/(?P<owner>[^/]+)/models/(?P<name>[^/]+)", re.IGNORECASE)
_FUEL_CACHES = (".gz/fuel", ".ignition/fuel")
_FUEL_ADVICE = "The twin downloads nothing: `gz fuel download -u ADDRESS` does, as Gazebo when it opens the world"


class NotIncludedError(Exception):
    """Raised when an ``<include>`` cannot be resolved; Gazebo continues without the model, and so does the twin."""


class SdfAddresses:
    """Resolves the addresses of one world.

    Args:
        packages: Resolves ``package://`` and ``model://``.

    Attributes:
        missing: Packages and models that were not found, each with the error that says where it was searched.
    """

    def __init__(self, packages: PackageIndex):
        self._packages = packages
        self.missing: dict[str, MissingPackageError] = {}

    def find(self, address: str, base: Path | None) -> Path:
        """Find the file or folder of an address.

        Beyond what the package index knows, a model is found in the folders above the file at hand and in their
        ``models`` folders, where worlds keep theirs; an absolute path of another machine is found as
        `PackageIndex.resolve_elsewhere` says; a file on Fuel where Gazebo keeps its downloads.

        Args:
            address: The address.
            base: The file that holds it.

        Raises:
            InputError: If it does not exist.
        """
        fuel = _FUEL.match(address)
        if fuel is not None:
            file = self._downloaded(fuel) / address.partition("/files/")[2]
            if not os.path.exists(file):
                raise InputError("the file does not exist", file=file)
            return file
        scheme, separator, rest = address.partition("://")
        rest = rest if separator else address
        if separator and scheme not in ("model", "package", "file"):
            raise InputError(f"unknown scheme of {address!r}", valid=["model://", "package://", "file://"])
        relative = not Path(rest).is_absolute() and base is not None
        missing: Path | None = None  # in a model's folder that is there
        if relative and scheme != "package":
            for folder in _folders_near(Path(str(base))):
                if os.path.exists(folder / rest):  # unlike Path's, of every name
                    return Path(os.path.abspath(folder / rest))
                if missing is None and scheme == "model" and os.path.isdir(folder / rest.partition("/")[0]):
                    missing = folder / rest
        try:
            return self._packages.resolve(address, base)
        except InputError as error:
            for folder in (*self._packages.folders, *self._packages.resource_folders):
                if relative and os.path.exists(folder / rest):
                    return Path(os.path.abspath(folder / rest))
            if missing is not None:
                raise InputError("the file does not exist", file=missing) from None
            if isinstance(error, MissingPackageError):
                self.missing.setdefault(rest.partition("/")[0], error)
            elif not relative:
                with suppress(InputError):
                    return self._packages.resolve_elsewhere(address, base)
            raise

    def model_text(self, address: str, base: Path | None) -> tuple[str, Path]:
        """Read the SDF file of a model.

        Args:
            address: The address in its ``<include>``.
            base: The file that holds the ``<include>``.

        Returns:
            The text and its file.

        Raises:
            MissingPackageError: If the model or its package is nowhere.
            NotIncludedError: If the address cannot be resolved otherwise.
        """
        fuel = _FUEL.match(address)
        name = (fuel["name"] if fuel else address.partition("://")[2] or address).strip("/")
        built_in = _BUILT_IN.get(unquote(name).lower().replace(" ", "_"))
        try:
            place = self._downloaded(fuel) if fuel else self.find(address, base)
        except InputError as error:
            if built_in is not None:
                if isinstance(error, MissingPackageError):
                    self.missing.pop(error.package, None)
                return built_in, Path(name)
            if isinstance(error, MissingPackageError):
                raise
            raise NotIncludedError(str(error).rstrip(".")) from None
        file = _model_file(place) if os.path.isdir(place) else place
        try:
            return read_xml(file, "model"), file
        except InputError as error:
            raise NotIncludedError(str(error).rstrip(".")) from None

    def _downloaded(self, fuel: "re.Match[str]") -> Path:
        """Return the folder of a model of Fuel that Gazebo downloaded earlier."""
        folder = _fuel_cache(fuel)
        if folder is None:
            name = f"{fuel['owner']}/{unquote(fuel['name'])}"
            error = MissingPackageError(name, (f"~/{cache}" for cache in _FUEL_CACHES), _FUEL_ADVICE)
            self.missing.setdefault(name, error)
            raise error
        return folder


def _folders_near(file: Path) -> Iterator[Path]:
    """Yield a file's own folder, and those above it with their ``models``, up to the package's neighbours."""
    yield file.parent
    for folder in list(file.absolute().parents)[:5]:
        yield folder / "models"
        yield folder
        if (folder / "package.xml").is_file():
            yield folder.parent
            return


def _model_file(folder: Path) -> Path:
    """Return the newest SDF file that a model's ``model.config`` names."""
    for name in ("model.config", "manifest.xml"):
        try:
            found = etree.fromstring(file_bytes(folder / name)).findall("sdf")
        except (OSError, etree.XMLSyntaxError):
            continue
        files = [(sdf_version(element), (element.text or "").strip()) for element in found]
        if files:
            return folder / max(files)[1]
    return folder / "model.sdf"


def _fuel_cache(fuel: "re.Match[str]") -> Path | None:
    """Return the folder of the newest version of a model that Gazebo downloaded earlier."""
    folders = [Path(os.environ["GZ_FUEL_CACHE_PATH"])] if os.environ.get("GZ_FUEL_CACHE_PATH") else []
    folders += [Path.home() / name for name in _FUEL_CACHES]
    for folder in folders:
        name = unquote(fuel["name"]).lower()
        model = folder / fuel["host"].lower() / fuel["owner"].lower() / "models" / name
        versions = [path for path in model.glob("*") if path.name.isdigit() and path.is_dir()]
        if versions:
            return max(versions, key=lambda path: int(path.name))
    return None
