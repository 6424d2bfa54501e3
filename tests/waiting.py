"""The only place where tests wait for wall time: for what another process or a browser does when it gets to it."""

import time
from collections.abc import Callable
from subprocess import Popen
from typing import Any

LONGEST = 120  # s; a failing test ends then


def until(condition: Callable[[], Any], process: Popen | None = None) -> Any:
    """Ask a condition until it is true, and return its value.

    Args:
        condition: What is waited for.
        process: What brings it about; if it ends before, nothing is waited for any longer.

    Raises:
        AssertionError: If the condition stays false; with the output of the process.
    """
    end = time.monotonic() + LONGEST
    while not (found := condition()) and time.monotonic() < end and (process is None or process.poll() is None):
        time.sleep(0.01)
    found = found or condition()
    assert found, "it did not come about" if process is None else process.communicate()
    return found
