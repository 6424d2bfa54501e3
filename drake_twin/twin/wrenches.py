"""Forces and torques that push links for a while."""

from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.twin.entities import Wrench
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import from_plain, to_plain

_ROUNDING = 1e-9  # s


class Wrenches:
    """The wrenches that act at present.

    Attributes:
        items: The wrenches; the tuple is replaced, never changed.
    """

    _physics: Physics

    def __init__(self) -> None:
        self.items: tuple[Wrench, ...] = ()

    def use(self, physics: Physics, entities: Sequence[str]) -> None:
        """Switch to a newly built diagram, and keep the wrenches on entities that it has."""
        self._physics = physics
        self.items = tuple(item for item in self.items if item.entity.partition("::")[0] in entities)

    def clear(self) -> None:
        """Remove all wrenches."""
        self.put(())

    def put(self, items: Sequence[Wrench]) -> None:
        """Replace the wrenches."""
        self.items = tuple(items)
        self._physics.set_wrenches(self.items)

    def drop_ended(self, time: float) -> None:
        """Remove the wrenches that have ended at a time (s)."""
        if any(item.until <= time + _ROUNDING for item in self.items):
            self.put([item for item in self.items if item.until > time + _ROUNDING])

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps."""
        return {"wrenches": to_plain(self.items)}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned."""
        self.put(from_plain(state["wrenches"]))
