"""The option ``--watch``: the twin of changed files."""

import argparse
import sys
from typing import TYPE_CHECKING

from drake_twin.cli.announcement import announce
from drake_twin.cli.target import Target, build_twin, find_target
from drake_twin.cli.watched_files import Watch, files_read
from drake_twin.errors import TwinError
from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin


def rebuilt_twin(
    twin: "Twin", target: Target, options: argparse.Namespace, watch: Watch
) -> tuple["Twin", Target, Watch]:
    """Build the twin of the changed files; if they cannot be used, print the error and keep the twin.

    Args:
        twin: The twin of the files before.
        target: Its target.
        options: The options of ``drake_twin.run``.
        watch: The watch that found the change.

    Returns:
        The twin to run, its target, and the watch of its files.
    """
    say(f"changed: {watch.changed_file}", sys.stderr)
    files = watch.files
    try:
        with files_read() as files:
            new_target = find_target(options)
            new_twin = build_twin(new_target)
        announce(new_twin, new_target, options)
    except (TwinError, OSError) as error:
        say(f"error: {error}\nThe last good twin continues.", sys.stderr)
        return twin, target, watch.renewed(files)
    if twin.recorder.is_on:
        new_twin.recorder.begin()
    new_twin.clock.paused = twin.clock.paused
    new_twin.clock.real_time_rate = twin.clock.real_time_rate
    return new_twin, new_target, watch.renewed(files)
