"""The kinds of wires: each has options of its own on the command line, and opens a wire where they ask for it."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar, TypeVar

from drake_twin.extensions import Registry

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.wire import Wire

Asset = Callable[[str], bytes | None]  # a file's address → its content


class WireKind:
    """A kind of wire of `drake_twin.run`.

    What it needs to open a wire is imported there: the options of all kinds are read at each start.

    Attributes:
        name: Its name, unique among the kinds.
        has_peers: Whether other programs may listen, for which time has to pass as it does.
    """

    name: ClassVar[str]
    has_peers: ClassVar[bool] = True

    def add_options(self, group: argparse._ArgumentGroup) -> None:
        """Add its options."""
        raise NotImplementedError

    def check(self, options: argparse.Namespace) -> None:
        """Check its options.

        Raises:
            InputError: If a value is invalid, or an option needs another one.
        """

    def is_wanted(self, options: argparse.Namespace) -> bool:
        """Tell whether the options ask for a wire."""
        raise NotImplementedError

    def open(self, options: argparse.Namespace, asset: Asset, *, is_first: bool) -> "Wire":
        """Open the wire, and say where it is open and to whom.

        Args:
            options: The options.
            asset: Returns the content of a file of the robots, from any thread; None for a file that they do not use.
            is_first: Whether it is opened for the first time, so that it is said.

        Raises:
            InputError: If it cannot be opened.
        """
        raise NotImplementedError

    def look_around(self, wire: "Wire", twin: "Twin") -> None:
        """Look who else is there, before the wire is connected with its first twin.

        Raises:
            InputError: If the twin cannot be beside them.
        """

    def attach(self, wire: "Wire", twin: "Twin") -> None:
        """Give a wire what it needs of a twin beside its topics and services, before it is connected with it."""

    def connected(self, options: argparse.Namespace, twin: "Twin") -> None:
        """Do what is to be done with a twin that the wire is about to be connected with."""


_Kind = TypeVar("_Kind", bound=type[WireKind])

WIRES: Registry[WireKind] = Registry("wire", "wire_kind", "drake_twin.wires", ["drake_twin.wires.kinds"])


def wire_kind(kind: _Kind) -> _Kind:
    """Register a kind of wire.

    A package of its own does so in a module that its entry point in the group ``drake_twin.wires`` names.

    Raises:
        InputError: If another kind has its name.
    """
    WIRES.add(kind.name, kind(), kind)
    return kind


def wire_kinds() -> tuple[WireKind, ...]:
    """Return all kinds of wires, those of other packages included."""
    return tuple(WIRES.values())
