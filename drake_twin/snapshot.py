"""A twin at one moment as plain data: kept in memory or in a file, and gone back to."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError, RunError

_FORMAT, _VERSION = "drake_twin snapshot", 1


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
        data = {"format": _FORMAT, "version": _VERSION, **vars(self)}
        try:
            Path(file).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            raise RunError(f"the state cannot be saved to {file} ({error.strerror})") from None

    @classmethod
    def load(cls, file: str | Path) -> "Snapshot":
        """Reads what `save` wrote.

        Raises:
            InputError: the file cannot be read, or is no snapshot of this version.
        """
        try:
            data = json.loads(Path(file).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, ValueError) as error:
            raise InputError(f"no saved state can be read ({error})", file=file) from None
        if not isinstance(data, dict) or data.pop("format", None) != _FORMAT:
            raise InputError("this is no saved state of a twin", file=file)
        version = data.pop("version", None)
        if version != _VERSION:
            raise InputError(f"the state was saved in version {version!r}, and only {_VERSION} can be read", file=file)
        names = set(cls.__dataclass_fields__)
        if set(data) != names:
            raise InputError(f"a saved state has the entries {', '.join(sorted(names))}", file=file)
        return cls(**data)
