"""A bag: the twin's topics as a rosbag2."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import say
from drake_twin.wires.registry import Asset, WireKind, wire_kind

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.wire import Wire


@wire_kind
class BagKind(WireKind):
    """``--bag FOLDER``."""

    name = "bag"
    has_peers = False

    def add_options(self, group: argparse._ArgumentGroup) -> None:
        """Add its options."""
        group.add_argument("--bag", type=Path, metavar="FOLDER", help="write the topics into a rosbag2 bag (MCAP)")
        group.add_argument(
            "--bag-topic", action="append", metavar="TOPIC", help="write only this topic into the bag (can be repeated)"
        )

    def check(self, options: argparse.Namespace) -> None:
        """Check its options."""
        if options.bag_topic and options.bag is None:
            raise InputError("--bag-topic is about a bag: it needs --bag FOLDER")
        if options.bag is not None and options.watch:
            raise InputError("--bag writes one run into one folder, and --watch makes many: give one of them")

    def is_wanted(self, options: argparse.Namespace) -> bool:
        """Tell whether the options ask for it."""
        return options.bag is not None

    def open(self, options: argparse.Namespace, asset: Asset, *, is_first: bool) -> "Wire":
        """Open it, and say where."""
        from drake_twin.wires.bag_wire import BagWire

        return BagWire(options.bag, options.bag_topic or ())

    def connected(self, options: argparse.Namespace, twin: "Twin") -> None:
        """Warn of topics that nobody publishes."""
        there = twin.graph.topics()
        for topic in options.bag_topic or ():
            if topic not in there:
                missing = InputError(f"--bag-topic: nothing is published on {topic!r} yet", value=topic, valid=there)
                say(f"warning: {missing}", sys.stderr)
