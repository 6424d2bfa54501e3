"""A recorded run, repeated."""

from operator import attrgetter
from typing import TYPE_CHECKING

from drake_twin.errors import InputError, TwinError
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.twin.recording import CALLS, CONTROLLER_MANAGER, SERVICES, Call, Recording
from drake_twin.twin.twin import Twin

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat


def replay(recording: Recording, meshcat: "Meshcat | None" = None) -> Twin:
    """Repeat a recorded run, as fast as possible.

    Args:
        recording: The run.
        meshcat: The page to draw on.

    Returns:
        The twin at the recording's end, in the same state to the last bit.

    Raises:
        InputError: If the files of its robots are missing.
    """
    twin = Twin(ScenarioFile(recording.start.scenario, "recording").scenario, meshcat)
    twin.restore(recording.start)
    for call in recording.calls:
        _advance(twin, call.time)
        _do(twin, call)
    _advance(twin, recording.end)
    return twin


def _advance(twin: Twin, time: float) -> None:
    """Advance to a time, also where the twin itself pauses."""
    while twin.time < time:
        twin.play()
        twin.advance_to(time)


def _do(twin: Twin, call: Call) -> None:
    """Repeat a call; a call that was refused then is refused now.

    Raises:
        InputError: If the call cannot be repeated.
    """
    try:
        if call.name == CONTROLLER_MANAGER:
            robot, method, *arguments = call.arguments
            if method not in SERVICES:
                raise InputError(f"unknown service {method!r}")
            getattr(twin.control.manager(robot), method)(*arguments)
        else:
            attrgetter(CALLS[call.name])(twin)(*call.arguments, **call.named)
    except (TwinError, TypeError, ValueError) as error:
        if not call.is_refused:
            raise InputError(f"{call.name} at {call.time:g} s of the recording cannot be repeated: {error}") from None
