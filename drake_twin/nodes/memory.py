"""How much memory the process uses, and the most that a node program may take of it."""

import os
from functools import cache

_MOST = 4 << 30  # bytes


def resident() -> int:
    """Return the memory that the process has at present (bytes); zero where the system does not tell."""
    descriptor = _statm()
    return 0 if descriptor is None else int(os.pread(descriptor, 64, 0).split()[1]) * _page()


def most_memory() -> int:
    """Return how much a node program may take (bytes): 4 GiB, or half of the machine's where that is less."""
    try:
        return min(_MOST, os.sysconf("SC_PHYS_PAGES") * _page() // 2)
    except (OSError, ValueError, AttributeError):
        return _MOST


@cache
def _page() -> int:
    return os.sysconf("SC_PAGE_SIZE")


@cache
def _statm() -> int | None:
    """Open the file once: it is read at turns of the nodes."""
    try:
        return os.open("/proc/self/statm", os.O_RDONLY)
    except OSError:
        return None
