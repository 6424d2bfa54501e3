"""Modules of other packages that add to the twin's registries, as entry points name them.

A package adds a repair, say, in a module of its own with the registry's decorator, and names the module in its
``pyproject.toml``::

    [project.entry-points."drake_twin.repairs"]
    my_repairs = "my_package.repairs"
"""

import contextlib
import os
import re
import sys
from functools import cache

from drake_twin.errors import InputError

_GROUP = re.compile(r"^\[(.+?)\]\s*$", re.MULTILINE)


@cache
def load_extensions(group: str) -> None:
    """Import the modules that installed packages name in an entry-point group, once in a process.

    Raises:
        InputError: If a module cannot be imported.
    """
    if group not in _named_groups():
        return
    from importlib.metadata import entry_points

    for point in entry_points(group=group):
        try:
            point.load()
        except Exception as error:  # another package's code
            what = f"the entry point {point.name} = {point.value} of {group} cannot be loaded"
            raise InputError(f"{what} ({type(error).__name__}: {error})") from error


@cache
def _named_groups() -> frozenset[str]:
    """Collect the groups that installed packages name.

    Importing importlib.metadata takes 40 ms of each start, this search 1 ms, and most often there is nothing to load.
    """
    found: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError):  # no folder, or an unreadable one
            for entry in os.scandir(folder or "."):
                if entry.name.endswith((".dist-info", ".egg-info")):
                    with contextlib.suppress(OSError), open(f"{entry.path}/entry_points.txt", errors="replace") as file:
                        found.update(_GROUP.findall(file.read()))
    return frozenset(found)
