"""What a run prints before it starts: logs and findings, topics and controllers, messages to echo."""

import argparse
import sys
from typing import TYPE_CHECKING

from drake_twin.cli.target import Target
from drake_twin.errors import InputError
from drake_twin.findings import counted, grouped, most_telling, strict_text
from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin


def announce(twin: "Twin", target: Target, options: argparse.Namespace) -> None:
    """Print what became of the files (all of it if asked for, or else a few lines), and what the options ask to print.

    Raises:
        InputError: If ``--strict`` does not accept a finding, or a topic to echo is unknown.
    """
    for line in target.log:
        say(f"launch: {line}", sys.stderr)
    everything = options.findings or options.strict is not None
    found = [f"{kind}: {text}" for kind, text in grouped(twin.findings)] if everything else most_telling(twin.findings)
    for line in found:
        say(line, sys.stderr)
    if lost := counted(twin.findings, options.strict):
        raise InputError(f"--strict: {strict_text(lost)}, see above")
    if target.paused:
        what = "it runs all the same" if options.headless else "press Play"
        say(f"launch: the simulator starts paused there (gz without -r, gzserver with --pause): {what}", sys.stderr)
    if target.recording is not None:
        then = "the run ends with it" if options.end_with_recording else "the run continues from there"
        say(f"replay: the recording ends at {target.recording.end:.3f} s: {then}", sys.stderr)
    _print_interfaces(twin, options)


def _print_interfaces(twin: "Twin", options: argparse.Namespace) -> None:
    """Print topics and controllers, and messages as they are published."""
    if not (options.topics or options.controllers or options.echo):
        return
    from drake_twin.cli.ros2_text import controllers_text, topics_text
    from drake_twin.messages.text import message_text

    if options.topics:
        say(topics_text(twin))
    if options.controllers:
        say(controllers_text(twin))
    for topic in options.echo:
        twin.subscribe(topic, lambda message: say(message_text(message)))
