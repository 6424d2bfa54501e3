"""A program's wires: the ROS 2 graph and a bag."""

import argparse
import contextlib
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.seam import Seam
    from drake_twin.wires.wire import Wire


class RosGraph:
    """The wires of ``--ros`` and ``--bag``, opened before there is a twin, for a port or a folder may be taken.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If a wire cannot be opened.
    """

    def __init__(self, options: argparse.Namespace):
        self._options = options
        self._wires: list[Wire] = []
        self._seam: Seam | None = None
        try:
            self._open()
        except InputError:
            self.close()
            raise

    def connect(self, twin: "Twin") -> None:
        """Connect a twin, in place of the one before."""
        from drake_twin.services.graph import connect

        if self._seam is not None:
            self._seam.close()
            self._open()
        twin.frames.lockstep = self._options.lockstep
        self._seam = connect(twin, self._wires)

    def close(self) -> None:
        """End the wires."""
        if self._seam is not None:
            self._seam.close()
        else:
            for wire in self._wires:
                wire.close()
        self._seam, self._wires = None, []

    def _open(self) -> None:
        options, is_first = self._options, self._seam is None
        self._wires = []
        if options.ros is not None:
            from drake_twin.wires.zenoh_session import ROUTER_PORT
            from drake_twin.wires.zenoh_wire import ZenohWire

            host, port = options.ros_host or "127.0.0.1", options.ros_port or ROUTER_PORT
            wire = ZenohWire(host=host, port=port, router=options.ros_router)
            self._wires.append(wire)
            if is_first:
                say(f"ros: domain {wire.domain} over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), {wire.place}")
                say(
                    "ros: this protocol has no token: every program that reaches the port commands the robots",
                    sys.stderr,
                )
        if options.bag is not None:
            from drake_twin.wires.bag_wire import BagWire

            self._wires.append(BagWire(options.bag, options.bag_topic or ()))


@contextlib.contextmanager
def ros_graph(options: argparse.Namespace) -> Iterator[RosGraph | None]:
    """Open the wires that the options ask for, and end them in any case: one of Zenoh keeps a process alive."""
    if options.ros is None and options.bag is None:
        yield None
        return
    graph = RosGraph(options)
    try:
        yield graph
    finally:
        graph.close()
