"""The machine's ROS 2: where its rclpy is, which Python runs it, and the process in which it does.

A process of its own, for the message packages have the names of those that node programs see, a middleware brings
libraries that the twin's may have in other versions, and an installed ROS 2 has the Python of its distribution.
"""

import contextlib
import fcntl
import io
import json
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO, cast

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.python_process import stops_held_back
from drake_twin.wires.rclpy_records import STARTED, Pipe, records

# Its modules of drake_twin are found without the rest of it, for which that Python may lack the requirements.
_START = """\
import runpy, sys, types
sys.path[:] = [*(folder for folder in sys.path if folder), sys.argv[2]]
for name, folder in (("drake_twin", sys.argv[1]), ("drake_twin.wires", sys.argv[1] + "/wires")):
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__path__ = [folder]
runpy.run_module("drake_twin.wires.rclpy_program", run_name="__main__")
"""
_FAREWELL = 1.5  # s of wall time to take the nodes off the graph
_BUFFER = 1 << 20  # bytes, so that the twin does not wait for it at its start
_MOST_LINES = 20  # of what the process prints that are kept
_SOURCE = "`source /opt/ros/DISTRO/setup.bash` in this terminal"
_PLACE = re.compile(r",?\s+at /\S+:\d+")  # in the C code of rcl
_LEAD = re.compile(r"^(\[[^\]]*\] ?)+:? ?")  # of a line of ROS's log


@dataclass(frozen=True)
class Rclpy:
    """An rclpy.

    Attributes:
        folder: The folder that has it, which is on its Python's path.
        python: The version of Python that its extension is made for; None if that is unknown.
    """

    folder: Path
    python: tuple[int, int] | None

    @property
    def is_own(self) -> bool:
        """Whether it is installed where the packages of the present Python are."""
        return self.folder.is_relative_to(sys.prefix)

    def interpreters(self) -> list[str]:
        """Return the Python interpreters to try, the best one first.

        What a distribution of ROS 2 is compiled for is the system's NumPy, too; a virtual environment may have another.
        """
        base = getattr(sys, "_base_executable", sys.executable)
        if self.python in (None, sys.version_info[:2]):
            return list(dict.fromkeys([sys.executable] if self.is_own else [base, sys.executable]))
        found = shutil.which(f"python{'.'.join(map(str, self.python or ()))}")
        return [] if found is None else [found]


def find_rclpy() -> Rclpy | None:
    """Return the rclpy of the ROS 2 that is sourced; None without one."""
    for folder in _folders():
        if (folder / "rclpy" / "__init__.py").is_file():
            names = (file.name for file in (folder / "rclpy").glob("_rclpy_pybind11.cpython-*"))
            versions = [match for name in names if (match := re.search(r"cpython-(\d)(\d+)", name))]
            return Rclpy(folder, (int(versions[0][1]), int(versions[0][2])) if versions else None)
    return None


def sourced() -> str:
    """Return the name of the distribution of ROS 2 that is sourced; empty without one."""
    return os.environ.get("ROS_DISTRO", "")


