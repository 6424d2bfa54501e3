"""Processes that the twin starts search Python's modules where this one does.

``python -m`` searches the working folder first, which may be a stranger's: with a ``json.py`` in it, say. The program
``drake-twin`` does not, so neither must what it starts.
"""

import contextlib
import os
import sys
from collections.abc import Iterator

_VARIABLE, _OURS = "PYTHONSAFEPATH", "drake_twin"


def python_command(module: str) -> tuple[str, ...]:
    """Return the command that runs a module as a program."""
    return (sys.executable, *(() if _searches_working_folder() else ("-P",)), "-m", module)


@contextlib.contextmanager
def same_module_search() -> Iterator[None]:
    """Let a process of `multiprocessing` that is started here search as this one does, from its first import on.

    It calls `end_module_search`, so that programs which it starts are not affected.
    """
    if _searches_working_folder() or _VARIABLE in os.environ:
        yield
        return
    os.environ[_VARIABLE] = _OURS
    try:
        yield
    finally:
        os.environ.pop(_VARIABLE, None)


def end_module_search() -> None:
    """Remove what `same_module_search` has set in the environment of this process."""
    if os.environ.get(_VARIABLE) == _OURS:
        del os.environ[_VARIABLE]


def _searches_working_folder() -> bool:
    with contextlib.suppress(OSError):  # the folder has been removed
        return "" in sys.path or os.getcwd() in sys.path
    return False
