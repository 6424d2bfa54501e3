"""The Python programs of a package: what ``ros2 run PACKAGE EXECUTABLE`` would run, found in its sources.

They are the console scripts of a setup.py or setup.cfg, the scripts that a CMakeLists.txt installs below ``lib``, and
the scripts of an installed package.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.cmake_install import cmake_installs
from drake_twin.description.python_modules import python_modules, source_of
from drake_twin.description.setup_expressions import read_setup_cfg, read_setup_py
from drake_twin.description.share_layout import package_name
from drake_twin.description.source_file import regular_open


@dataclass(frozen=True)
class PythonProgram:
    """A program in Python.

    Attributes:
        file: The script; of a console script, the module's file.
        module: The module of a console script; empty for a script.
        function: The module's function that a console script calls.
        folder: The folder on ``sys.path`` in which the module is found.
        beside: The folders of the modules that are installed beside it, which it imports, too.
    """

    file: Path
    module: str = ""
    function: str = ""
    folder: Path | None = None
    beside: tuple[Path, ...] = ()


@lru_cache(maxsize=256)
def python_programs(package: Path) -> dict[str, PythonProgram]:
    """Return the programs of a package by their executables' names.

    Args:
        package: The folder with the package.xml, of a source or an installed package.
    """
    package = source_of(package)
    name = package_name(package)
    found: dict[str, PythonProgram] = {}
    scripts = [*_console_scripts(package)]
    beside: tuple[Path, ...] = ()
    if scripts:
        from drake_twin.description.setup_py import setup_installs

        installed = [file for _, file in setup_installs(package, name, "lib")]
        beside = tuple(dict.fromkeys(file.parent for file in installed if file.suffix == ".py"))
    for executable, entry in scripts:
        if (program := _of_entry(package, entry)) is not None:
            found.setdefault(executable, replace(program, beside=beside))
    if (package / "CMakeLists.txt").is_file():
        placed = [(place, file.resolve()) for place, file in _placed(package, name) if is_python(file)]
        for place, file in placed:
            folder = place.rpartition("/")[0]
            others = [other.parent for where, other in placed if where.rpartition("/")[0] == folder]
            program = PythonProgram(file, beside=tuple(dict.fromkeys((file.parent, *others))))
            found.setdefault(place.rpartition("/")[2], program)
    if package.parent.name == "share":
        for file in sorted((package.parents[1] / "lib" / name).glob("*")):
            if is_python(file):
                found.setdefault(file.name, PythonProgram(file))
    return found


def _placed(package: Path, name: str) -> Iterator[tuple[str, Path]]:
    """Yield the place of each file that a CMakeLists.txt installs among a package's programs, and the file."""
    for place, source in cmake_installs(package, name, "lib"):
        if source.is_dir():
            yield from ((f"{place}/{file.name}", file) for file in sorted(source.iterdir()))
        else:
            yield place, source


def is_python(file: Path) -> bool:
    """Return whether a file is a Python script: by its suffix, or by the first line."""
    if not file.is_file():
        return False
    if file.suffix == ".py":
        return True
    try:
        with regular_open(file, "rb") as stream:
            first = stream.readline(200)
    except OSError:
        return False
    return first.startswith(b"#!") and b"python" in first


def _console_scripts(package: Path) -> Iterator[tuple[str, str]]:
    given = read_setup_py(package).entry_points.get("console_scripts", ())
    configured = read_setup_cfg(package).get("options.entry_points", "console_scripts", fallback="")
    for entry in (*(given.splitlines() if isinstance(given, str) else given), *configured.splitlines()):
        executable, equals, target = str(entry).partition("=")
        if equals:
            yield executable.strip(), target.partition("[")[0].strip()


def _of_entry(package: Path, entry: str) -> PythonProgram | None:
    module, _, function = (part.strip() for part in entry.partition(":"))
    root, *inner = module.split(".")
    place = python_modules(package).get(root)
    tops = [place.with_suffix("")] if place is not None else []
    for top in (*tops, package / root, package / "src" / root):
        path = top.joinpath(*inner)
        for file in (path.with_name(f"{path.name}.py"), path / "__init__.py"):
            if file.is_file():
                return PythonProgram(file, module, function, top.parent)
    return None
