"""A program's wires: the ROS 2 graph, Foxglove and a bag."""

import argparse
import contextlib
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.nodes.nodes import Nodes
    from drake_twin.services.assets import Assets
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.seam import Seam
    from drake_twin.wires.wire import Wire


class Wires:
    """The wires that options ask for, opened before there is a twin, for a port or a folder may be taken.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If a wire cannot be opened.
    """

    def __init__(self, options: argparse.Namespace):
        self._options = options
        self._wires: list[Wire] = []
        self._seam: Seam | None = None
        self._assets: Assets | None = None
        try:
            self._open(is_first=True)
        except InputError:
            self.close()
            raise

    @property
    def has_peers(self) -> bool:
        """Whether other programs may listen, for which time has to pass as it does."""
        return self._options.ros is not None or self._options.foxglove

    def connect(self, twin: "Twin", nodes: "Nodes | None" = None) -> None:
        """Connect a twin with its nodes, in place of the one before."""
        from drake_twin.services.assets import Assets
        from drake_twin.services.graph import connect

        if self._seam is not None:
            self._seam.close()
            self._seam, self._wires = None, []
            self._open(is_first=False)
        twin.frames.lockstep = self._options.lockstep
        self._assets = Assets(twin)
        self._seam = connect(twin, self._wires, nodes)
        there = twin.topics()
        for topic in self._options.bag_topic or ():
            if topic not in there:
                missing = InputError(f"--bag-topic: nothing is published on {topic!r} yet", value=topic, valid=there)
                say(f"warning: {missing}", sys.stderr)

    def close(self) -> None:
        """End the wires."""
        if self._seam is not None:
            self._seam.close()
        else:
            for wire in self._wires:
                wire.close()
        self._seam, self._wires = None, []

    def _open(self, *, is_first: bool) -> None:
        if self._options.ros == "zenoh":
            self._open_zenoh(is_first)
        if self._options.ros == "dds":
            self._open_dds(is_first)
        if self._options.foxglove:
            self._open_foxglove(is_first)
        if self._options.bag is not None:
            from drake_twin.wires.bag_wire import BagWire

            self._wires.append(BagWire(self._options.bag, self._options.bag_topic or ()))

    def _open_zenoh(self, is_first: bool) -> None:
        from drake_twin.wires.zenoh_session import ROUTER_PORT
        from drake_twin.wires.zenoh_wire import ZenohWire

        options = self._options
        host, port = options.ros_host or "127.0.0.1", options.ros_port or ROUTER_PORT
        wire = ZenohWire(host=host, port=port, router=options.ros_router)
        self._wires.append(wire)
        if is_first:
            say(f"ros: domain {wire.domain} over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), {wire.place}")
            _say_that_it_is_open("ros", "every program that reaches the port commands the robots")

    def _open_dds(self, is_first: bool) -> None:
        from drake_twin.wires.dds_wire import LOOPBACK, DdsWire

        wire = DdsWire(host=self._options.ros_host or LOOPBACK)
        self._wires.append(wire)
        if is_first:
            say(f"ros: domain {wire.domain} over DDS, {wire.place}: topics only, services and actions are Zenoh's")
            _say_that_it_is_open("ros", "every program that reaches the participant commands the robots")

    def _open_foxglove(self, is_first: bool) -> None:
        from drake_twin.wires.foxglove_wire import PORT, FoxgloveWire

        options = self._options
        host, port = (
            options.foxglove_host or "127.0.0.1",
            PORT if options.foxglove_port is None else options.foxglove_port,
        )
        wire = FoxgloveWire(host, port, control=options.foxglove_control, asset=self._asset)
        self._wires.append(wire)
        if is_first:
            does = "shows and commands" if options.foxglove_control else "only shows; --foxglove-control commands, too"
            say(f"foxglove: {wire.place}, {does}")
            what = "commands the robots" if options.foxglove_control else "sees the robots"
            _say_that_it_is_open("foxglove", f"every program and every web page that reaches the port {what}")

    def _asset(self, address: str) -> bytes | None:
        return None if self._assets is None else self._assets(address)


def _say_that_it_is_open(wire: str, who: str) -> None:
    say(f"{wire}: this protocol has no token: {who}", sys.stderr)


@contextlib.contextmanager
def open_wires(options: argparse.Namespace) -> Iterator[Wires | None]:
    """Open the wires that the options ask for, and end them in any case: one of Zenoh keeps a process alive."""
    if options.ros is None and options.bag is None and not options.foxglove:
        yield None
        return
    wires = Wires(options)
    try:
        yield wires
    finally:
        wires.close()
