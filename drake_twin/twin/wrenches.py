"""Forces and torques that push links for a while, and springs that draw them."""

from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.twin.clock import Clock
from drake_twin.twin.entities import Wrench
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.pull import PERIOD, Pull, with_force

Acting = tuple[Wrench | Pull, ...]

_ROUNDING = 1e-9  # s


class Wrenches:
    """The wrenches that act at present.

    Attributes:
        items: The wrenches and pulls; the tuple is replaced, never changed.
    """

    _physics: Physics

    def __init__(self) -> None:
        self.items: Acting = ()

    @property
    def pulls(self) -> tuple[Pull, ...]:
        """The springs among them."""
        return tuple(item for item in self.items if isinstance(item, Pull))

    def use(self, physics: Physics, entities: Sequence[str]) -> None:
        """Switch to a newly built diagram, and keep the wrenches on entities that it has."""
        self._physics = physics
        self.items = tuple(item for item in self.items if item.entity.partition("::")[0] in entities)

    def clear(self) -> None:
        """Remove all wrenches."""
        self.put(())

    def put(self, items: Sequence[Wrench | Pull]) -> None:
        """Replace the wrenches."""
        self.items = tuple(items)
        self._physics.set_wrenches(self.items)

    def drop_ended(self, time: float) -> None:
        """Remove the wrenches that have ended at a time (s)."""
        if any(item.until <= time + _ROUNDING for item in self.items):
            self.put([item for item in self.items if item.until > time + _ROUNDING])

    def release(self, entity: str) -> None:
        """Remove the spring that draws an entity."""
        if any(item.entity == entity for item in self.pulls):
            self.put([item for item in self.items if not (isinstance(item, Pull) and item.entity == entity)])

    def renew(self, clock: Clock) -> None:
        """Let the springs' forces follow the present state, if this step is on the grid of their renewals."""
        if self.pulls and clock.step % clock.steps(PERIOD) == 0:
            built, context = self._physics.built, self._physics.plant_context
            self.put([with_force(built, context, item) if isinstance(item, Pull) else item for item in self.items])

    def next_renewal(self, clock: Clock) -> int:
        """Return the step of the next renewal."""
        period = clock.steps(PERIOD)
        return (clock.step // period + 1) * period

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps."""
        return {"wrenches": to_plain(self.items)}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned."""
        self.put(from_plain(state["wrenches"]))
