"""A xacro file expanded in a process of its own, with a time limit, while the twin continues."""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from drake_twin.cockpit.limited_process import LimitedProcess
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.xacro_file import expand_xacro
from drake_twin.errors import TwinError
from drake_twin.python_process import die_with

LONGEST = 10.0  # s of wall time


class XacroTrial(LimitedProcess):
    """An expansion that runs.

    Args:
        file: The xacro file.
        arguments: Its arguments.
        folders: The folders of packages to search first.
        longest: The wall time after which it is ended (s).
    """

    def __init__(self, file: Path, arguments: Mapping[str, str], folders: Sequence[str], longest: float = LONGEST):
        given = [str(file), json.dumps([dict(arguments), list(folders)])]
        super().__init__(__name__, given, "xacro takes longer than {longest} s to expand the file", longest)


def main(parent: str, file: str, data: str) -> int:
    """Expand a file; print what is wrong with it."""
    die_with(int(parent))
    arguments, folders = json.loads(data)
    try:
        expand_xacro(Path(file), arguments, PackageIndex(folders))
    except TwinError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
