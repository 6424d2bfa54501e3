"""A program's place on the ROS 2 graph."""

import argparse
import contextlib
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.seam import Seam
    from drake_twin.wires.zenoh_wire import ZenohWire


class RosGraph:
    """The wire of ``--ros``, opened before there is a twin, for its port may be taken.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If the wire cannot be opened.
    """

    def __init__(self, options: argparse.Namespace):
        self._options = options
        self._wire: ZenohWire | None = self._open()
        self._seam: Seam | None = None
        self._announce()

    def connect(self, twin: "Twin") -> None:
        """Put a twin onto the graph, in place of the one before."""
        from drake_twin.services.graph import connect

        if self._seam is not None:
            self._seam.close()
            self._wire = self._open()
        twin.frames.lockstep = self._options.lockstep
        assert self._wire is not None
        self._seam = connect(twin, [self._wire])

    def close(self) -> None:
        """End the wire."""
        if self._seam is not None:
            self._seam.close()
        elif self._wire is not None:
            self._wire.close()
        self._seam = self._wire = None

    def _open(self) -> "ZenohWire":
        from drake_twin.wires.zenoh_session import ROUTER_PORT
        from drake_twin.wires.zenoh_wire import ZenohWire

        host, port = self._options.ros_host or "127.0.0.1", self._options.ros_port or ROUTER_PORT
        return ZenohWire(host=host, port=port, router=self._options.ros_router)

    def _announce(self) -> None:
        assert self._wire is not None
        say(f"ros: domain {self._wire.domain} over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), {self._wire.place}")
        say("ros: this protocol has no token: every program that reaches the port commands the robots", sys.stderr)


@contextlib.contextmanager
def ros_graph(options: argparse.Namespace) -> Iterator[RosGraph | None]:
    """Open the wire of ``--ros``, if the options ask for it, and end it in any case: it keeps a process alive."""
    if options.ros is None:
        yield None
        return
    graph = RosGraph(options)
    try:
        yield graph
    finally:
        graph.close()
