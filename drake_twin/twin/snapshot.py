"""A twin at one moment as plain data, to keep in memory or in a file, and to restore."""

from collections.abc import Iterable
from dataclasses import field
from math import inf
from pathlib import Path
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.saved import saved
from drake_twin.twin.saved_file import read_saved, write_saved
from drake_twin.twin.version_1 import converted_state
from drake_twin.typed_data import field_types, misfit
from drake_twin.values import is_number
from drake_twin.versions import SAVED_STATE

# Entries that are left out where they are empty.
_OPTIONAL = {
    "systems",
    "pushes",
    "delayed",
    "later_parameters",
    "steady_wrenches",
    "triggered",
    "detected",
    "deployed",
    "to_be_fixed",
    "wind",
    "touching",
    "islands",
}


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
        later_parameters: Robot → node → what has been set of its parameters and is not followed yet.
        steady_wrenches: The wrenches without an end, also on entities that do not exist.
        triggered: What publishes messages later, as it has heard one: the time (s), its robot or an empty text for the
            world, and its number there.
        detected: The performers that are inside a region: its model, its number there, and their models.
        deployed: The number of models that a robot has dropped: the robot, the plugin that drops them, and how many.
        to_be_fixed: The time (s) at which a model that was dropped is to be fixed to the world, and its name.
        wind: What the world's wind was last told, where it changes.
        islands: Which robots and models share a plant, until which step, and for how long each has been still.
        touching: What looks for touches: its model, its number there, and since when it touches (s); None if not.

    Raises:
        InputError: If an entry is invalid.
    """

    scenario: str
    time_step: float
    step: int
    robots: dict[str, dict[str, Any]]
    models: dict[str, Any]
    parameters: dict[str, list[Any]]
    commands: dict[str, Any]
    expiries: dict[str, float]
    waiting: list[tuple[str, Any]]
    wrenches: Any
    schedule: list[int]
    silenced: list[str]
    next_time_step: float | None
    systems: dict[str, Any] = field(default_factory=dict)
    pushes: list[Any] = field(default_factory=list)
    delayed: list[tuple[float, str, Any]] = field(default_factory=list)
    later_parameters: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    steady_wrenches: list[Any] = field(default_factory=list)
    triggered: list[tuple[float, str, int]] = field(default_factory=list)
    detected: list[tuple[str, int, list[str]]] = field(default_factory=list)
    deployed: list[tuple[str, str, int]] = field(default_factory=list)
    to_be_fixed: list[tuple[float, str]] = field(default_factory=list)
    wind: dict[str, Any] = field(default_factory=dict)
    touching: list[tuple[str, int, float | None]] = field(default_factory=list)
    islands: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, kind in field_types(Snapshot).items():
            if misfit(kind, getattr(self, name), (tuple, list)) is not None:
                self._refuse(name)
        numbers: dict[str, Iterable[float]] = {
            "time_step": [self.time_step],
            "next_time_step": [] if self.next_time_step is None else [self.next_time_step],
            "expiries": self.expiries.values(),
            "delayed": [time for time, *_ in self.delayed],
            "triggered": [time for time, *_ in self.triggered],
            "to_be_fixed": [time for time, _ in self.to_be_fixed],
        }
        counts: dict[str, Iterable[float]] = {"step": [self.step], "schedule": self.schedule}
        for name, values in (numbers | counts).items():
            if not all(is_number(value, 0.0 if name in counts else -inf) for value in values):
                self._refuse(name)

    def _refuse(self, name: str) -> None:
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
        write_saved(file, SAVED_STATE, {"scenario": self.scenario, **self.state()})

    @classmethod
    def load(cls, file: str | Path) -> "Snapshot":
        """Read a file that `save` wrote.

        Raises:
            InputError: If the file cannot be read, or is not a snapshot of a known version.
        """
        data = read_saved(file, SAVED_STATE, converted_state)
        names = set(cls.__dataclass_fields__)
        if not names - _OPTIONAL <= set(data) <= names:
            raise InputError(f"a saved state has the entries {', '.join(sorted(names - _OPTIONAL))}", file=file)
        try:
            return cls(**data)
        except InputError as error:
            raise InputError(error.message, file=file) from None
