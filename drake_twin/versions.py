"""The versions of the files that the programs write, who reads them, and what a state hash in them holds for."""

import platform
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError


@dataclass(frozen=True)
class FileKind:
    """A kind of file that is written.

    Attributes:
        what: What it is.
        written_by: Which options write it.
        version: Its version; a higher one when an older reader would take it wrongly. None where it has another's.
        place: Where the file has its version, and what wrote it.
        reader: What reads which versions.
    """

    what: str
    written_by: str
    version: int | None
    place: str
    reader: str

    def check(self, found: Any, file: str | Path) -> int:
        """Return a version that was read from a file.

        Raises:
            InputError: If it cannot be read.
        """
        latest = self.version or 0
        if isinstance(found, bool) or not isinstance(found, int) or not 1 <= found <= latest:
            later = isinstance(found, int) and found > latest
            why = f": a later drake_twin wrote it, and this is {stamp()}" if later else ""
            readable = "1" if latest == 1 else f"1 to {latest}"
            raise InputError(f"the {self.what} has version {found!r}; {readable} can be read{why}", file=file)
        return found


_JSON = "`format`, `version` and `written_by` at its top"

SCENARIO = FileKind(
    "scenario",
    "`--show-scenario`, `scenario_to_yaml`",
    1,
    "`version`, which your own files may leave out",
    "all programs, `ScenarioFile`: 1 and without",
)
CALIBRATED = FileKind(
    "fitted scenario", "`calibrate --out`", None, "as a scenario; what wrote it in its first line", "as a scenario"
)
SAVED_STATE = FileKind(
    "saved state", "`--save-state`, `Snapshot.save`", 3, _JSON, "`--load-state`, `Snapshot.load`: 1 to 3"
)
RECORDING = FileKind("recording", "`--record`, `Recording.save`", 3, _JSON, "`--replay`, `Recording.load`: 1 to 3")
SUMMARY = FileKind("summary", "`--summary`", 1, _JSON, "your own programs")
SWEEP = FileKind(
    "sweep's table",
    "`sweep --out`, and its journal",
    1,
    "`format` in the definition: the first line, or Parquet's metadata; `version` in each row",
    "`sweep`, `sweep --show`, `run --episode`: 1 and without. A sweep is continued by what wrote it only",
)
BAG = FileKind(
    "bag",
    "`--bag`",
    9,
    "`version` and `custom_data` in `metadata.yaml`: rosbag2's own",
    "`play`, `calibrate`, `ros2 bag` from Jazzy on: those that rosbags knows",
)
HTML = FileKind("page", "`--save-html`", None, '`<meta name="generator">`', "a browser: it has all that it needs in it")
MESHES = FileKind(
    "converted mesh",
    "the cache of meshes",
    10,
    "in the digest that is the file's name",
    "this version only: others convert again",
)
EXPANSIONS = FileKind(
    "expanded xacro file",
    "the cache of expansions",
    1,
    "in the digest that is the file's name",
    "this version only: others expand again",
)
PROFILE = FileKind("mirror's profile", "`mirror --learn`", 1, _JSON, "`mirror --profile`, `Profile.read`: 1")
MIRRORED = FileKind(
    "mirror's report",
    "`mirror --report`",
    None,
    '`<meta name="generator">`',
    "a browser: it has all that it needs in it",
)
FILE_KINDS = (
    *(SCENARIO, CALIBRATED, SAVED_STATE, RECORDING, SUMMARY, SWEEP, BAG, HTML, PROFILE, MIRRORED),
    *(MESHES, EXPANSIONS),
)


def written_by() -> dict[str, str]:
    """Return the versions for which `Twin.state_sha256` promises the same hash: those of the packages and machine."""
    import drake_twin

    return {
        "drake_twin": drake_twin.__version__,
        "drake": _drake_version(),
        "machine": f"{platform.system()} {platform.machine()}",
    }


def head(kind: FileKind) -> dict[str, Any]:
    """Return the first entries of a file of JSON."""
    return {"format": f"drake_twin {kind.what}", "version": kind.version, "written_by": written_by()}


def stamp() -> str:
    """Return `written_by` in words: ``drake_twin 0.2.0 (Drake 1.51.1, Linux x86_64)``."""
    known = written_by()
    return f"drake_twin {known['drake_twin']} (Drake {known['drake']}, {known['machine']})"


@cache
def _drake_version() -> str:
    """Find Drake's version by its folder among the installed packages: importlib.metadata takes 40 ms to import."""
    package = find_spec("pydrake")
    for place in () if package is None else package.submodule_search_locations or ():
        for folder in Path(place).parent.glob("drake-*.dist-info"):
            return folder.name.removeprefix("drake-").removesuffix(".dist-info")
    return "unknown"


def rows() -> Iterator[str]:
    """Yield the rows of the table of all kinds in ``docs/files.md``."""
    for kind in FILE_KINDS:
        version = "" if kind.version is None else str(kind.version)
        yield f"| {kind.what} | {kind.written_by} | {version} | {kind.place} | {kind.reader} |"