class RosProcess:
    """A process that has the twin's nodes in the machine's ROS 2.

    Args:
        arguments: The arguments of ROS, with ``--ros-args``.
        domain: The ROS domain.
        heard: Is called with each record that comes: its kind, its endpoint's number, its request's and its content, in
            a thread of its own.
        ended: Is called in that thread when the process has ended though nobody has closed it, with what it has said.

    Attributes:
        pipe: Where it is told.
        started: What it has said at its start: the distribution and the middleware.
        python: Its Python.

    Raises:
        InputError: If no rclpy is found, no Python can import it, or it does not take the arguments.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        domain: int,
        heard: Callable[[bytes, int, int, bytes], None],
        ended: Callable[[str], None],
    ):
        rclpy = find_rclpy()
        if rclpy is None:
            raise InputError(f"--ros rclpy: {no_rclpy()}")
        self._heard, self._ended = heard, ended
        self._is_closed = False
        self._said: list[str] = []
        options = json.dumps({"arguments": list(arguments), "domain": domain})
        problem = _no_python(rclpy)
        for self.python in rclpy.interpreters():
            self._start(rclpy, options)
            kind, _, _, content = next(self._records, (b"", 0, 0, b""))
            if kind == STARTED:
                self.started: dict[str, Any] = json.loads(content)
                self._thread = threading.Thread(target=self._read, name="drake_twin rclpy", daemon=True)
                self._thread.start()
                return
            self._end()
            if not content.startswith((b"ImportError", b"ModuleNotFoundError")):
                raise InputError(f"--ros rclpy: {_no_start(self._reason(_plain(content.decode())))}")
            reason = f"{self.python} cannot import it ({_plain(content.decode())})"
            problem = f"the rclpy in {rclpy.folder} is for {_version(rclpy.python)}, and {reason}: {_SOURCE}"
        raise InputError(f"--ros rclpy: {problem}")

    def close(self) -> None:
        """Let the process do what has been written, and end."""
        self._is_closed = True
        self._end()
        self._thread.join()

    def _start(self, rclpy: Rclpy, options: str) -> None:
        command = [self.python, "-c", _START, str(Path(__file__).parents[1]), str(rclpy.folder), options]
        pipe = subprocess.PIPE
        with stops_held_back():
            self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, bufsize=0)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with contextlib.suppress(AttributeError, OSError):  # only Linux has it
            fcntl.fcntl(self._process.stdin, fcntl.F_SETPIPE_SZ, _BUFFER)
        self.pipe = Pipe(cast(BinaryIO, self._process.stdin))
        self._records = records(io.BufferedReader(cast(io.RawIOBase, self._process.stdout), _BUFFER))
        self._printing = threading.Thread(target=self._keep_lines, name="drake_twin rclpy's words", daemon=True)
        self._printing.start()

    def _read(self) -> None:
        for record in self._records:
            self._heard(*record)
        if not self._is_closed:
            self._end()
            self._ended(self._last_words())

    def _keep_lines(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._said = [*self._said, line.decode(errors="replace").strip()][-_MOST_LINES:]

    def _last_words(self) -> str:
        """Return how the process has ended, with the last that it has printed."""
        lines = [_plain(line) for line in self._said if line]
        return f"its process has ended with {self._process.returncode}" + (f" ({lines[-1]})" if lines else "")

    def _reason(self, words: str) -> str:
        """Return why the process has not started, from the error that it tells, which says nothing at times."""
        if not words:
            return self._last_words()
        first = next((line for line in map(_plain, self._said) if line), "")
        return f"{words}; before, it has printed: {first}" if "error not set" in words and first else words

    def _end(self) -> None:
        self.pipe.close()
        try:
            self._process.wait(_FAREWELL)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._printing.join(_FAREWELL)


def no_rclpy() -> str:
    """Return why rclpy is missing, and what helps."""
    if name := sourced():
        return f"ROS 2 {name} is sourced, but it has no rclpy: `sudo apt install ros-{name}-rclpy`"
    return f"no ROS 2 is sourced: {_SOURCE}; --ros zenoh and --ros dds need none"


def _folders() -> Iterator[Path]:
    """Yield the folders in which a Python with the present environment finds modules, and those of sourced prefixes."""
    yield from (Path(folder) for folder in os.environ.get("PYTHONPATH", "").split(os.pathsep) if folder)
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            for name in ("lib/python3*/site-packages", "local/lib/python3*/dist-packages", "lib/python3/dist-packages"):
                yield from sorted(Path(prefix).glob(name))
    yield from (Path(folder) for folder in sys.path if folder)


def _version(python: tuple[int, int] | None) -> str:
    return "an unknown Python" if python is None else f"Python {python[0]}.{python[1]}"


def _no_python(rclpy: Rclpy) -> str:
    wanted, own = _version(rclpy.python), _version(sys.version_info[:2])
    name = wanted.lower().replace(" ", "")
    return f"the rclpy in {rclpy.folder} is for {wanted}, but no {name} is on the PATH, and the twin runs with {own}"


def _no_start(words: str) -> str:
    """Return why ROS does not start, from what it says."""
    name, middleware = sourced(), os.environ.get("RMW_IMPLEMENTATION", "")
    if middleware and middleware in words:
        package = f"ros-{name or 'DISTRO'}-{middleware.replace('_', '-')}"
        what = f"RMW_IMPLEMENTATION={middleware} is not installed"
        return f"{what}: `sudo apt install {package}`, or `unset RMW_IMPLEMENTATION`; ROS says: {words}"
    return f"ROS 2 {name} does not start: {words}"


def _plain(text: str) -> str:
    """Return what ROS says without the places in its code and the time, as one line."""
    return " ".join(_LEAD.sub("", _PLACE.sub("", text)).split()).rstrip(".")
