"""``ros2 pkg prefix`` and ``ros2 pkg xml`` of launch files: in a ``Command``, and as the program on their PATH."""

import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.source_file import read_xml
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.ros2.packages import prefix_of as prefix_of_share
from drake_twin.ros2.xacro_program import LAUNCH_FILE, PACKAGE_FOLDERS

_NAME = re.compile(r"[A-Za-z][\w-]*")


def about_package(
    words: Sequence[str], share_of: Callable[[str], Path], prefix_of: Callable[[str], Path]
) -> str | None:
    """Return what the command prints; None if it is another one.

    Args:
        words: The command and its arguments.
        share_of: Returns a package's share folder.
        prefix_of: Returns the folder that holds its ``share/PACKAGE``.

    Raises:
        InputError: If the package is not found, or its ``package.xml`` cannot be read.
    """
    if [Path(words[0]).name, *words[1:2]] != ["ros2", "pkg"] or len(words) < 4 or words[2] not in ("prefix", "xml"):
        return None
    options = list(words[3:])
    tag = None
    for option in ("-t", "--tag"):
        if option in options[:-1]:
            tag = options.pop(options.index(option) + 1)
            options.remove(option)
    names = [word for word in options if not word.startswith("-")]
    if len(names) != 1 or not _NAME.fullmatch(names[0]):
        return None
    if words[2] == "prefix":
        return f"{share_of(names[0]) if '--share' in options else prefix_of(names[0])}\n"
    file = share_of(names[0]) / "package.xml"
    text = read_xml(file, "package.xml")
    if tag is None:
        return text
    return "".join(f"{(each.text or '').strip()}\n" for each in XmlReader(text, file).root.iter(tag))


def main() -> int:
    """Answer on the command line; another command of ``ros2`` fails, for no ROS is there."""
    folders = [folder for folder in os.environ.get(PACKAGE_FOLDERS, "").split(os.pathsep) if folder]
    try:
        near = os.environ.get(LAUNCH_FILE) or str(Path.cwd() / "package.xml")
        packages = PackageIndex(folders)
        answer = about_package(
            ["ros2", *sys.argv[1:]],
            lambda name: packages.find(name, near),
            lambda name: prefix_of_share(packages.find(name, near)),
        )
    except InputError as error:
        print(error, file=sys.stderr)
        return 1
    if answer is None:
        print(f"ros2 {' '.join(sys.argv[1:])}: not a command of the twin", file=sys.stderr)
        return 1
    print(answer, end="")
    return 0
