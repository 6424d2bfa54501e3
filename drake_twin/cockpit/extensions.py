"""Overlays and panels of other packages, found by the entry-point group ``drake_twin.page_panels``."""

import logging
from functools import cache
from importlib.metadata import entry_points
from typing import Protocol, TypeVar

ENTRY_POINTS = "drake_twin.page_panels"

_log = logging.getLogger(__name__)


class Kind(Protocol):
    """What a page can have several of, each registered by name."""

    @property
    def name(self) -> str:
        """The name that the page and the twin exchange."""

    @property
    def type(self) -> type:
        """The class to make one from."""


_K = TypeVar("_K", bound=Kind)


def register(kinds: dict[str, _K], kind: _K) -> None:
    """Add a kind to those that are known.

    Raises:
        ValueError: If the name is not an identifier, or belongs to another class.
    """
    if not kind.name.isidentifier():
        raise ValueError(f"{kind.name!r} cannot name a part of the page: an identifier is needed")
    known = kinds.get(kind.name, kind).type
    if (known.__module__, known.__qualname__) != (kind.type.__module__, kind.type.__qualname__):
        raise ValueError(f"two parts of the page are named {kind.name!r}: {known.__module__}, {kind.type.__module__}")
    kinds[kind.name] = kind


@cache
def load_extensions() -> None:
    """Import what other packages add to the page, once; their modules register it as they are imported."""
    for entry in entry_points(group=ENTRY_POINTS):
        try:
            entry.load()
        except Exception as error:  # a broken package must not keep the page from opening
            _log.warning("the page panel %s (%s) cannot be loaded: %s", entry.name, entry.value, error)
