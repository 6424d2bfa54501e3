"""Foxglove's web socket."""

import argparse
import sys
from typing import TYPE_CHECKING, cast

from drake_twin.errors import InputError
from drake_twin.program import add_repeated, say
from drake_twin.wires.registry import Asset, WireKind, wire_kind

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.foxglove_wire import FoxgloveWire
    from drake_twin.wires.wire import Wire


@wire_kind
class FoxgloveKind(WireKind):
    """``--foxglove``."""

    name = "foxglove"

    def add_options(self, group: argparse._ArgumentGroup) -> None:
        """Add its options."""
        group.add_argument("--foxglove", action="store_true", help="serve the topics to Foxglove, on this machine only")
        group.add_argument(
            "--foxglove-control",
            action="store_true",
            help="let clients of Foxglove command, call services and control the time, too",
        )
        group.add_argument("--foxglove-host", metavar="ADDRESS", help="the address to listen on (default: 127.0.0.1)")
        group.add_argument("--foxglove-port", type=int, metavar="PORT", help="the port (default: 8765)")

        add_repeated(group, "--foxglove-origin", "ORIGIN", "a web page that may open it, beside Foxglove's own")

    def check(self, options: argparse.Namespace) -> None:
        """Check its options."""
        for name in ("foxglove_control", "foxglove_host", "foxglove_port", "foxglove_origin"):
            if getattr(options, name) and not options.foxglove:
                raise InputError(f"--{name.replace('_', '-')} is about Foxglove: it needs --foxglove")
        if options.foxglove_port is not None and not 1024 <= options.foxglove_port <= 65535:
            raise InputError(f"--foxglove-port {options.foxglove_port}: the port must be from 1024 to 65535")

        for origin in options.foxglove_origin:
            from drake_twin.wires.foxglove_door import is_origin

            if not is_origin(origin):
                raise InputError(f"--foxglove-origin {origin}: it must read like http://localhost:8080, without a path")

    def is_wanted(self, options: argparse.Namespace) -> bool:
        """Tell whether the options ask for it."""
        return bool(options.foxglove)

    def open(self, options: argparse.Namespace, asset: Asset, *, is_first: bool) -> "Wire":
        """Open it, and say where."""
        from drake_twin.wires.foxglove_time import END
        from drake_twin.wires.foxglove_wire import PORT, FoxgloveWire

        port = PORT if options.foxglove_port is None else options.foxglove_port
        host, control = options.foxglove_host or "127.0.0.1", options.foxglove_control
        end, origins = options.duration or END, options.foxglove_origin
        wire = FoxgloveWire(host, port, control=control, end=end, asset=asset, origins=origins)
        if is_first:
            does = "shows and commands" if control else "only shows; --foxglove-control commands, too"
            say(f"foxglove: {wire.place}, {does}")
            what = "commands the robots" if control else "sees the robots"
            who = f"every program that reaches the port {what}, and web pages of Foxglove alone"
            say(f"foxglove: this protocol has no token: {who}", sys.stderr)
        return wire

    def attach(self, wire: "Wire", twin: "Twin") -> None:
        """Let clients control its time, if they may command."""
        cast("FoxgloveWire", wire).attach(twin)
