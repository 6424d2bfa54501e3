"""What is known at one moment of a launch: configurations, environment, the file at hand, what has started."""

from __future__ import annotations

import copy
import heapq
import os
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launched import FailedInclude, LaunchedProcess, ParameterText
from drake_twin.ros2.packages import AbsentError, LaunchPackages

if TYPE_CHECKING:
    from drake_twin.ros2.event_handlers import EventHandler

# A launch file whose events call each other for ever ends here.
_MOST_EVENTS = 20_000
_MOST_PROCESSES = 20_000


class LaunchContext:
    """The state of an evaluation, under the names that launch files know from ROS.

    ``os.environ`` is the environment: the caller puts it back afterwards (see `drake_twin.ros2.evaluate`).

    Args:
        argv: the command line's arguments, for files that look at it.
        packages: where packages are; the twin's own index by default.
        arguments: launch configurations to start with.

    Attributes:
        launch_configurations: name → value. Like ROS, the keys ``ros_namespace``, ``ros_remaps`` and
            ``global_params`` hold what PushRosNamespace, SetRemap and SetParameter said, so that scopes apply to them.
        time: simulation time (s) of the actions that are being executed.
    """

    def __init__(
        self,
        *,
        argv: list[str] | None = None,
        noninteractive: bool = False,
        packages: LaunchPackages | None = None,
        arguments: Mapping[str, str] | None = None,
    ):
        from drake_twin.description.package_index import PackageIndex
        from drake_twin.ros2.stand_ins import BUILT_IN_PACKAGES

        self.argv = list(argv or [])
        self.noninteractive = noninteractive
        self.packages = packages or LaunchPackages(PackageIndex(), BUILT_IN_PACKAGES)
        self.launch_configurations: dict[str, Any] = dict(arguments or {})
        self.time = 0.0
        self.is_shutdown = False
        self.shutdown_reason: str | None = None
        self.processes: list[LaunchedProcess] = []
        self.failed_includes: list[FailedInclude] = []
        self.declared: set[str] = set()
        self.log: list[str] = []
        self.rewritten: dict[str, ParameterText] = {}  # path of a file made on the way → what is in it
        self.files: list[tuple[str, Place | None]] = []  # being executed, the outermost first, each with its includer
        self.handlers: list[EventHandler] = []
        self.place: Place | None = None
        self._start_environment = dict(os.environ)
        self._configuration_stack: list[dict[str, Any]] = []
        self._environment_stack: list[dict[str, str]] = []
        self._locals: dict[str, Any] = {}
        self._globals: dict[str, Any] = {}
        self._queue: list[tuple[float, int, Callable[[], None]]] = []
        self._sequence = 0
        self._anonymous: dict[str, str] = {}

    # The file at hand

    @property
    def current_launch_file(self) -> str | None:
        """The launch file whose actions are being executed."""
        return self._locals.get("current_launch_file_path")

    @property
    def place_file(self) -> str | None:
        """The file of the action that is being executed, for error messages."""
        return self.current_launch_file if self.place is None else self.place.file

    @property
    def place_line(self) -> int | None:
        """Its line."""
        return None if self.place is None else self.place.line

    def find_package(self, name: str) -> Path:
        """The share folder of a package, seen from the file at hand."""
        return self.packages.find(name, self.current_launch_file)

    def locate(self, path: str | Path) -> Path:
        """See `LaunchPackages.locate`."""
        return self.packages.locate(path, self.current_launch_file)

    @contextmanager
    def at(self, place: Place | None) -> Iterator[None]:
        """Executes something that was written at a place."""
        before = self.place
        self.place = place or before
        try:
            yield
        finally:
            self.place = before

    # Configurations and environment

    @property
    def environment(self) -> MutableMapping[str, str]:
        """The environment variables."""
        return os.environ

    def environment_additions(self) -> dict[str, str | None]:
        """What differs from the environment at the start; None for a variable that is gone."""
        changed: dict[str, str | None] = {
            name: value for name, value in os.environ.items() if self._start_environment.get(name) != value
        }
        changed.update((name, None) for name in self._start_environment if name not in os.environ)
        return changed

    def push_configurations(self) -> None:
        """Opens a scope of launch configurations."""
        self._configuration_stack.append(_copied(self.launch_configurations))

    def pop_configurations(self) -> None:
        """Leaves it again."""
        if not self._configuration_stack:
            raise InputError("PopLaunchConfigurations without PushLaunchConfigurations")
        self._replace_configurations(self._configuration_stack.pop())

    def push_environment(self) -> None:
        """Opens a scope of environment variables."""
        self._environment_stack.append(dict(os.environ))

    def pop_environment(self) -> None:
        """Leaves it again."""
        if not self._environment_stack:
            raise InputError("PopEnvironment without PushEnvironment")
        set_environment(self._environment_stack.pop())

    def reset_environment(self) -> None:
        """The environment that the launch was started with."""
        set_environment(self._start_environment)

    def _replace_configurations(self, values: Mapping[str, Any]) -> None:
        self.launch_configurations.clear()  # in place: files keep references to it
        self.launch_configurations.update(values)

    @contextmanager
    def scope(self) -> Iterator[None]:
        """Configurations and environment that end with the scope, however it ends."""
        depths = len(self._configuration_stack), len(self._environment_stack)
        self.push_configurations()
        self.push_environment()
        try:
            yield
        finally:
            del self._configuration_stack[depths[0] + 1 :]
            del self._environment_stack[depths[1] + 1 :]
            self.pop_configurations()
            self.pop_environment()

    def snapshot(self) -> dict[str, Any]:
        """Configurations, the namespace among them, as they are now, and the file at hand."""
        return {
            "configurations": _copied(self.launch_configurations),
            "locals": dict(self._locals),
            "files": list(self.files),
        }

    @contextmanager
    def restored(self, snapshot: Mapping[str, Any]) -> Iterator[None]:
        """Configurations as when a handler was registered; what was set since under other names is there too."""
        before = self.snapshot()
        self._replace_configurations({**self.launch_configurations, **_copied(snapshot["configurations"])})
        self._locals = dict(snapshot["locals"])
        self.files = list(snapshot["files"])
        try:
            yield
        finally:
            self._replace_configurations(before["configurations"])
            self._locals = before["locals"]
            self.files = before["files"]

    # ROS's own names

    def perform_substitution(self, subst: Any) -> str:
        """The text of a substitution."""
        from drake_twin.ros2.substitution import perform

        return perform(self, subst)

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Adds values that end with the action at hand."""
        self._locals.update(extensions)

    def extend_globals(self, extensions: Mapping[str, Any]) -> None:
        """Adds values that stay."""
        self._globals.update(extensions)

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Globals and locals."""
        return {**self._globals, **self._locals}

    @property
    def locals(self) -> Any:
        """Globals and locals as attributes."""
        from types import SimpleNamespace

        return SimpleNamespace(**self.get_locals_as_dict())

    @contextmanager
    def in_file(self, file: str, included_at: Place | None) -> Iterator[None]:
        """Executes the entities of a launch file."""
        self.files.append((file, included_at))
        try:
            with self.loading(file):
                yield
        finally:
            self.files.pop()

    @contextmanager
    def loading(self, file: str) -> Iterator[None]:
        """Makes a launch file the one at hand: packages are looked for near it."""
        before = dict(self._locals)
        folder = str(Path(file).parent)
        self._locals.update(current_launch_file_path=file, current_launch_file_directory=folder)
        try:
            yield
        finally:
            self._locals = before

    def register_event_handler(self, event_handler: Any, append: bool = False) -> None:
        """Waits for an event; the handler registered last is asked first, as in ROS."""
        event_handler.captured = self.snapshot()
        self.handlers.insert(len(self.handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: Any) -> None:
        """Waits no more."""
        if event_handler not in self.handlers:
            raise InputError("the event handler is not registered")
        self.handlers.remove(event_handler)

    def emit_event_sync(self, event: Any) -> None:
        """Puts an event behind those that wait."""
        self.after(0.0, lambda: self.dispatch(event))

    async def emit_event(self, event: Any) -> None:
        """As `emit_event_sync`."""
        self.emit_event_sync(event)

    def add_completion_future(self, completion_future: Any) -> None:
        """Nothing: evaluation is synchronous."""

    @property
    def asyncio_loop(self) -> Any:
        """None: evaluation is synchronous."""
        return None

    # Events

    def after(self, delay: float, call: Callable[[], None]) -> None:
        """Calls something ``delay`` (simulated s) from now, after everything that is due before it."""
        self._sequence += 1
        heapq.heappush(self._queue, (self.time + max(0.0, delay), self._sequence, call))

    def dispatch(self, event: Any) -> None:
        """Gives an event to the handlers that wait for it."""
        for handler in list(self.handlers):
            if handler in self.handlers and handler.matches(event):
                handler.fired = True
                if handler.handle_once:
                    self.handlers.remove(handler)
                self.run_captured(handler.captured, handler.place, partial(handler.run, event, self))

    def run_captured(self, captured: Mapping[str, Any], place: Place | None, call: Callable[[], None]) -> None:
        """Executes what was put off, in the file and with the configurations where it was written.

        What an included file needs and this machine does not have is noted, as when it is included.
        """
        with self.restored(captured), self.at(place):
            try:
                call()
            except AbsentError as error:
                if len(self.files) < 2:
                    raise
                file = self.files[-1][0]
                self.failed_includes.append(FailedInclude(file, error.message, place or Place(file)))

    def run_events(self) -> None:
        """Works through all events, by simulation time and then in the order in which they came."""
        count = 0
        while self._queue:
            time, _, call = heapq.heappop(self._queue)
            count += 1
            if count > _MOST_EVENTS:
                raise InputError(f"after {_MOST_EVENTS} events the launch still has not come to rest: does it loop?")
            self.time = time
            if not self.is_shutdown:
                call()

    def shut_down(self, event: Any) -> None:
        """Ends the launch: the OnShutdown handlers run, and nothing starts any more."""
        if not self.is_shutdown:
            self.shutdown_reason = event.reason
            self.dispatch(event)
            self.is_shutdown = True

    def start(self, process: LaunchedProcess) -> LaunchedProcess:
        """Adds a process to those that were started."""
        if len(self.processes) >= _MOST_PROCESSES:
            raise InputError(f"the launch starts more than {_MOST_PROCESSES} processes: does it loop?")
        environment = {**self.environment_additions(), **process.environment}
        process = replace(process, start_time=self.time, environment=environment)
        self.processes.append(process)
        return process

    def anonymous_name(self, name: str) -> str:
        """A name that is used once; the same in every run."""
        return self._anonymous.setdefault(name, f"{name}_{len(self._anonymous) + 1}")


def set_environment(values: Mapping[str, str]) -> None:
    """Makes ``os.environ`` exactly these variables."""
    for name in [name for name in os.environ if name not in values]:
        del os.environ[name]
    for name, value in values.items():
        if os.environ.get(name) != value:
            os.environ[name] = value


def _copied(configurations: Mapping[str, Any]) -> dict[str, Any]:
    """Lists (remappings, global parameters) are copied too: actions append to them."""
    return {name: copy.copy(value) if isinstance(value, list) else value for name, value in configurations.items()}
