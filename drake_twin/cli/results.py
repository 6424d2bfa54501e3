"""What is kept of a run when it ends: saved state, recording, summary."""

import argparse
import json
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.errors import RunError
from drake_twin.program import NO_MEMORY, say
from drake_twin.whole_file import write_result

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin


def save_results(
    twin: "Twin", simulated: float, wall_time: float, options: argparse.Namespace, failure: RunError | None
) -> RunError | None:
    """Write the files that the options ask for, and print the result; a failed file does not prevent the others.

    Args:
        twin: The twin at its last moment.
        simulated: The time that the run has simulated (s).
        wall_time: The duration of the run (s).
        options: The options of ``drake_twin.run``.
        failure: The error that ended the run, if there was one.

    Returns:
        The first error, of the run or of a file; later ones are printed.
    """
    writers: list[Callable[[], None]] = []
    if options.save_state is not None:
        writers.append(lambda: twin.snapshot().save(options.save_state))
    if options.record is not None:
        writers.append(lambda: twin.recorder.recording().save(options.record))
    writers.append(partial(_report, twin, simulated, wall_time, options.summary, failure))
    for write in writers:
        try:
            write()
        except (RunError, MemoryError) as raised:
            error = RunError(NO_MEMORY) if isinstance(raised, MemoryError) else raised
            if failure is not None:
                say(f"error: {error}", sys.stderr)
            failure = failure or error
    return failure


def _report(twin: "Twin", simulated: float, wall_time: float, file: Path | None, failure: RunError | None) -> None:
    """Print the result, and write the summary."""
    from drake_twin.cli.summary import summary

    result = summary(twin, simulated, wall_time, failure)
    count = len(result["robots"])
    now = "" if f"{simulated:.3f}" == f"{twin.time:.3f}" else f", at {twin.time:.3f} s"
    say(
        f"{count} robot{'' if count == 1 else 's'}, {simulated:.3f} s simulated in {wall_time:.3f} s"
        f" (real-time factor {result['real_time_factor']:.2f}){now}, state {result['state_sha256'][:12]}"
    )
    if file is not None:
        write_result("summary", file, json.dumps(result, indent=2) + "\n")
