"""A twin at one moment as plain data, to keep in memory or in a file, and to restore."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.saved import saved
from drake_twin.twin.saved_file import read_saved, write_saved
from drake_twin.twin.version_1 import converted_state
from drake_twin.values import is_number

_KIND, _VERSION = "saved state", 2
_OPTIONAL = {"systems", "pushes", "delayed"}  # entries that are left out where they are empty


@saved("Snapshot")
@dataclass(frozen=True)
class Snapshot:
    """A moment of a twin.

    Attributes:
        scenario: The scenario as YAML, with the robots.
        time_step: The physics step (s).
        step: The number of steps since time zero.
        robots: Robot → its state ``[q; v]``, its joints by name, its controllers and their memories, its servos.
        models: Moving model of the world → its states.
        parameters: Name → value of each changed parameter of the plant and its shapes: masses, friction.
        commands: Topic → the valid message, as on the port.
        expiries: Topic → the time at which its message expires (s).
        waiting: The pending messages in their order: topic and message.
        wrenches: The wrenches on links.
        schedule: The number of publications of each of the scenario's commands.
        silenced: Topics whose scheduled commands are dropped.
        next_time_step: The pending time step, which applies at its next multiple (s); None without one.
        systems: The state vectors of the user's own systems, by their names.
        pushes: The scenario's pushes that are still to come.
        delayed: The messages that are under way to robots with a command delay: time of arrival, topic and message.

    Raises:
        InputError: If an entry is invalid.
    """

    scenario: str
    time_step: float
    step: int
    robots: dict[str, Any]
    models: dict[str, Any]
    parameters: dict[str, list[Any]]
    commands: dict[str, Any]
    expiries: dict[str, float]
    waiting: list[list[Any]]
    wrenches: Any
    schedule: list[int]
    silenced: list[str]
    next_time_step: float | None
    systems: dict[str, Any] = field(default_factory=dict)
    pushes: list[Any] = field(default_factory=list)
    delayed: list[list[Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        kinds = {
            "robots": isinstance(self.robots, Mapping) and all(isinstance(r, Mapping) for r in self.robots.values()),
            "scenario": isinstance(self.scenario, str),
            "time_step": is_number(self.time_step),
            "step": type(self.step) is int and self.step >= 0,
            "models": isinstance(self.models, Mapping),
            "parameters": isinstance(self.parameters, Mapping)
            and all(isinstance(values, list) for values in self.parameters.values()),
            "commands": isinstance(self.commands, Mapping),
            "systems": isinstance(self.systems, Mapping),
            "pushes": isinstance(self.pushes, list),
            "delayed": isinstance(self.delayed, list)
            and all(isinstance(item, list) and len(item) == 3 and is_number(item[0]) for item in self.delayed),
            "expiries": isinstance(self.expiries, Mapping) and all(map(is_number, self.expiries.values())),
            "waiting": isinstance(self.waiting, list)
            and all(isinstance(item, list) and len(item) == 2 for item in self.waiting),
            "schedule": isinstance(self.schedule, list)
            and all(isinstance(count, int) and count >= 0 for count in self.schedule),
            "silenced": isinstance(self.silenced, list) and all(isinstance(topic, str) for topic in self.silenced),
            "next_time_step": self.next_time_step is None or is_number(self.next_time_step),
        }
        for name, is_right in kinds.items():
            if not is_right:
                raise InputError(f"{shortened(getattr(self, name))} is not a valid {name} of a saved state")

    def state(self) -> dict[str, Any]:
        """Return all entries except the scenario, by name."""
        entries = {name: value for name, value in vars(self).items() if name != "scenario"}
        return {name: value for name, value in entries.items() if value or name not in _OPTIONAL}

    def save(self, file: str | Path) -> None:
        """Write the snapshot as JSON.

        Raises:
            RunError: If the file cannot be written.
        """
        write_saved(file, _KIND, _VERSION, {"scenario": self.scenario, **self.state()})

    @classmethod
    def load(cls, file: str | Path) -> "Snapshot":
        """Read a file that `save` wrote.

        Raises:
            InputError: If the file cannot be read, or is not a snapshot of a known version.
        """
        data = read_saved(file, _KIND, _VERSION, converted_state)
        names = set(cls.__dataclass_fields__)
        if not names - _OPTIONAL <= set(data) <= names:
            raise InputError(f"a saved state has the entries {', '.join(sorted(names - _OPTIONAL))}", file=file)
        try:
            return cls(**data)
        except InputError as error:
            raise InputError(error.message, file=file) from None
