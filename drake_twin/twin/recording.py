"""Recordings of the calls that changed a twin: repeated at the same steps, they give the same state."""

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import field, is_dataclass, replace
from numbers import Real
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError, TwinError
from drake_twin.messages import shortened
from drake_twin.saved import saved
from drake_twin.scenario import LONGEST_TIME, Robot, Scenario
from drake_twin.scenario.absolute_files import robot_with_files_found, with_files_found
from drake_twin.twin.owner import Owned, Owner, any_thread
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.saved_file import read_saved, write_saved
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.version_1 import converted_recording
from drake_twin.versions import RECORDING

CONTROLLER_MANAGER = "controller_manager"
SERVICES = ("load_controller", "configure_controller", "unload_controller", "switch_controller")
CALLS = {
    "apply_wrench": "entities.apply_wrench",
    "cancel": "control.cancel",
    "clear_emergency_stop": "control.clear_emergency_stop",
    "copy_model": "entities.copy_model",
    "delete": "entities.delete",
    "drag": "entities.drag",
    "emergency_stop": "control.emergency_stop",
    "place": "entities.place",
    "publish": "publish",
    "release": "entities.release",
    "reset": "reset",
    "restore": "restore",
    "send_goal": "graph.send_goal",
    "set_entity_state": "entities.set_state",
    "set_joint_positions": "entities.set_joint_positions",
    "set_parameters": "control.set_parameters",
    "set_time_step": "clock.set_time_step",
    "set_values": "entities.set_values",
    "silence": "graph.silence",
    "spawn": "entities.spawn",
}  # name in a recording → where `Twin` has the method
_NOT_KEPT = ("self", "on_result", "plan")  # arguments that do not decide what a call does to the state
_Method = TypeVar("_Method", bound=Callable[..., Any])


@saved("Call")
@dataclass(frozen=True)
class Call:
    """A call that changed a twin.

    Attributes:
        time: The simulation time (s).
        name: The method, one of `CALLS`, or ``controller_manager`` for a method of a robot's.
        arguments: The positional arguments.
        named: The keyword arguments.
        is_refused: Whether the twin refused the call.

    Raises:
        InputError: If an entry is invalid.
    """

    time: float
    name: str
    arguments: tuple[Any, ...] = ()
    named: Mapping[str, Any] = field(default_factory=dict)
    is_refused: bool = False

    def __post_init__(self) -> None:
        known = self.name == CONTROLLER_MANAGER or self.name in CALLS
        given = isinstance(self.arguments, tuple) and isinstance(self.named, Mapping)
        if not known or not given or not all(isinstance(name, str) for name in self.named) or not _is_time(self.time):
            raise InputError(f"{shortened(self.name)} at {shortened(self.time)} s is not a call that can be recorded")


@saved("Recording")
@dataclass(frozen=True)
class Recording:
    """A run: its first moment, the calls, and the simulation time of its end (s)."""

    start: Snapshot
    calls: tuple[Call, ...]
    end: float

    def __post_init__(self) -> None:
        are_calls = isinstance(self.calls, tuple) and all(isinstance(call, Call) for call in self.calls)
        if not isinstance(self.start, Snapshot) or not are_calls or not _is_time(self.end):
            raise InputError("a recording has a snapshot, calls and the time of the end")

    def save(self, file: str | Path) -> None:
        """Write the recording as JSON.

        Raises:
            RunError: If the file cannot be written.
        """
        write_saved(file, RECORDING, {"recording": to_plain(self)})

    @classmethod
    def load(cls, file: str | Path) -> "Recording":
        """Read a file that `save` wrote.

        Raises:
            InputError: If the file cannot be read, or is not a recording of a known version.
        """
        try:
            recording = from_plain(read_saved(file, RECORDING, converted_recording).get("recording"))
        except InputError as error:
            raise InputError(error.message, file=file) from None
        if not isinstance(recording, cls):
            raise InputError("this is not a recording of a twin", file=file)
        return recording


