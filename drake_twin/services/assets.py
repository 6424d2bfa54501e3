"""The files that robots' descriptions name: meshes and their textures, for viewers that have no file of their own."""

import re
from pathlib import Path
from urllib.parse import unquote

from drake_twin.description.package_index import PackageIndex, containing_package
from drake_twin.description.share_layout import package_name
from drake_twin.description.source_file import file_bytes
from drake_twin.errors import InputError
from drake_twin.twin.twin import Twin

_LARGEST = 256 << 20  # bytes
_PACKAGE = re.compile(r"package://([^/\"'<>\s]+)/")


class Assets:
    """Files of the robots' packages, and no others. It may be asked in any thread.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._look()
        twin.inbox.looks.append(self._look)
        self._packages = PackageIndex(twin.scenario.package_paths)

    def __call__(self, address: str) -> bytes | None:
        """Return the content of a file by its ``package://`` or ``file://`` address.

        None if the file is missing, or outside of the packages of the robots' files and of those that their
        descriptions name: ``..`` and links do not lead out of them. Hidden files are not given: a package at the top of
        a repository has a ``.git``. Foxglove writes ``%20`` for a blank.
        """
        return next((found for place in (address, unquote(address)) if (found := self._read(place)) is not None), None)

    def _look(self) -> None:
        """Note which robots there are, in the twin's thread."""
        self._plans = self._twin.built.plans

    def _read(self, address: str) -> bytes | None:
        for plan in self._plans:
            own = plan.description.file
            names = {*_PACKAGE.findall(plan.description.text)}
            if own is not None and (package := containing_package(own.resolve())) is not None:
                names.add(package_name(package))
            try:
                file = self._packages.resolve(address, own).resolve()
            except (InputError, OSError, ValueError):
                continue
            package = containing_package(file)
            if package is None or package_name(package) not in names or not _is_readable(file):
                continue
            if not any(part.startswith(".") for part in file.relative_to(package).parts):
                return file_bytes(file)
        return None


def _is_readable(file: Path) -> bool:
    return file.is_file() and file.stat().st_size <= _LARGEST
