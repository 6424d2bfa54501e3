"""``ros2 pkg prefix`` and ``ros2 pkg xml`` of launch files: in a ``Command``, and as the program on their PATH."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.ros2.packages import prefix_of
from drake_twin.ros2.xacro_program import PACKAGE_FOLDERS


def about_package(words: Sequence[str], share_of: Callable[[str], Path]) -> str | None:
    """Return what the command prints; None if it is another one.

    Args:
        words: The command and its arguments.
        share_of: Returns a package's share folder.

    Raises:
        InputError: If the package is not found, or its ``package.xml`` cannot be read.
    """
    if [Path(words[0]).name, *words[1:2]] != ["ros2", "pkg"] or len(words) < 4 or words[2] not in ("prefix", "xml"):
        return None
    options = list(words[3:])
    tag = options.pop(options.index("-t") + 1) if "-t" in options[:-1] else None
    names = [word for word in options if not word.startswith("-")]
    if len(names) != 1:
        return None
    share = share_of(names[0])
    if words[2] == "prefix":
        return f"{share if '--share' in options else prefix_of(share)}\n"
    file = share / "package.xml"
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"it cannot be read ({error.strerror})", file=file) from None
    if tag is None:
        return text
    from drake_twin.description.xml_reader import XmlReader

    return "".join(f"{(each.text or '').strip()}\n" for each in XmlReader(text, file).root.iter(tag))


def main() -> int:
    """Answer on the command line; another command of ``ros2`` fails, for no ROS is there."""
    folders = [folder for folder in os.environ.get(PACKAGE_FOLDERS, "").split(os.pathsep) if folder]
    try:
        answer = about_package(["ros2", *sys.argv[1:]], lambda name: PackageIndex(folders).find(name, os.getcwd()))
    except InputError as error:
        print(error, file=sys.stderr)
        return 1
    if answer is None:
        print(f"ros2 {' '.join(sys.argv[1:])}: not a command of the twin", file=sys.stderr)
        return 1
    print(answer, end="")
    return 0
