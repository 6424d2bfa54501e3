"""A folder of a process's own: it is removed at its end, or, where it was killed, when the next one starts."""

import atexit
import contextlib
import fcntl
import functools
import os
import shutil
import tempfile
from pathlib import Path

_PREFIX = "drake_twin_process_"


@functools.lru_cache(maxsize=1)
def scratch_folder() -> Path:
    """Return the folder of this process; those of processes that have been killed are removed.

    A process has its folder locked: the system lets go of the lock however it ends.

    Raises:
        OSError: If no temporary folder can be created.
    """
    for folder in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with contextlib.suppress(BlockingIOError):
            if (lock := _lock(folder)) is not None:
                shutil.rmtree(folder, ignore_errors=True)
                os.close(lock)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
        with contextlib.suppress(BlockingIOError):  # another process has just taken it for one that is left
            _lock(folder)
            if folder.exists():
                atexit.register(shutil.rmtree, folder, ignore_errors=True)
                return folder


def _lock(folder: Path) -> int | None:
    """Lock a folder of this user until the descriptor is closed; None where that is not possible.

    Raises:
        BlockingIOError: If another process has it locked.
    """
    try:
        if folder.lstat().st_uid != os.getuid():
            return None
        descriptor = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW | os.O_DIRECTORY)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise
    except OSError:  # of a file system without locks
        os.close(descriptor)
        return None
    return descriptor
