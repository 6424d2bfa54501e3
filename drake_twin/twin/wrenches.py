"""Forces and torques that push links for a while, and springs that draw them."""

from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.scenario import LONGEST_TIME, Push
from drake_twin.twin.clock import Clock
from drake_twin.twin.entity_state import Wrench, exists
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.pull import PERIOD, Pull, with_force
from drake_twin.twin.schedule import step_at

Acting = tuple[Wrench | Pull, ...]

_ROUNDING = 1e-9  # s


class Wrenches:
    """The wrenches that act at present.

    Attributes:
        items: The wrenches and pulls; the tuple is replaced, never changed.
        pushes: The scenario's pushes that are still to come.
        steady: Wrenches without an end, also on entities that do not exist.
        before: All before the last `update`, for `take_back`.
    """

    _physics: Physics

    def __init__(self) -> None:
        self.items: Acting = ()
        self.pushes: tuple[Push, ...] = ()
        self.steady: tuple[Wrench, ...] = ()
        self.before: tuple[Acting, tuple[Push, ...], tuple[Wrench, ...]] = (), (), ()

    @property
    def pulls(self) -> tuple[Pull, ...]:
        """The springs among them."""
        return tuple(item for item in self.items if isinstance(item, Pull))

    def use(self, physics: Physics, entities: Sequence[str]) -> None:
        """Switch to a newly built diagram, and keep the wrenches on entities that it has."""
        self._physics = physics
        self.items = tuple(item for item in self.items if item.entity.partition("::")[0] in entities)
        self.pushes = tuple(item for item in self.pushes if item.entity.partition("::")[0] in entities)

    def start(self, pushes: Sequence[Push], steady: Sequence[Wrench] = ()) -> None:
        """Remove all wrenches but some without an end; the pushes of a scenario, with their forces, are ahead."""
        self.steady = tuple(steady)
        self.put(())
        self.pushes = tuple(pushes)

    def update(self, clock: Clock) -> None:
        """End and begin what is due at the present step, and renew the springs' forces."""
        self.before = self.items, self.pushes, self.steady
        if self.items:
            self.drop_ended(clock.time)
            self.renew(clock)
        due = [push for push in self.pushes if step_at(push.time, clock.time_step) <= clock.step]
        if due:
            self.put((*self.items, *(_wrench(push, clock) for push in due)))
            self.pushes = tuple(push for push in self.pushes if push not in due)

    def take_back(self) -> None:
        """Undo the last `update`: the step that was to follow has failed."""
        items, self.pushes, self.steady = self.before
        self.put(items)

    def due_steps(self, clock: Clock) -> list[int]:
        """Return the steps at which something is due."""
        due = [step_at(item.until, clock.time_step) for item in self.items]
        due += [step_at(push.time, clock.time_step) for push in self.pushes]
        return [*due, self.next_renewal(clock)] if self.pulls else due

    def put(self, items: Sequence[Wrench | Pull]) -> None:
        """Replace the wrenches."""
        self.items = tuple(items)
        present = [item for item in self.steady if exists(self._physics.built, item.entity)]
        self._physics.set_wrenches((*self.items, *present))

    def keep(self, steady: Sequence[Wrench]) -> None:
        """Replace the wrenches without an end."""
        self.steady = tuple(steady)
        self.put(self.items)

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
        state = {"wrenches": to_plain(self.items)}
        state |= {"pushes": [to_plain(push) for push in self.pushes]} if self.pushes else {}
        return state | ({"steady_wrenches": [to_plain(item) for item in self.steady]} if self.steady else {})

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned.

        Raises:
            ValueError: If they are invalid.
        """
        steady = tuple(map(from_plain, state.get("steady_wrenches", ())))
        if not all(isinstance(item, Wrench) for item in steady):
            raise ValueError("what acts without an end is not a wrench")
        self.steady = steady
        self.put(from_plain(state["wrenches"]))
        pushes = tuple(map(from_plain, state.get("pushes", ())))
        if not all(isinstance(push, Push) for push in pushes):
            raise ValueError("what is to come is not a push")
        self.pushes = pushes


def first_wrenches(built: TwinDiagram) -> tuple[Wrench, ...]:
    """Return the wrenches that act from the start, also on entities that do not exist."""
    systems = () if built.world_file is None else built.world_file.wrench_systems
    return tuple(
        Wrench(item.entity, item.force, item.torque, LONGEST_TIME) for system in systems for item in system.persistent
    )


def _wrench(push: Push, clock: Clock) -> Wrench:
    """Return a push that begins now as a wrench."""
    assert push.force is not None, "it is settled"
    assert push.at is not None, "it is settled"
    until = min(clock.time + max(push.duration, clock.time_step), LONGEST_TIME)
    return Wrench(push.entity, push.force, (0.0, 0.0, 0.0), until, push.at)
