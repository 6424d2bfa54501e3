"""The files of a rosbag2 bag, checked before a library opens them: a bag may come from a stranger."""

from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.description.source_file import check_regular, file_text
from drake_twin.errors import InputError

_SUFFIXES = (".mcap", ".db3", ".zstd")


def check_bag_files(place: Path) -> None:
    """Check that a bag has regular files only, and none outside of its folder. Their size is not bounded.

    Args:
        place: The bag's folder, or one of its files.

    Raises:
        InputError: If one is a device, a pipe or elsewhere, or ``metadata.yaml`` is too large or too deep.
        OSError: If one cannot be read.
    """
    if not place.is_dir():
        check_regular(place, None)
        return
    for file in sorted(place.iterdir()):
        if file.suffix in _SUFFIXES:
            check_regular(file, None)
    metadata = place / "metadata.yaml"
    if not metadata.exists():
        return
    for name in _named(metadata):
        file = place / name
        if not file.resolve().is_relative_to(place.resolve()):
            raise InputError(f"the bag's file {name!r} is outside of its folder", file=metadata)
        if file.exists():
            check_regular(file, None)


def _named(metadata: Path) -> list[str]:
    """Return the files that a bag's metadata names; a library says what else is wrong there."""
    try:
        found: Any = load_yaml(file_text(metadata))
        names = found["rosbag2_bagfile_information"]["relative_file_paths"]
        if not isinstance(files := found["rosbag2_bagfile_information"].get("files", []), list):
            raise ValueError(f"its files are no list, but {files!r:.80}")
    except (yaml.YAMLError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"the bag cannot be read: {reason}", file=metadata) from None
    except (LookupError, TypeError):
        return []
    return [name for name in names if isinstance(name, str)] if isinstance(names, list) else []
