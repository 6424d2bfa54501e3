"""What a CMakeLists.txt installs into its package's share or lib folder; the file is read, not run.

The commands that install (``install``, ``ament_auto_package``) are understood, and those that define what they use
(``set``, ``list(APPEND)``, ``file(GLOB)``, ``foreach``, ``add_subdirectory``); both branches of an ``if`` count.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from drake_twin.description.source_file import file_text

_KINDS = ("DIRECTORY", "FILES", "PROGRAMS")

# The keywords that end the list of files or folders of an install().
_KEYWORDS = {"DESTINATION", "TYPE", "PATTERN", "REGEX", "FILES_MATCHING", "OPTIONAL", "PERMISSIONS", "COMPONENT"}
_KEYWORDS |= {"USE_SOURCE_PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "CONFIGURATIONS", "RENAME"}
_KEYWORDS |= {"EXCLUDE", "MESSAGE_NEVER", "EXCLUDE_FROM_ALL"}

_COMMAND = re.compile(r"\b([A-Za-z_]\w*)\s*\(")
_WORD = re.compile(r'"((?:[^"\\]|\\.)*)"|([^\s"()]+)|[()]')
_VARIABLE = re.compile(r"\$\{([\w.-]+)\}")

_DEEPEST = 8  # levels of variables in variables, and of add_subdirectory()
_MOST_COMMANDS = 10_000  # of a file, with its loops unrolled


def cmake_installs(package: Path, name: str, top: str = "share") -> Iterator[tuple[str, Path]]:
    """Yield each place below the share folder of a package, and the file or folder of its source that is installed
    there.

    Args:
        package: The folder with the CMakeLists.txt.
        name: The package's name.
        top: ``share``, ``lib`` for the folder of the package's programs, or ``python`` for its Python modules, whose
            places are their names.
    """
    reading = _Reading(package, name, top)
    yield from reading.folder(package)


class _Reading:
    """The CMakeLists.txt of one package, while it is read."""

    def __init__(self, package: Path, name: str, top: str):
        self._name, self._top = name, top
        self._variables = {
            "PROJECT_NAME": name,
            "CMAKE_PROJECT_NAME": name,
            "CMAKE_INSTALL_PREFIX": "",
            "CMAKE_INSTALL_DATADIR": "share",
            "CMAKE_INSTALL_LIBDIR": "lib",
            "CMAKE_INSTALL_DATAROOTDIR": "share",
            "CMAKE_SOURCE_DIR": str(package),
            "PROJECT_SOURCE_DIR": str(package),
            "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{name}",
        }
        self._count = 0
        self._depth = 0

    def folder(self, folder: Path) -> Iterator[tuple[str, Path]]:
        """Yield what the CMakeLists.txt of a folder installs."""
        try:
            text = file_text(folder / "CMakeLists.txt", errors="replace")
        except OSError:
            return
        outer = self._variables.get("CMAKE_CURRENT_SOURCE_DIR")
        self._variables["CMAKE_CURRENT_SOURCE_DIR"] = self._variables["CMAKE_CURRENT_LIST_DIR"] = str(folder)
        yield from self._run(_commands(re.sub(r"#\[\[.*?\]\]|#[^\n]*", "", text, flags=re.DOTALL)), folder)
        if outer is not None:
            self._variables["CMAKE_CURRENT_SOURCE_DIR"] = self._variables["CMAKE_CURRENT_LIST_DIR"] = outer

    def _run(self, commands: list[tuple[str, list[str]]], folder: Path) -> Iterator[tuple[str, Path]]:
        index = 0
        while index < len(commands):
            command, words = commands[index]
            self._count += 1
            if self._count > _MOST_COMMANDS:
                return
            if command == "foreach":
                end = _end_of_loop(commands, index)
                for value in self._values(words):
                    self._variables[words[0]] = value
                    yield from self._run(commands[index + 1 : end], folder)
                index = end
            elif command == "add_subdirectory" and words and self._depth < _DEEPEST:
                self._depth += 1
                yield from self.folder(folder / self._expanded(words[0]))
                self._depth -= 1
            elif command in ("set", "list", "file", "project", "get_filename_component"):
                self._define(command, words, folder)
            elif command == "install" and words and words[0].upper() in _KINDS:
                yield from self._install(words[0].upper(), self._list(words[1:]), folder)
            elif command in ("ament_auto_package", "ament_auto_package_macro") and "INSTALL_TO_SHARE" in words:
                for source in self._list(words[words.index("INSTALL_TO_SHARE") + 1 :]):
                    if source in ("INSTALL_TO_PATH", "USE_SCOPED_HEADER_INSTALL_DIR"):
                        break
                    yield from _installed_folder(folder, source, "")
            elif self._top == "python" and command.startswith("ament_python_install_"):
                yield from _python(self._list(words), folder)
            index += 1

    def _define(self, command: str, words: list[str], folder: Path) -> None:
        if command == "set" and words:
            self._variables[words[0]] = ";".join(word for word in self._list(words[1:]) if word != "PARENT_SCOPE")
        elif command == "project" and words:
            self._variables["PROJECT_NAME"] = self._expanded(words[0])
        elif command == "list" and len(words) > 2 and words[0] == "APPEND":
            before = self._variables.get(words[1], "")
            self._variables[words[1]] = ";".join([*([before] if before else []), *self._list(words[2:])])
        elif command == "get_filename_component" and len(words) > 2:
            path = Path(self._expanded(words[1]))
            kinds = {"NAME": path.name, "NAME_WE": path.name.partition(".")[0], "DIRECTORY": str(path.parent)}
            self._variables[words[0]] = kinds.get(words[2], str(folder / path))
        elif command == "file" and len(words) > 2 and words[0] in ("GLOB", "GLOB_RECURSE"):
            patterns = [word for word in self._list(words[2:]) if word not in ("CONFIGURE_DEPENDS", "FOLLOW_SYMLINKS")]
            start = folder
            if patterns[:1] == ["RELATIVE"]:
                start, patterns = folder / patterns[1], patterns[2:]
            found: list[str] = []
            for pattern in patterns:
                below = Path(pattern).relative_to(folder) if Path(pattern).is_relative_to(folder) else Path(pattern)
                if not below.is_absolute() and ".." not in below.parts and below.parts:
                    deep = f"{below.parent}/**/{below.name}" if words[0] == "GLOB_RECURSE" else str(below)
                    found += [str(path) for path in sorted(folder.glob(deep))]
            if "RELATIVE" in words:
                found = [str(Path(path).relative_to(start)) for path in found if Path(path).is_relative_to(start)]
            self._variables[words[1]] = ";".join(found)

    def _install(self, kind: str, words: list[str], folder: Path) -> Iterator[tuple[str, Path]]:
        if "DESTINATION" not in words[:-1]:
            return
        below = self._below_top(words[words.index("DESTINATION") + 1])
        if below is None:
            return
        rename = words[words.index("RENAME") + 1] if "RENAME" in words[:-1] else None
        for word in words:
            if word in _KEYWORDS:
                break
            if kind == "DIRECTORY":
                yield from _installed_folder(folder, word, below)
            elif (folder / word).is_file():
                yield f"{below}/{rename or Path(word).name}".strip("/"), folder / word

    def _below_top(self, destination: str) -> str | None:
        parts = [part for part in destination.split("/") if part not in ("", ".")]
        if parts[:1] != [self._top] or parts[1:2] != [self._name]:
            return None
        return None if ".." in parts else "/".join(parts[2:])

    def _values(self, words: list[str]) -> list[str]:
        """Return the values of a ``foreach(name …)``."""
        rest = words[1:]
        if rest[:1] == ["RANGE"]:
            return []
        if rest[:2] == ["IN", "LISTS"]:
            return [item for name in rest[2:] for item in self._variables.get(name, "").split(";") if item]
        return self._list(rest[2:] if rest[:2] == ["IN", "ITEMS"] else rest)

    def _list(self, words: list[str]) -> list[str]:
        return [item for word in words for item in self._expanded(word).split(";") if item]

    def _expanded(self, text: str) -> str:
        for _ in range(_DEEPEST):
            if not _VARIABLE.search(text) or len(text) > 100_000:
                break
            text = _VARIABLE.sub(lambda match: self._variables.get(match[1], ""), text)
        return text


def _commands(text: str) -> list[tuple[str, list[str]]]:
    """Return commands with their arguments as words, in order."""
    found = []
    position = 0
    while (match := _COMMAND.search(text, position)) is not None:
        words, depth, position = [], 1, match.end()
        while depth and (word := _WORD.search(text, position)) is not None:
            position = word.end()
            depth += {"(": 1, ")": -1}.get(word[0], 0)
            if word[0] not in "()":
                words.append(word[1] if word[1] is not None else word[2])
        found.append((match[1].lower(), words))
        if depth:
            break
    return found


def _end_of_loop(commands: list[tuple[str, list[str]]], start: int) -> int:
    depth = 0
    for index in range(start, len(commands)):
        depth += {"foreach": 1, "endforeach": -1}.get(commands[index][0], 0)
        if depth == 0:
            return index
    return len(commands)


def _python(words: list[str], folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield what ``ament_python_install_package`` or ``ament_python_install_module`` installs."""
    if words:
        name = Path(words[0]).stem
        source = folder / (words[words.index("PACKAGE_DIR") + 1] if "PACKAGE_DIR" in words[:-1] else words[0])
        if source.exists():
            yield name, source


def _installed_folder(folder: Path, word: str, below: str) -> Iterator[tuple[str, Path]]:
    """Yield what an ``install(DIRECTORY)`` installs: ``a/b`` installs b, ``a/b/`` its contents."""
    source = folder / word
    if not source.is_dir():
        return
    if word.endswith("/") or word in (".", ".."):
        for entry in sorted(source.iterdir()):
            yield f"{below}/{entry.name}".strip("/"), entry
    else:
        yield f"{below}/{source.name}".strip("/"), source
