"""The option ``--show-args``: the arguments of a launch file."""

import argparse

from drake_twin.cli.target import find_launch_file, package_paths
from drake_twin.errors import InputError


def launch_arguments(options: argparse.Namespace) -> str:
    """Return the arguments of the launch file that the options name, as ``ros2 launch --show-args`` prints them.

    Raises:
        InputError: If the options do not name a launch file, or it cannot be evaluated.
    """
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.ros2.evaluate import declared_arguments
    from drake_twin.ros2.show_arguments import arguments_text

    words = [item for item in options.target if ":=" not in item]
    file = find_launch_file(words, package_paths(options))
    if file is None:
        raise InputError("--show-args needs a launch file")
    given = dict(item.split(":=", 1) for item in options.target if ":=" in item)
    return arguments_text(declared_arguments(file, PackageIndex(package_paths(options)), given))
