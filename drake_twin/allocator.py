"""The C library's allocator, as a program that simulates wants it.

A step of Drake's discrete engine takes and gives back thousands of small blocks, and glibc keeps seven of a size at
hand. With two hundred the same steps take a tenth to a quarter less time, and the process 1 MB more. In pages of 2 MB
where the kernel has them, it has half as many page faults while it starts, and 2 MB more. No number changes. Only the
environment of a process that starts can ask for it, so such a program starts once more, which takes 25 ms; the large
pages save as much.
"""

import contextlib
import os
import sys

OPT_OUT = "DRAKE_TWIN_ALLOCATOR"  # "system": as the system has it
_TUNABLES, _KEPT = "GLIBC_TUNABLES", "glibc.malloc.tcache_count"
_COUNT = 200  # blocks of a size that are kept; with more, no step of 2 or 8 rovers takes less time
_LARGE_PAGES = "glibc.malloc.hugetlb"
_SIMULATING = ("run", "sweep", "calibrate")


def description() -> str:
    """Return what this process's allocator is, for the summary of a run."""
    tunables = os.environ.get(_TUNABLES, "")
    return ":".join(each for each in tunables.split(":") if "malloc" in each) if _KEPT in tunables else "system"


def start_again() -> None:
    """Start a program that simulates once more with an allocator for it, if nobody has chosen one."""
    tunables = os.environ.get(_TUNABLES, "")
    is_chosen = _KEPT in tunables or "malloc" in os.environ.get("LD_PRELOAD", "")
    if is_chosen or os.environ.get(OPT_OUT) == "system" or not (_is_glibc() and simulates(sys.orig_argv[1:])):
        return
    asked = [tunables] if tunables else []
    asked += [f"{_KEPT}={_COUNT}", *([] if _LARGE_PAGES in tunables else [f"{_LARGE_PAGES}=1"])]
    environment = {**os.environ, _TUNABLES: ":".join(asked)}
    with contextlib.suppress(OSError):  # the interpreter is gone, or may not be executed again
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)


def simulates(words: list[str]) -> bool:
    """Return whether a command line starts a program that simulates."""
    for word, after in zip(words, [*words[1:], ""], strict=True):
        name = os.path.basename(word).removeprefix("-m")
        if name in ("drake_twin", "drake-twin"):
            return after in _SIMULATING
        if name.startswith("drake_twin."):
            return name.removeprefix("drake_twin.") in _SIMULATING
    return False


def _is_glibc() -> bool:
    with contextlib.suppress(ValueError, OSError, AttributeError):  # another C library does not know the name
        return (os.confstr("CS_GNU_LIBC_VERSION") or "").startswith("glibc")
    return False
