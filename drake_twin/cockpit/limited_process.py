"""A program that runs in a process of its own, with a time limit, while the twin continues."""

import os
import subprocess
import tempfile
import time

from drake_twin.python_process import python_command


class LimitedProcess:
    """A module of ours that runs as a program: exit code 0, or what is wrong on stderr.

    Args:
        module: The module's name; its first argument is the number of this process, for `die_with`.
        arguments: Its other arguments.
        what: What takes too long, for example ``xacro takes longer than {longest} s``.
        longest: The wall time after which it is ended (s).
    """

    def __init__(self, module: str, arguments: list[str], what: str, longest: float):
        self._what, self._longest = what, longest
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 (a pipe would be full before the process has ended)
        self._process = subprocess.Popen(
            [*python_command(module), str(os.getpid()), *arguments],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._end = time.monotonic() + longest
        self._is_done = False
        self.output = b""
        self.problem: str | None = None

    def is_done(self) -> bool:
        """Return whether it has ended; then `output` is what it has printed, and `problem` says what is wrong."""
        if self._is_done:
            return True
        if self._process.poll() is None:
            if time.monotonic() < self._end:
                return False
            self.problem = self._what.format(longest=f"{self._longest:g}")
            self.cancel()
            return True
        assert self._process.stderr is not None
        if self._process.returncode:
            self.problem = self._process.stderr.read().strip() or "the process has ended without a reason"
        self._output.seek(0)
        self.output = self._output.read()
        self.cancel()
        return True

    def cancel(self) -> None:
        """End it."""
        self._is_done = True
        self._process.kill()
        self._process.wait()
        assert self._process.stderr is not None
        self._process.stderr.close()
        self._output.close()
