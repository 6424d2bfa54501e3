"""What is known at one moment of a launch: configurations, the file at hand, what has started."""

import os
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.built_in_packages import BUILT_IN_PACKAGES
from drake_twin.ros2.event_queue import EventQueue, Handler
from drake_twin.ros2.launched import FailedInclude, Included, LaunchedProcess, Noted, ParameterText
from drake_twin.ros2.packages import AbsentError, LaunchPackages
from drake_twin.ros2.scopes import Scopes
from drake_twin.ros2.text_parts import text_parts

_MOST_PROCESSES = 20_000


@dataclass(frozen=True)
class Lasting:
    """A process that keeps running.

    Attributes:
        exited: Does what follows its end with an exit code.
        has_followers: Whether it has actions of its own for that.
    """

    exited: Callable[[int], None]
    has_followers: bool


class LaunchContext:
    """The state of an evaluation, under the names that launch files know from ROS.

    Args:
        argv: The command line's arguments, for files that look at it.
        noninteractive: As in ROS; unused.
        packages: Where packages are; the twin's own index by default.
        arguments: Launch configurations to start with.

    Attributes:
        launch_configurations: Name → value. Like ROS, the keys ``ros_namespace``, ``ros_remaps`` and
            ``global_params`` hold what PushRosNamespace, SetRemap and SetParameter said, so that scopes apply to them.
        scopes: The configurations and the environment, to be saved and restored.
        events: What is due, and the handlers.
        processes: What has started.
        failed_includes: The includes that were left out.
        declared: The arguments that the files declare.
        read: The launch configurations that the files read.
        includes: The files that were included, with their arguments.
        log: What LogInfo and the like print, and what was repaired or ignored.
        refused: What ROS 2 refuses, and the twin reads.
        rewritten: Path of a file made by the launch → what is in it.
        files: The files that are being executed, the outermost first, each with the place that includes it.
        place: Where the action that is being executed was written.
        lasting: The processes that keep running, by their keys.
        extensions: Package or group whose extensions were imported → what failed, see `launch_extensions`.
    """

    def __init__(
        self,
        *,
        argv: list[str] | None = None,
        noninteractive: bool = False,
        packages: LaunchPackages | None = None,
        arguments: Mapping[str, str] | None = None,
    ):
        self.argv = list(argv or [])
        self.noninteractive = noninteractive
        self.packages = packages or LaunchPackages(PackageIndex(), BUILT_IN_PACKAGES)
        self.scopes = Scopes(arguments or {})
        self.launch_configurations = self.scopes.configurations
        self.events = EventQueue(self._run_handler)
        self.processes: list[LaunchedProcess] = []
        self.failed_includes: list[FailedInclude] = []
        self.declared: set[str] = set()
        self.read: set[str] = set()
        self.includes: list[Included] = []
        self.log: list[str] = []
        self.refused: list[Noted] = []
        self.rewritten: dict[str, ParameterText] = {}
        self.files: list[tuple[str, Place | None]] = []
        self.place: Place | None = None
        self.extensions: dict[str, str] = {}
        self.lasting: dict[int, Lasting] = {}
        self._keys = count(1)
        self._locals: dict[str, Any] = {}
        self._globals: dict[str, Any] = {}
        self._anonymous: dict[str, str] = {}

    # ROS's names

    @property
    def environment(self) -> MutableMapping[str, str]:
        """The environment variables."""
        return os.environ

    @property
    def is_shutdown(self) -> bool:
        """Whether the launch has ended."""
        return self.events.is_shutdown

    @property
    def locals(self) -> Any:
        """Globals and locals as attributes."""
        return SimpleNamespace(**self.get_locals_as_dict())

    @property
    def asyncio_loop(self) -> Any:
        """None: evaluation is synchronous."""
        return None

    def perform_substitution(self, substitution: Any) -> str:
        """Return the text of a substitution, or of anything that ROS takes for a text.

        Raises:
            TypeError: If it is something else.
        """
        parts = list(text_parts(substitution))
        return "".join(part if isinstance(part, str) else str(part.perform(self)) for part in parts)

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Add values that end with the action at hand."""
        self._locals.update(extensions)

    def extend_globals(self, extensions: Mapping[str, Any]) -> None:
        """Add values that stay."""
        self._globals.update(extensions)

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return globals and locals."""
        return {**self._globals, **self._locals}

    def register_event_handler(self, event_handler: Handler, append: bool = False) -> None:
        """Register an event handler; the one registered last is asked first, as in ROS."""
        event_handler.captured = self.snapshot()
        handlers = self.events.handlers
        handlers.insert(len(handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: Handler) -> None:
        """Remove an event handler.

        Raises:
            InputError: If it is not registered.
        """
        if event_handler not in self.events.handlers:
            raise InputError("the event handler is not registered")
        self.events.handlers.remove(event_handler)

    def emit_event_sync(self, event: Any) -> None:
        """Run the handlers of an event, after those of the events before it."""
        self.events.after(0.0, lambda: self.events.dispatch(event))

    async def emit_event(self, event: Any) -> None:
        """Do as `emit_event_sync`."""
        self.emit_event_sync(event)

    def add_completion_future(self, completion_future: Any) -> None:
        """Do nothing: evaluation is synchronous."""

    # The file at hand

    @property
    def current_launch_file(self) -> str | None:
        """The launch file whose actions are being executed."""
        return self._locals.get("current_launch_file_path")

    @property
    def position(self) -> Place | None:
        """The place of the action that is being executed, or at least its file, for error messages."""
        return self.place or (Place(self.current_launch_file) if self.current_launch_file else None)

    def locate(self, path: str | Path) -> Path:
        """Find a file that is named by its author's own path, see `LaunchPackages.locate`."""
        return self.packages.locate(path, self.current_launch_file)

    @contextmanager
    def at(self, place: Place | None) -> Iterator[None]:
        """Execute something that was written at a place."""
        before = self.place
        self.place = place or before
        try:
            yield
        finally:
            self.place = before

    @contextmanager
    def in_file(self, file: str, included_at: Place | None) -> Iterator[None]:
        """Execute the entities of a launch file."""
        self.files.append((file, included_at))
        try:
            with self.loading(file):
                yield
        finally:
            self.files.pop()

    @contextmanager
    def loading(self, file: str) -> Iterator[None]:
        """Make a launch file the one at hand: packages are looked for near it."""
        before = dict(self._locals)
        folder = str(Path(file).parent)
        self._locals.update(current_launch_file_path=file, current_launch_file_directory=folder)
        try:
            yield
        finally:
            self._locals = before

    # Executing later, and what starts

    def snapshot(self) -> dict[str, Any]:
        """Return the configurations as they are now, the namespace among them, and the file at hand."""
        return {
            "configurations": dict(self.launch_configurations),
            "locals": dict(self._locals),
            "files": list(self.files),
        }

    @contextmanager
    def restored(self, snapshot: Mapping[str, Any]) -> Iterator[None]:
        """Restore a snapshot; configurations that were set since under other names stay."""
        before = self.snapshot()
        self.scopes.replace_configurations({**self.launch_configurations, **snapshot["configurations"]})
        self._locals = dict(snapshot["locals"])
        self.files = list(snapshot["files"])
        try:
            yield
        finally:
            self.scopes.replace_configurations(before["configurations"])
            self._locals = before["locals"]
            self.files = before["files"]

    def run_captured(self, captured: Mapping[str, Any], place: Place | None, call: Callable[[], None]) -> None:
        """Execute what was postponed, in the file and with the configurations where it was written.

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

    def start(self, process: LaunchedProcess) -> LaunchedProcess:
        """Add a process to those that were started.

        Raises:
            InputError: If there are too many.
        """
        if len(self.processes) >= _MOST_PROCESSES:
            raise InputError(f"the launch starts more than {_MOST_PROCESSES} processes: does it loop?")
        environment = {**self.scopes.environment_additions(), **process.environment}
        process = replace(process, start_time=self.events.time, environment=environment, key=next(self._keys))
        self.processes.append(process)
        return process

    def refused_by_ros(self, what: str, place: Place | None = None) -> None:
        """Note something that ROS 2 refuses and the twin reads.

        Args:
            what: What it is, as a sentence's beginning.
            place: Where it is written; by default the place of the action that is being executed.
        """
        place = place or self.position or Place("")
        if (refused := Noted(what, place)) not in self.refused:
            self.refused.append(refused)

    def anonymous_name(self, name: str) -> str:
        """Return a name that is used once; the same in every run."""
        return self._anonymous.setdefault(name, f"{name}_{len(self._anonymous) + 1}")

    def _run_handler(self, handler: Handler, event: Any) -> None:
        self.run_captured(handler.captured, handler.place, partial(handler.run, event, self))
