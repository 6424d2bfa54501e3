"""A twin at one moment as plain data: kept in memory or in a file, and gone back to."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.saved_file import read_saved, write_saved

_KIND, _VERSION = "saved state", 1


@dataclass(frozen=True)
class Snapshot:
    """A moment of a twin.

    Attributes:
        scenario: the scenario as YAML; it says which robots there are.
        time_step: the physics step (s).
        step: the number of steps since time zero.
        robots: robot → its state ``[q; v]``, its joints in words, its controllers and what they keep, its servos.
        models: what moves in the world and is no robot → its states.
        commands: topic → the message that holds, as it is on the port.
        expiries: topic → the time at which its message no longer holds (s).
        wrenches: what pushes links.
        schedule: how often each of the scenario's commands has been published.
        silenced: topics whose scheduled commands are dropped.
    """

    scenario: str
    time_step: float
    step: int
    robots: dict[str, Any]
    models: dict[str, Any]
    commands: dict[str, Any]
    expiries: dict[str, float]
    wrenches: Any
    schedule: list[int]
    silenced: list[str]

    def save(self, file: str | Path) -> None:
        """Writes it as JSON.

        Raises:
            RunError: the file cannot be written.
        """
        write_saved(file, _KIND, _VERSION, dict(vars(self)))

    @classmethod
    def load(cls, file: str | Path) -> "Snapshot":
        """Reads what `save` wrote.

        Raises:
            InputError: the file cannot be read, or is no snapshot of this version.
        """
        data = read_saved(file, _KIND, _VERSION)
        names = set(cls.__dataclass_fields__)
        if set(data) != names:
            raise InputError(f"a saved state has the entries {', '.join(sorted(names))}", file=file)
        return cls(**data)
