"""What a package's setup.py or setup.cfg installs into its folders; ``data_files`` is read, not run."""

from collections.abc import Iterator
from pathlib import Path

from drake_twin.description.setup_expressions import MOST_FILES, glob_in, read_setup_cfg, read_setup_py


def setup_installs(package: Path, name: str, kind: str = "share") -> Iterator[tuple[str, Path]]:
    """Yield each place below the share folder of a package, and the file of its source that goes there.

    Args:
        package: The folder with the setup.py.
        name: The package's name.
        kind: ``share``; or ``lib`` for the folder of its programs.
    """
    for destination, files in [*_setup_cfg(package), *_setup_py(package)]:
        parts = [part for part in destination.split("/") if part not in ("", ".")]
        if parts[:2] != [kind, name] or ".." in parts:
            continue
        for file in files[:MOST_FILES]:
            source = package / file
            if source.exists() and source != package:
                yield "/".join([*parts[2:], source.name]), source


def _setup_cfg(package: Path) -> list[tuple[str, list[str]]]:
    parser = read_setup_cfg(package)
    found = []
    for destination, text in parser.items("options.data_files") if "options.data_files" in parser else ():
        patterns = [item.strip() for item in text.replace("\n", ",").split(",") if item.strip()]
        files = [file for pattern in patterns for file in glob_in(package, pattern, recursive=False)]
        found.append((destination, files))
    return found


def _setup_py(package: Path) -> list[tuple[str, list[str]]]:
    return [
        (entry[0], [file for file in entry[1] if isinstance(file, str)])
        for entry in read_setup_py(package).data_files
        if isinstance(entry, tuple | list) and len(entry) == 2 and isinstance(entry[0], str)
        if isinstance(entry[1], list | tuple)
    ]
