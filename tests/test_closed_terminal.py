"""A terminal that closes, a real one: programs end with everything written."""

import fcntl
import os
import pty
import subprocess
import sys
import termios

import pytest
from test_stopped_programs import FILES, PROGRAMS, is_whole

READY = {"run": b"sim time", "sweep": b"episodes"}  # what the terminal shows


@pytest.mark.parametrize(("program", "code"), [("run", 0), ("sweep", 130)])
def test_a_closed_terminal(tmp_path, program, code):
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", *PROGRAMS[program]],
        cwd=tmp_path,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        start_new_session=True,
        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        env={**os.environ, "COLUMNS": "120", "TERM": "dumb" if program == "run" else "xterm", "NO_COLOR": "1"},
    )
    os.close(theirs)
    shown = b""
    while READY[program] not in shown:
        shown += os.read(ours, 65536)
    os.close(ours)
    assert process.wait(timeout=120) == code
    files = [tmp_path / name for name in FILES.values()] if program == "run" else []
    assert all(is_whole(file) for file in files)
