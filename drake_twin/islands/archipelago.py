"""The islands of a twin: who is in which, who rests, and what they output."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.islands.extents import Extents
from drake_twin.islands.inputs import Inputs, Known
from drake_twin.islands.island import Island
from drake_twin.islands.island_store import IslandStore, Parameterize
from drake_twin.islands.mover import Mover, movers_of
from drake_twin.islands.partition import after_blows, components, packed, touched
from drake_twin.islands.rest import Rest
from drake_twin.scenario import Scenario

_FRAME = 0.02  # s for which a partition holds

# Robot and controller of a joint that comes and goes → the pose at which it holds its child (3×4), or nothing.
Attachments = Mapping[tuple[str, str], tuple[float, ...]]


class Memory(NamedTuple):
    """What an archipelago remembers between two steps, beside the state of robots and models.

    Attributes:
        groups: The movers of each island that is stepped.
        until: The step at which they are found again.
        rested: For how long each mover has been still (s).
        inputs: What has acted on them in the last step; None if that is what acts at present.
    """

    groups: tuple[tuple[int, ...], ...]
    until: int
    rested: tuple[float, ...]
    inputs: tuple[Known, Attachments] | None = None


class Archipelago:
    """The islands of a diagram whose plant only holds the state.

    Each 20 ms, movers whose boxes may touch within the next 20 ms are put together, and alone or together into islands
    of a few movers. Those that have been still for half a second, and touch none that moves, rest: they are in no
    island, with velocities of zero, until something comes near, acts on them, or commands them. All follows from the
    state and `Memory` alone.

    Args:
        built: The diagram.
        scenario: Its scenario.
        root: The diagram's context.
        parameterize: Sets parameters of an island.
        pool: The threads that step islands; None for the caller's.

    Attributes:
        movers: All movers.
        islands: The islands that are stepped.
        inputs: What acts on them.
        attachments: Returns the joints that come and go.
    """

    def __init__(
        self,
        built: TwinDiagram,
        scenario: Scenario,
        root: Context,
        parameterize: Parameterize,
        pool: ThreadPoolExecutor | None,
    ):
        self._plant, self._most, self._time_step = built.plant, scenario.most_in_an_island, scenario.time_step
        self._context = built.plant.GetMyMutableContextFromRoot(root)
        free = map(built.plant.get_body, built.plant.GetFloatingBaseBodies())
        starts = [body.floating_positions_start() for body in free if body.has_quaternion_dofs()]
        self._quaternions = np.add.outer(np.array(starts, dtype=int), np.arange(4))
        inspector = built.scene_graph.model_inspector()
        self.movers: list[Mover] = movers_of(built, inspector)
        self._extents = Extents(built.plant, inspector, self.movers)
        self._store = IslandStore(built, scenario, self.movers, parameterize)
        self.inputs = Inputs(built, self._context, self.movers)
        self._rest = Rest(self.movers, built.plant.num_positions())
        self._pool = pool
        self._tied = _tied(built, self.movers)
        self._attached: dict[tuple[str, str], tuple[float, ...]] = {}
        self.attachments: Callable[[], Attachments] = dict
        self.islands: list[Island] = []
        self._resting: list[Island] = []  # of movers that rest, and whose forces were asked for
        self._places: list[np.ndarray] = []  # of the members of each island in the plant's state
        self._groups: tuple[tuple[int, ...], ...] = ()
        self._taken: tuple[tuple[int, ...], ...] | None = None  # those that the islands have
        self._state = np.empty(0)  # as of the last frame; empty if islands do not have it
        self._seen = np.empty(0)  # what the state was when it was known that nobody was moved by others; or empty
        self._context_before: Context | None = None
        self._until, self._found_at, self._step = 0, -1, 0
        self._roused: set[int] = set()  # who is moved or acted on by others since the last frame
        self._changed: set[int] = set()  # whose inputs are not what the islands have
        self._are_moved = False
        self._knows_inputs = False  # whether what has acted in the last step is known
        self._are_prepared = False
        # The groups of movers that are alone each, and the version of who rests, for which `Extents` has measured.
        self._clear: tuple[tuple[tuple[int, ...], ...], int] | None = None
        self._frame = max(1, round(_FRAME / scenario.time_step))

    # What it remembers.

    def memory(self) -> Memory:
        """Return what is remembered; groups only if the state alone would not give the same."""
        self._note_moved(self._plant.GetPositionsAndVelocities(self._context))
        return self._memory(self._roused, (self.inputs.known(), self._attached))

    def memory_with_inputs(self) -> Memory:
        """Return what is remembered, where nothing tells what has acted in the last step: who is to wake is awake."""
        self._note_moved(self._plant.GetPositionsAndVelocities(self._context))
        known, attached, changed = self.inputs.known(), self._attached, set(self._roused)
        with suppress(Exception):  # of a user's system, which the next step raises again
            changed |= self.inputs.read() | self._follow_attachments()
        self.inputs.remember(known)
        self._attached = attached
        return self._memory(changed, None)

    def _memory(self, roused: set[int], inputs: tuple[Known, Attachments] | None) -> Memory:
        is_over = self._until <= self._step or self._found_at == self._step or self._are_moved
        times = self._rest.times.copy()
        if roused:
            is_over = is_over or not roused <= {number for group in self._groups for number in group}
            times[list(roused)] = 0.0
        groups, until = ((), 0) if is_over else (self._groups, self._until)
        return Memory(groups, until, tuple(times.tolist()), inputs)

    def remember(self, memory: Memory | None) -> None:
        """Continue with what was remembered; None to begin without."""
        self._groups, self._until = (memory.groups, memory.until) if memory is not None else ((), 0)
        self._found_at = -1
        self._rest.set_times(np.array(memory.rested) if memory is not None else np.zeros(len(self.movers)))
        self._state, self._seen, self._roused, self._are_moved = np.empty(0), np.empty(0), set(), False
        self._knows_inputs = memory is not None and memory.inputs is not None
        if memory is not None and memory.inputs is not None:
            known, attached = memory.inputs
            self.inputs.remember(known)
            self._attached = dict(attached)

    def begin(self, step: int) -> None:
        """Know that the state may be another one, for which what is remembered still holds.

        Args:
            step: The present step.
        """
        self._note_moved(self._plant.GetPositionsAndVelocities(self._context))
        self._step, self._state = step, np.empty(0)
        self._give_back_resting()
        self._extents.forget()
        if not self._are_prepared:  # so that what cannot be built is told at the start
            self._are_prepared = True
            state = self._plant.GetPositionsAndVelocities(self._context)
            self._take(self._groups_of(state, self._frame * self._time_step), state, step)
        with suppress(Exception):  # of a user's system, which the next step raises again
            changed = self.inputs.read() | self._follow_attachments()
            self._roused |= changed if self._knows_inputs else set()
        self._knows_inputs = True

    def _give_back_resting(self) -> None:
        self._store.give_back(self._resting)
        self._resting = []

    def follow_parameters(self, parameters: Mapping[str, Sequence[Any]]) -> None:
        """Simulate with these parameters, other than the files', from now on."""
        self._release(self.islands)
        self._release(self._resting)
        self.islands, self._resting, self._taken, self._groups, self._until = [], [], None, (), 0
        self._state = np.empty(0)
        self._store.follow(parameters)
        self._rest.wake(range(len(self.movers)))

    # Frames.

    def next_frame(self, step: int) -> int:
        """Return the step at which the frame of a step ends."""
        return (step // self._frame + 1) * self._frame

    def advance(self, step: int, target: int) -> np.ndarray:
        """Step all movers from a step to another one in the same frame; return the plant's ``[q; v]`` then."""
        self._settle(step)
        end = target * self._time_step
        if self._pool is None or len(self.islands) < 2:
            for island in self.islands:
                island.advance_to(end)
        else:
            futures = [self._pool.submit(island.advance_to, end) for island in self.islands]
            try:
                for future in futures:
                    future.result()
            finally:
                wait(futures)
        for island, places in zip(self.islands, self._places, strict=True):
            self._state[places] = island.state()
        if target == self.next_frame(step):
            stepped = [number for group in self._groups for number in group]
            for number in self._rest.pass_time(self._state, self._frame * self._time_step, stepped):
                self._state[self._rest.velocities(number)] = 0.0
                self._taken = None  # the islands have other velocities
        self._step, self._seen = target, self._state.copy()
        return self._state

    def _settle(self, step: int) -> None:
        """Have each mover that does not rest in an island, with the present state and inputs."""
        state = self._look()
        is_new = self._until <= step or self._are_moved
        if self._roused:
            is_new = is_new or not self._roused <= {number for group in self._groups for number in group}
            self._rest.wake(self._roused)
            self._roused = set()
        if is_new:
            self._find_groups(state, step)
        self._are_moved = False
        self._use(state, step)

    def _look(self) -> np.ndarray:
        """Return the present state; note who was moved by others, or is acted on in another way."""
        state: np.ndarray = self._plant.GetPositionsAndVelocities(self._context)
        self._note_moved(state)
        changed = self.inputs.read() | self._follow_attachments()
        self._roused |= changed
        self._changed |= changed
        return state

    def _note_moved(self, state: np.ndarray) -> None:
        """Note who is elsewhere than the steps have brought it; a quaternion of half the length is the same place."""
        if not len(self._seen):
            self._seen = state
        if self._seen is state or np.array_equal(state, self._seen):
            return
        before, self._seen, self._state = self._seen, state, np.empty(0)
        differs = state != before
        own, other = state[self._quaternions], before[self._quaternions]
        exponents = np.frexp(np.abs(other).max(axis=1))[1] - np.frexp(np.abs(own).max(axis=1))[1]
        differs[self._quaternions[(np.ldexp(own, exponents[:, np.newaxis]) == other).all(axis=1)]] = False
        moved = {number for number, mover in enumerate(self.movers) if differs[mover.places.state].any()}
        if moved:
            self._are_moved = True
            self._roused |= moved | self._beside(moved, before)

    def _beside(self, numbers: Collection[int], state: np.ndarray) -> set[int]:
        """Return who may have touched some movers in a state that was before."""
        if self._context_before is None:
            self._context_before = self._plant.CreateDefaultContext()
        self._context_before.SetDiscreteState(state)  # also one that is not finite
        self._extents.forget()
        none = np.zeros(len(self.movers), dtype=bool)
        lower, upper, _ = self._extents.swept(state, self._context_before, 0.0, none)
        self._extents.forget()
        rows = np.flatnonzero(np.isin(self._extents.owners, list(numbers)))
        return set(self._extents.owners[touched(lower, upper, rows)].tolist())

    def _find_groups(self, state: np.ndarray, step: int) -> None:
        """Find the movers of each island for the frame of a step."""
        self._until, self._found_at = self.next_frame(step), step
        duration = (self._until - step) * self._time_step
        if self._are_moved:
            self._extents.forget()
        elif self._clear == (self._groups, self._rest.version) and self._extents.are_clear(state, duration):
            return  # each is alone, as in what is calculated otherwise
        self._groups = self._groups_of(state, duration)

    def _groups_of(self, state: np.ndarray, duration: float) -> tuple[tuple[int, ...], ...]:
        rested = self._rest.rested
        lower, upper, rows = self._extents.swept(state, self._context, duration, ~rested)
        owners = self._extents.owners
        numbers = np.flatnonzero(~rested)
        if len(numbers) < len(rested) and (self._tied or rested[owners[touched(lower, upper, rows)]].any()):
            # What rests beside something that moves may hold up others that rest.
            rows, numbers = np.arange(len(owners)), np.arange(len(rested))
        parts = components(lower, upper, owners, rows, numbers.tolist(), self._tied)
        known = 0
        while len(parts) != known and any(len(part) > 1 for part in parts):
            known = len(parts)
            ways = after_blows(parts, owners, self._extents.speeds)[:, np.newaxis] * duration
            least, most = lower - ways, upper + ways
            if len(rows) < len(owners) and rested[owners[touched(least, most, rows)]].any():
                rows, numbers = np.arange(len(owners)), np.arange(len(rested))
            parts = components(least, most, owners, rows, numbers.tolist(), self._tied)
        groups = tuple(packed([part for part in parts if not rested[part].all()], self._most))
        self._clear = None
        if all(len(part) == 1 for part in parts):
            self._extents.measure(state)
            self._clear = groups, self._rest.version
        return groups

    def _use(self, state: np.ndarray, step: int) -> None:
        """Let the islands have the present state and inputs."""
        is_known = len(self._state) > 0 and self._taken == self._groups
        if not is_known:
            self._take(self._groups, state, step)
        self.inputs.give(self.islands, self._changed if is_known else None)
        self.inputs.give(self._resting, self._changed)
        for island in (*self.islands, *self._resting) if self._tied else ():
            island.attach(self._attached)
        self._changed = set()
        self._state = state

    def _follow_attachments(self) -> set[int]:
        """Read which joints hold something; return the movers for which that has changed."""
        if not self._tied:
            return set()
        before, self._attached = self._attached, dict(self.attachments())
        return set() if before == self._attached else {number for pair in self._tied for number in pair}

    def _take(self, groups: tuple[tuple[int, ...], ...], state: np.ndarray, step: int) -> None:
        """Let groups of movers take islands; a group that was one before stays in its island."""
        before = {tuple(sorted(island.members)): island for island in self.islands}
        kept = {group: before.pop(group) for group in groups if group in before}
        self._store.give_back(before.values())
        self.islands = [self._moved_in(group, state, step, kept.get(group)) for group in groups]
        self._places = [self._places_of(island.members) for island in self.islands]
        self._taken = groups

    def _moved_in(self, group: tuple[int, ...], state: np.ndarray, step: int, known: Island | None = None) -> Island:
        """Let a group of movers take an island, or take the same one again, and return it."""
        ordered = sorted(group, key=lambda number: (self._store.kinds[number], number))
        island = known or self._store.take(ordered)
        island.take(ordered, state[self._places_of(ordered)], step * self._time_step)
        return island

    def _places_of(self, members: Sequence[int]) -> np.ndarray:
        """Return the places of some movers in the plant's state, one after the other."""
        return np.concatenate([self.movers[number].places.state for number in members])

    # What follows from the step to come.

    def present(self, step: int) -> list[Island]:
        """Return islands of all movers with the present state and inputs, also of those that rest.

        Nothing is different afterwards for the steps to come.

        Args:
            step: The present step.
        """
        state = self._look()
        if self._until < step or self._are_moved:  # what was found for a frame holds at its end, too
            self._find_groups(state, step)
        self._use(state, step)
        awake = {number for group in self._groups for number in group}
        asleep = [number for number in range(len(self.movers)) if number not in awake]
        wanted = self._resting_groups(asleep)
        before = {tuple(sorted(island.members)): island for island in self._resting}
        kept = {group: before.pop(group) for group in wanted if group in before}
        self._store.give_back(before.values())
        new = {group: self._moved_in(group, self._state, step) for group in wanted if group not in kept}
        self._resting = [kept.get(group) or new[group] for group in wanted]
        self.inputs.give(new.values(), None)
        for island in new.values() if self._tied else ():
            island.attach(self._attached)
        return [*self.islands, *self._resting]

    def _resting_groups(self, asleep: Sequence[int]) -> list[tuple[int, ...]]:
        if not asleep:
            return []
        none = np.zeros(len(self.movers), dtype=bool)
        lower, upper, _ = self._extents.swept(self._state, self._context, 0.0, none)
        rows = np.flatnonzero(np.isin(self._extents.owners, asleep))
        return packed(components(lower, upper, self._extents.owners, rows, asleep, self._tied), self._most)

    def _release(self, islands: Iterable[Island]) -> None:
        for island in islands:
            island.discard()

    def discard(self) -> None:
        """Release all islands, so that their memory can be freed."""
        self._release(self.islands)
        self._release(self._resting)
        self._store.discard()


def _tied(built: TwinDiagram, movers: Sequence[Mover]) -> list[tuple[int, int]]:
    """Return the pairs of movers that joints which come and go may hold together."""
    numbers = {int(instance): number for number, mover in enumerate(movers) for instance in mover.places.instances}
    return [
        (numbers[int(joint.parent.model_instance())], numbers[int(joint.child.model_instance())])
        for joint in built.detachable_joints
    ]
