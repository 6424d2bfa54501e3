"""Standard input as node programs read it: they look every few steps whether there is any, in simulated time.

So a run whose input is there when a node looks for it, as that from a file, is repeatable.
"""

import codecs
import os
import select
import sys
from collections.abc import Callable
from typing import Any

from drake_twin.nodes.task import Task, here

POLL = 10_000_000  # ns of simulation time between two looks at a file that a node waits for

_select = select.select  # node programs have another one


class StandardInput:
    """Standard input that does not stop the simulation while a node's thread waits for it.

    A node's thread reads byte for byte, so that ``select`` tells what is left. Other threads read as before.

    Args:
        real: Standard input.
    """

    def __init__(self, real: Any):
        self._real = real
        self._after_return = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def __iter__(self) -> "StandardInput":
        return self

    def __next__(self) -> str:
        line = self.readline()
        if not line:
            raise StopIteration
        return line

    def read(self, size: int | None = -1) -> str:
        """Read some characters; all up to the end by default."""
        count = None if size is None or size < 0 else size
        return self._read(lambda: self._real.read(size), lambda text: len(text) == count)

    def readline(self, size: int = -1) -> str:
        """Read a line, of some characters at most."""
        return self._read(lambda: self._real.readline(size), lambda text: text.endswith("\n") or len(text) == size)

    def readlines(self, hint: int = -1) -> list[str]:
        """Read all lines."""
        return list(self)

    def close(self) -> None:
        """Close it, but not for the others when a node does so, as Python's ``exit()`` does."""
        if here() is None:
            self._real.close()

    def _read(self, otherwise: Callable[[], Any], is_enough: Callable[[str], bool]) -> str:
        """Read until it is enough, or the input ends."""
        task = here()
        if task is None:
            return str(otherwise())
        try:
            file = self._real.fileno()
        except (AttributeError, OSError, ValueError):
            with task.outside():
                return str(otherwise())
        decoder = codecs.getincrementaldecoder(self._real.encoding or "utf-8")("replace")
        text = ""
        while not is_enough(text):
            wait_for_input(task, file)
            byte = os.read(file, 1)
            if not byte:
                break
            text += self._one_newline(decoder.decode(byte))
        return text

    def _one_newline(self, character: str) -> str:
        """Return ``\\n`` for each of ``\\n``, ``\\r`` and ``\\r\\n``, as Python's text files do."""
        if not character:
            return character
        is_rest = self._after_return and character == "\n"
        self._after_return = character == "\r"
        return "" if is_rest else "\n" if self._after_return else character


def wait_for_input(task: Task, file: int) -> None:
    """Let a thread wait until there is something to read, or a file's end."""

    def is_ready() -> bool:
        return bool(_select([file], [], [], 0)[0])

    while not is_ready():
        task.watch(is_ready, POLL)


def ask(task: Task, real: Callable[..., str], prompt: object = "", /) -> str:
    """Do as Python's ``input``, which would read from a terminal without ``sys.stdin``."""
    if sys.stdin is None:
        return real(prompt)
    sys.stdout.write(str(prompt))
    sys.stdout.flush()
    line = sys.stdin.readline()
    if not line:
        raise EOFError("EOF when reading a line")
    return line.removesuffix("\n")
