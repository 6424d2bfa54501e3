"""Where a world's file is, and Gazebo's own empty worlds, for where theirs is missing."""

import os
from pathlib import Path, PurePath

from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.sdf_addresses import ground_plane
from drake_twin.errors import InputError

_EMPTY = """<sdf version="1.9"><world name="{name}">
<physics type="ode"><max_step_size>0.001</max_step_size><real_time_factor>1</real_time_factor></physics>
<include><uri>model://sun</uri></include>{ground}</world></sdf>"""
_GROUNDS = {".sdf": ground_plane(), ".world": "<include><uri>model://ground_plane</uri></include>"}

BUILT_IN_WORLDS = ("empty.sdf", "empty.world", "default.sdf")


def built_in_world(name: PurePath) -> str:
    """Return the SDF of one of `BUILT_IN_WORLDS`."""
    return _EMPTY.format(name=name.stem, ground=_GROUNDS[name.suffix])


def find_world(address: str, packages: PackageIndex) -> Path | None:
    """Find the file of a world; None for a built-in one.

    Args:
        address: A path, ``package://``, ``model://``, ``file://``, or a name below a folder of the resource path.
        packages: Resolves it.

    Raises:
        InputError: If the file is missing.
    """
    name = Path(address).name
    try:
        return packages.resolve(address)
    except InputError as error:
        folders = (*packages.folders, *packages.resource_folders)
        beside = [folder / address for folder in folders if os.path.isfile(folder / address)]
        if beside:
            return beside[0]
        if name in BUILT_IN_WORLDS:
            return None
        if isinstance(error, MissingPackageError):
            raise
        raise InputError(
            f"the world file {address!r} does not exist, and of Gazebo's own worlds only some are built in",
            valid=BUILT_IN_WORLDS,
            value=name,
        ) from None
