"""``osrf_pycommon.process_utils``: finding programs."""

import shutil


def which(cmd: str) -> str | None:
    """Return the path of a program on the path; None without one."""
    return shutil.which(cmd)
