"""The state machine of an elevator: which floor is next, when doors open and close, as gz-sim's Elevator has it."""

from collections.abc import Sequence
from dataclasses import replace

from drake_twin.dataclass import dataclass
from drake_twin.description.elevator_shaft import Shaft
from drake_twin.frozen import Frozen
from drake_twin.saved import saved

IDLE, OPENING, WAITING, CLOSING, MOVING = "idle", "opening", "waiting", "closing", "moving"

_AT_DOOR, _AT_FLOOR, _AT_REST = 0.02, 0.15, 0.01  # m or rad, m, per second


@dataclass(frozen=True)
class Measured:
    """What is measured at an update.

    Attributes:
        time: The time (s).
        cabin: Position and velocity of the cabin's joint.
        doors: Those of each door.
        blocked: Whether something stands in each doorway.
    """

    time: float
    cabin: tuple[float, float]
    doors: Sequence[tuple[float, float]]
    blocked: Sequence[bool]


@saved("ElevatorState")
@dataclass(frozen=True)
class ElevatorState(Frozen):
    """What an elevator remembers.

    Attributes:
        phase: What it does: one of `IDLE`, `OPENING`, `WAITING`, `CLOSING`, `MOVING`.
        floor: The floor that the cabin is nearest to.
        door: The floor whose door opens or closes.
        targets: The floors to go to, in this order.
        later: The floors that were asked for while the door is open or the cabin moves, in this order.
        timeout: When the open door is to close (s).
        was_blocked: Whether the doorway was blocked at the last update.
        orders: What the last update orders of the joints, by number.
        told: When the floor was published last (s); None before.
        is_told: Whether the last update publishes it.
        message: The number of the last message that was used.
    """

    phase: str = IDLE
    floor: int = 0
    door: int = 0
    targets: tuple[int, ...] = ()
    later: tuple[int, ...] = ()
    timeout: float = 0.0
    was_blocked: bool = False
    orders: tuple[int, ...] = ()
    told: float | None = None
    is_told: bool = False
    message: int = 0


def asked(state: ElevatorState, target: int, shaft: Shaft) -> ElevatorState:
    """Return the state of an elevator that is asked to go to a floor.

    A floor on the way to another one comes before that. What is asked for while the door is open or the cabin moves
    counts from when the door closes.
    """
    if state.phase not in (IDLE, CLOSING):
        return replace(state, later=(*state.later, target))
    state = replace(state, targets=_queued(state.targets, state.floor, target))
    if state.phase == CLOSING:
        return state
    if state.targets[0] != state.floor:
        return _moving(state, shaft)
    return _opening(replace(state, targets=state.targets[1:]), shaft)


def updated(state: ElevatorState, now: Measured, shaft: Shaft) -> ElevatorState:
    """Return the state after an update.

    Unlike gz-sim, which counts whole metres, the floor is the nearest one where floors are near to each other.
    """
    distances = [abs(height - now.cabin[0]) for height in shaft.floors]
    state = replace(state, floor=distances.index(min(distances)))
    is_blocked = now.blocked[state.floor]
    if state.was_blocked and not is_blocked:
        state = replace(state, timeout=now.time + shaft.wait)
    state = replace(state, was_blocked=is_blocked)
    if state.phase == WAITING and not is_blocked and now.time >= state.timeout - 1e-9:
        state = _closing(state, shaft)
    if state.phase in (OPENING, CLOSING):
        target = shaft.doors[state.door] if state.phase == OPENING else 0.0
        if _is_there(now.doors[state.door], target, _AT_DOOR):
            if state.phase == OPENING:
                state = replace(state, phase=WAITING, timeout=now.time + shaft.wait, was_blocked=False)
            elif state.targets:
                state = _moving(state, shaft)
            else:
                state = replace(state, phase=IDLE)
    if state.phase == MOVING and _is_there(now.cabin, shaft.floors[state.targets[0]], _AT_FLOOR):
        state = _opening(replace(state, targets=state.targets[1:]), shaft)
    return state


def _is_there(joint: tuple[float, float], target: float, tolerance: float) -> bool:
    """Tell whether a joint is at a target and not on its way further up, as gz-sim, which looks at no sign."""
    return abs(target - joint[0]) <= tolerance and joint[1] <= _AT_REST


def _opening(state: ElevatorState, shaft: Shaft) -> ElevatorState:
    return replace(state, phase=OPENING, door=state.floor, orders=(*state.orders, shaft.open(state.floor)))


def _closing(state: ElevatorState, shaft: Shaft) -> ElevatorState:
    later, orders = state.later, (*state.orders, shaft.close(state.floor))
    state = replace(state, phase=CLOSING, door=state.floor, later=(), orders=orders)
    for target in later:
        state = asked(state, target, shaft)
    return state


def _moving(state: ElevatorState, shaft: Shaft) -> ElevatorState:
    return replace(state, phase=MOVING, orders=(*state.orders, shaft.move(state.targets[0])))


def _queued(targets: tuple[int, ...], floor: int, target: int) -> tuple[int, ...]:
    """Return the floors to go to with another one, before the first that is behind it."""
    if target in targets:
        return targets
    before = floor
    for place, other in enumerate(targets):
        if min(before, other) <= target < max(before, other):
            return (*targets[:place], target, *targets[place:])
        before = other
    return (*targets, target)