class Recorder(Owned, path="twin.recorder"):
    """Record calls.

    Args:
        owner: The thread that the twin belongs to.
        time: Returns the present simulation time (s).
        snapshot: Returns the present moment.

    Attributes:
        start: The moment at which the recording has begun; None without one.
        listeners: Called with the name and the arguments of each call that was not refused.
    """

    def __init__(self, owner: Owner, time: Callable[[], float], snapshot: Callable[[], Snapshot]):
        self._owner, self._time, self._snapshot = owner, time, snapshot
        self.start: Snapshot | None = None
        self.listeners: list[Callable[[str, tuple[Any, ...]], None]] = []
        self._calls: list[Call] = []

    @property
    @any_thread
    def is_on(self) -> bool:
        """Whether a recording has begun."""
        return self.start is not None

    def begin(self) -> None:
        """Start a recording at this moment; `recording` returns what has been recorded.

        Raises:
            InputError: If called inside a callback.
        """
        self.start = self._snapshot()
        self._calls = []

    def note(self, name: str, *arguments: Any) -> None:
        """Record a call that is not refused, and tell the listeners."""
        self.keep(name, *arguments)
        self.tell(name, arguments)

    def tell(self, name: str, arguments: tuple[Any, ...]) -> None:
        """Tell the listeners of a call."""
        for listener in self.listeners:
            listener(name, arguments)

    def keep(self, name: str, /, *arguments: Any, **named: Any) -> int | None:
        """Record a call.

        Returns:
            The call's index for `refuse`; None if no recording has begun.
        """
        if self.start is None:
            return None
        try:
            plain, plain_named = from_plain(to_plain((arguments, named)))
        except (TypeError, RecursionError):  # not valid for any method; it is about to be refused
            return None
        self._calls.append(Call(self._time(), name, plain, plain_named))
        return len(self._calls) - 1

    def refuse(self, index: int | None) -> None:
        """Mark a call as refused."""
        if index is not None:
            self._calls[index] = replace(self._calls[index], is_refused=True)

    def recording(self) -> Recording:
        """Return what has been done since `begin`: it can be saved, and replayed to the same state.

        Raises:
            InputError: If none has begun.
        """
        if self.start is None:
            raise InputError("nothing has been recorded: call recorder.begin() first")
        return Recording(self.start, tuple(self._calls), self._time())


def recorded(name: str, *, outside_callbacks: str | None = None) -> Callable[[_Method], _Method]:
    """Decorate a method of a twin or its groups so that its calls are recorded, without their callbacks.

    Args:
        name: Its name in `CALLS`.
        outside_callbacks: What it does, in one word, if callbacks cannot do that; a refused call is not recorded.
    """
    assert name in CALLS
    return functools.partial(_recorded, name, outside_callbacks)


def _recorded(name: str, outside_callbacks: str | None, method: _Method) -> _Method:
    signature = inspect.signature(method)

    @functools.wraps(method)
    def call(twin: Any, *arguments: Any, **named: Any) -> Any:
        if outside_callbacks is not None:
            twin._stepper.refuse_inside_callback(outside_callbacks)
        recorder: Recorder = twin._recorder
        if recorder.start is None and not recorder.listeners:
            return method(twin, *arguments, **named)
        given = signature.bind(twin, *arguments, **named)
        if recorder.start is None:
            result = method(twin, *arguments, **named)
            told = tuple(value for key, value in given.arguments.items() if key not in _NOT_KEPT)
            recorder.tell(name, told)
            return result
        for key, value in given.arguments.items():
            if key not in _NOT_KEPT:
                given.arguments[key] = _settled(value)
        noted = {key: value for key, value in given.arguments.items() if key not in _NOT_KEPT}
        index = recorder.keep(name, **noted)
        try:
            result = method(*given.args, **given.kwargs)
        except TwinError:
            recorder.refuse(index)
            raise
        recorder.tell(name, tuple(noted.values()))
        return result

    return call  # type: ignore[return-value]


def unrecorded(method: Callable[..., Any], *arguments: Any) -> Any:
    """Call a recorded method of a twin or its groups without a record; listeners are told.

    Raises:
        TwinError: As the method does.
    """
    twin: Any = method.__self__  # type: ignore[attr-defined]
    result = inspect.unwrap(method.__func__)(twin, *arguments)  # type: ignore[attr-defined]
    twin._recorder.tell(method.__name__, arguments)
    return result


def _settled(value: Any) -> Any:
    """Return a value for both the recording and the method.

    An iterator, which can be read only once, is read here, and files are found from the present working directory.
    """
    if value is None or isinstance(value, bool | int | float | str | bytes | np.ndarray | np.generic | Set):
        return value
    if isinstance(value, Robot):
        return robot_with_files_found(value)
    if isinstance(value, Scenario):
        return with_files_found(value)
    if isinstance(value, Real):
        try:
            return float(value)
        except OverflowError:
            return value
    try:
        if isinstance(value, Mapping):
            return {key: _settled(item) for key, item in value.items()}
        if isinstance(value, tuple):
            return value if hasattr(value, "_fields") else tuple(map(_settled, value))
        if isinstance(value, Iterable) and not is_dataclass(value):
            return [_settled(item) for item in value]
    except RecursionError:  # a list that contains itself
        pass
    return value


def _is_time(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value <= LONGEST_TIME
