"""A xacro file expanded in a process of its own, with a time limit, while the twin continues."""

import json
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.xacro_file import expand_xacro
from drake_twin.errors import TwinError

LONGEST = 10.0  # s of wall time


class XacroTrial:
    """An expansion that runs.

    Args:
        file: The xacro file.
        arguments: Its arguments.
        folders: The folders of packages to search first.
        longest: The wall time after which it is ended (s).
    """

    def __init__(self, file: Path, arguments: Mapping[str, str], folders: Sequence[str], longest: float = LONGEST):
        self._longest = longest
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__, str(file), json.dumps([dict(arguments), list(folders)])],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._end = time.monotonic() + longest
        self.problem: str | None = None

    def is_done(self) -> bool:
        """Return whether it has ended; `problem` then says what is wrong with the file, if anything is."""
        if self._process.poll() is None:
            if time.monotonic() < self._end:
                return False
            self.cancel()
            self.problem = f"xacro takes longer than {self._longest:g} s to expand the file"
            return True
        assert self._process.stderr is not None
        if self.problem is None and self._process.returncode:
            self.problem = self._process.stderr.read().strip() or "xacro has ended without a reason"
        self._process.stderr.close()
        return True

    def cancel(self) -> None:
        """End it."""
        self._process.kill()
        self._process.wait()


def main(file: str, data: str) -> int:
    """Expand a file; print what is wrong with it."""
    arguments, folders = json.loads(data)
    try:
        expand_xacro(Path(file), arguments, PackageIndex(folders))
    except TwinError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
