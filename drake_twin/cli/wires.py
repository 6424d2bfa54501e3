"""A program's wires: what its options put the twin's topics on."""

import argparse
import contextlib
import sys
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from drake_twin.errors import InputError, RunError
from drake_twin.program import say
from drake_twin.wires.registry import WIRES, wire_kinds
from drake_twin.wires.wire import close_all

if TYPE_CHECKING:
    from drake_twin.nodes.nodes import Nodes
    from drake_twin.services.assets import Assets
    from drake_twin.twin.others_code import OthersCode
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.seam import Seam
    from drake_twin.wires.wire import Wire


class Wires:
    """The wires that options ask for, opened before there is a twin, for a port or a folder may be taken.

    Args:
        options: The options of ``drake_twin.run``.

    Attributes:
        has_peers: Whether other programs may listen, for which time has to pass as it does.

    Raises:
        InputError: If a wire cannot be opened.
    """

    def __init__(self, options: argparse.Namespace):
        self._options = options
        self._kinds = [kind for kind in wire_kinds() if kind.is_wanted(options)]
        self.has_peers = any(kind.has_peers for kind in self._kinds)
        self._wires: list[Wire] = []
        self._others: list[OthersCode] = []
        self._seam: Seam | None = None
        self._assets: Assets | None = None
        try:
            self._open(is_first=True)
        except InputError:
            self.close()
            raise

    def connect(self, twin: "Twin", nodes: "Nodes | None" = None) -> None:
        """Connect a twin with its nodes, in place of the one before."""
        from drake_twin.services.assets import Assets
        from drake_twin.services.graph import connect

        if self._seam is not None:
            self._seam.close()
            self._seam, self._wires, self._others = None, [], []
            self._open(is_first=False)
        else:
            for kind, wire in zip(self._kinds, self._wires, strict=True):
                kind.look_around(wire, twin)
        for code in self._others:
            code.tell(twin)
        self._assets = Assets(twin)
        for kind, wire in zip(self._kinds, self._wires, strict=True):
            kind.attach(wire, twin)
            kind.connected(self._options, twin)
        self._seam = connect(twin, self._wires, nodes)

    def close(self) -> None:
        """End the wires.

        Raises:
            RunError: If one has lost messages that it was to keep.
        """
        seam, wires = self._seam, self._wires
        self._seam, self._wires = None, []
        if seam is not None:
            seam.close()
        else:
            close_all(wires)

    def _open(self, *, is_first: bool) -> None:
        for kind in self._kinds:
            if not WIRES.is_of_others(kind.name):
                self._wires.append(kind.open(self._options, self._asset, is_first=is_first))
                continue
            from drake_twin.twin.others_code import OthersCode
            from drake_twin.wires.others_wire import OthersWire

            code = OthersCode(f"wire {kind.name!r}")
            try:
                wire = code.call(partial(kind.open, self._options, self._asset, is_first=is_first))
            except RunError:
                raise InputError(f"{code.what} cannot be opened: {code.fault}") from None
            self._wires.append(OthersWire(wire, code))
            self._others.append(code)

    def _asset(self, address: str) -> bytes | None:
        return None if self._assets is None else self._assets(address)


@contextlib.contextmanager
def open_wires(options: argparse.Namespace) -> Iterator[Wires | None]:
    """Open the wires that the options ask for, and end them in any case: one of Zenoh keeps a process alive."""
    if not any(kind.is_wanted(options) for kind in wire_kinds()):
        yield None
        return
    wires = Wires(options)
    try:
        yield wires
    except BaseException:
        try:
            wires.close()
        except RunError as error:
            say(f"error: {error}", sys.stderr)
        raise
    wires.close()
