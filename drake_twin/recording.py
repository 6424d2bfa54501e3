"""What was done to a twin and when, so that it can be done again: the same calls at the same steps, the same state."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from drake_twin.errors import InputError, TwinError
from drake_twin.plain_data import from_plain, to_plain
from drake_twin.saved_file import read_saved, write_saved
from drake_twin.snapshot import Snapshot

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

    from drake_twin.twin import Twin

_KIND, _VERSION = "recording", 1
_Method = TypeVar("_Method", bound=Callable[..., Any])


@dataclass(frozen=True)
class Call:
    """Something that was done to a twin.

    Attributes:
        time: when (simulated s).
        name: the method of `Twin`; ``controller_manager`` and ``cancel`` are the methods of those.
        arguments: what it was given.
        named: what it was given by name.
    """

    time: float
    name: str
    arguments: tuple[Any, ...] = ()
    named: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Recording:
    """A run: how it began, what was done, and when it ended (simulated s)."""

    start: Snapshot
    calls: tuple[Call, ...]
    end: float

    def save(self, file: str | Path) -> None:
        """Writes it as JSON.

        Raises:
            RunError: the file cannot be written.
        """
        write_saved(file, _KIND, _VERSION, {"recording": to_plain(self)})

    @classmethod
    def load(cls, file: str | Path) -> "Recording":
        """Reads what `save` wrote.

        Raises:
            InputError: the file cannot be read, or is no recording of this version.
        """
        recording = from_plain(read_saved(file, _KIND, _VERSION).get("recording"))
        if not isinstance(recording, cls):
            raise InputError("this is no recording of a twin", file=file)
        return recording


def recorded(method: _Method) -> _Method:
    """A method of `Twin` whose calls belong into a recording."""

    @functools.wraps(method)
    def call(twin: "Twin", *arguments: Any, **named: Any) -> Any:
        twin.note(method.__name__, *arguments, **named)
        return method(twin, *arguments, **named)

    return call  # type: ignore[return-value]


def replay(recording: Recording, meshcat: "Meshcat | None" = None) -> "Twin":
    """Does again what was recorded, as fast as it goes.

    Args:
        recording: the run.
        meshcat: the page to draw on.

    Returns:
        The twin at the recording's end, in the same state to the last bit.

    Raises:
        InputError: the files that its robots are made of are not there.
    """
    from drake_twin.scenario import ScenarioFile
    from drake_twin.twin import Twin

    twin = Twin(ScenarioFile(recording.start.scenario, "recording").scenario, meshcat)
    twin.restore(recording.start)
    for call in recording.calls:
        if call.time > twin.time:
            twin.advance_to(call.time)
        _do(twin, call)
    if recording.end > twin.time:
        twin.advance_to(recording.end)
    return twin


def _do(twin: "Twin", call: Call) -> None:
    """Does what was done; what was refused then is refused now."""
    try:
        if call.name == "controller_manager":
            robot, method, *arguments = call.arguments
            getattr(twin.controller_manager(robot), method)(*arguments)
        else:
            getattr(twin, call.name)(*call.arguments, **call.named)
    except TwinError:
        pass
