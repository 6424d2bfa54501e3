"""The ``xacro`` command that launch files find on PATH: the installed xacro with the twin's package index."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.xacro_file import expand_xacro
from drake_twin.errors import InputError
from drake_twin.whole_file import write_whole

# The environment variable with the folders of packages that are searched first; set while launch files run.
PACKAGE_FOLDERS = "DRAKE_TWIN_PACKAGE_FOLDERS"
# The launch file that runs, whose workspace's packages are found.
LAUNCH_FILE = "DRAKE_TWIN_LAUNCH_FILE"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``xacro FILE name:=value … [-o OUTPUT]`` and return the exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    output = None
    if "-o" in words:
        position = words.index("-o")
        output = Path(words[position + 1])
        del words[position : position + 2]
    values = dict(word.split(":=", 1) for word in words if ":=" in word)
    files = [word for word in words if ":=" not in word and not word.startswith("-")]
    if len(files) != 1:
        print("usage: xacro FILE [name:=value …] [-o OUTPUT]", file=sys.stderr)
        return 2
    folders = [folder for folder in os.environ.get(PACKAGE_FOLDERS, "").split(os.pathsep) if folder]
    try:
        text, _, warnings = expand_xacro(Path(files[0]).absolute(), values, PackageIndex(folders))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if output is None:
        print(text)
    else:
        write_whole(output, text)
    return 0
