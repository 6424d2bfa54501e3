"""The node programs of a twin, from their start to their end."""

import logging
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import count
from math import inf
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.built_in_programs import built_in_programs
from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.python_programs import PythonProgram, python_programs
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.nodes import simulated_time
from drake_twin.nodes.action_graph import ActionGraph
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.imports import NodeFinder
from drake_twin.nodes.interfaces import Interfaces
from drake_twin.nodes.memory import most_memory
from drake_twin.nodes.package_folders import PackageFolders
from drake_twin.nodes.program import Program
from drake_twin.nodes.stand_ins import stand_in
from drake_twin.nodes.task import Task
from drake_twin.nodes.turns import Turns
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.node_program import with_later_ones
from drake_twin.twin.endpoints import ServiceEndpoint
from drake_twin.twin.twin import Twin

_log = logging.getLogger(__name__)
_SHORTEST_RESPAWN = 0.1  # s of simulation time, about as long as a process takes to start


class Nodes:
    """Runs node programs in lock-step with a twin, until it is closed.

    Args:
        twin: The twin; the programs begin when it next advances.
        programs: The programs, in the order of their turns; those of the twin's scenario by default.
        services: Returns the services of a twin with its present robots.
        is_stopped: Whether the run is to end, so that no program is waited for.
        patience: The processor's time (s) that a program may use in one turn.
        memory: How much memory a program may take (bytes); `most_memory` by default.

    Attributes:
        graph: What the programs share with the twin.
        actions: Their actions.
        programs: The programs.
        shutdown_reason: The reason for which a program's end ends all of them; None until then.
        on_shutdown: Is called then.

    Raises:
        InputError: If a program does not exist.
    """

    def __init__(
        self,
        twin: Twin,
        programs: Sequence[NodeProgram] | None = None,
        services: Callable[[Twin], Iterable[ServiceEndpoint]] = lambda twin: (),
        is_stopped: Callable[[], bool] = lambda: False,
        patience: float = 20.0,
        memory: float | None = None,
    ):
        programs = twin.scenario.nodes if programs is None else programs
        packages = PackageIndex(twin.scenario.package_paths)
        found = [find_program(program, packages).file for program in with_later_ones(programs)]
        self._twin = twin
        self._packages = packages
        self._waiting = [_Start(round(item.time * 1e9), item, place) for place, item in enumerate(programs)]
        self._places = count(len(programs))
        self.shutdown_reason: str | None = None
        self.on_shutdown: Callable[[], None] = lambda: None
        self._turns = Turns(self, patience, most_memory() if memory is None else memory, is_stopped)
        self._turns.outsider, self._turns.newcomer = self._use_inbox, self._look_soon
        self._uses_inbox = False
        self._turns.set_time(twin.time, twin.clock.time_step)
        self._folder_of = _folder_of(packages, found)
        sources = (stand_in, Interfaces(self._folder_of).source, PackageFolders(self._folder_of).source)
        self._finder = NodeFinder(sources, self._folder_of, lambda: packages.packages_near(found))
        self._is_open = False
        self.programs: list[Program] = []
        self._starts: dict[Program, _Start] = {}
        self._blocked: set[tuple[int, str]] = set()
        self._failed: set[tuple[int, str]] = set()
        self.graph = Graph(twin, self._turns, services)
        self.actions = ActionGraph(self.graph)
        self.graph.changed = self._look_again
        twin.more_topics = self.graph
        sys.meta_path.insert(0, self._finder)
        simulated_time.install()
        twin.owner.guests.append(self._turns.has_baton)
        alarm = twin.alarm
        alarm.call, alarm.jumped = self._slot, self._jump
        alarm.hasten(twin.time)
        twin.frames.callbacks.append(self._while_paused)
        self._is_open = True

    def close(self) -> None:
        """End the programs: each is interrupted as by Ctrl-C, and has less than a second to end."""
        if not self._is_open:
            return
        self._is_open = False
        twin = self._twin
        self._turns.set_time(twin.time, twin.clock.time_step)
        self.graph.is_open = False  # what they publish now would be for a time that never comes
        for task in self._turns.farewell(KeyboardInterrupt):
            if not task.is_outside:
                _log.warning("node %s: it did not end, and is abandoned", task.program.what)
        for program in self.programs:
            self.ended(program)
        twin.alarm.call, twin.alarm.jumped = (lambda: None), (lambda before: None)
        twin.alarm.set(inf)
        twin.frames.callbacks.remove(self._while_paused)
        twin.more_topics = None
        if self._uses_inbox:
            twin.inbox.close()
        twin.owner.guests.remove(self._turns.has_baton)
        simulated_time.uninstall()
        sys.meta_path.remove(self._finder)

    # The slots -------------------------------------------------------------------------------------------------------

    def _slot(self, *, is_paused: bool = False) -> None:
        """Let the programs have their turns at the present time."""
        twin, turns = self._twin, self._turns
        turns.set_time(twin.time, twin.clock.time_step)
        self._start_due()
        self.graph.follow()
        self.graph.deliver(everything=is_paused)
        due = min((turns.run(), *(start.time for start in self._waiting)))
        if due < inf:
            twin.alarm.hasten(due * 1e-9)

    def _look_again(self) -> None:
        """Let the programs look at what there is on the graph."""
        if self._is_open:
            self._twin.alarm.hasten(self._turns.after * 1e-9)

    def _start_due(self) -> None:
        for start in [item for item in self._waiting if item.time <= self._turns.limit]:
            self._waiting.remove(start)
            found = find_program(start.item, self._packages)
            item = start.item
            program = Program(start.place, item.what, found, item.arguments, item.environment, self._turns, self)
            program.rclpy |= {"graph": self.graph, "actions": self.actions}
            for name, module in simulated_time.own_modules(self._twin.scenario.seed + start.place).items():
                program.set_module(name, module)
            self.programs.append(program)
            self._starts[program] = start
            program.start()

    def _while_paused(self) -> None:
        """Let answers arrive while time stands still, such as that to who has paused it."""
        if self._twin.clock.paused and self._is_open:
            comes = any(task.is_watching and task.can_run() for task in self._turns.tasks)
            if comes or self.graph.has_mail or self._twin.alarm.due_step <= self._twin.clock.step_count:
                self._slot(is_paused=True)
            self._twin.alarm.do_requests()

    def _jump(self, before: float) -> None:
        """Follow a reset or a restored state: waits go on for as long as they had to go on."""
        self._turns.set_time(self._twin.time, self._twin.clock.time_step)
        by = self._turns.now - round(before * 1e9)
        for task in self._turns.tasks:
            task.shift(by)
        self.graph.shift(by)
        self._waiting = [replace(item, time=item.time + by) if item.follows else item for item in self._waiting]
        for program in self.programs:
            for jumped in program.jumped:
                jumped(by)
        self._twin.alarm.set(self._twin.time)

    def _look_soon(self) -> None:
        """Look after a thread that comes back from outside, and calls this."""
        self._twin.inbox.put(self._slot_of_newcomer)

    def _use_inbox(self) -> None:
        """Let the twin look for threads that come back."""
        if not self._uses_inbox:
            self._uses_inbox = True
            self._twin.inbox.open()

    def _slot_of_newcomer(self) -> None:
        if self._is_open:
            self._slot()

    # What becomes of programs ----------------------------------------------------------------------------------------

    def failed(self, program: Program, why: str, error: BaseException | None = None) -> None:
        """Take note of a program that has failed, and of the error that has ended it."""
        finding = Finding(Kind.FAILED, f"node {program.what}: {why}")
        if (program.index, why) in self._failed:  # it was started again
            _log.error("%s, again", finding)
            return
        self._failed.add((program.index, why))
        self._twin.more_findings.append(finding)
        _log.error("%s", finding, exc_info=error)

    def ignored(self, program: Program, what: str) -> None:
        """Take note of something that a program asks of ROS and the twin does not do."""
        finding = Finding(Kind.IGNORED, f"node {program.what}: {what}")
        if finding not in self._twin.more_findings:
            self._twin.more_findings.append(finding)
            _log.warning("%s", finding)

    def ended(self, program: Program) -> None:
        """Take note of a program that has ended."""
        self.actions.forget(program)
        self.graph.forget(program)
        if self._is_open and self.shutdown_reason is None:
            self._follow(program, self._starts.pop(program))

    def _follow(self, program: Program, start: "_Start") -> None:
        """Do what follows a program's end: first what the launch file says, then it may start again."""
        code = min(1, abs(program.exit_code))
        for following in (each for each in start.item.on_exit if each.exit_code in (None, code)):
            for line in following.log:
                print(f"[INFO] [launch.user]: {line}")
            for node in following.nodes:
                due = max(self._turns.after, self._turns.now + round(node.time * 1e9))
                self._waiting.append(_Start(due, node, next(self._places), follows=True))
            if following.shutdown is not None:
                self.shutdown_reason = following.shutdown
                self._waiting.clear()
                self.on_shutdown()
                self._twin.alarm.requests.append(self.close)
                return
        respawn = start.item.respawn
        if respawn is not None and start.retries != respawn.max_retries:
            due = self._turns.now + round(max(respawn.delay, _SHORTEST_RESPAWN) * 1e9)
            self._waiting.append(replace(start, time=due, retries=start.retries + 1, follows=True))

    def blocked(self, task: Task) -> None:
        """Take note of a thread that waits for something outside, while the simulation continues."""
        place = _place(task)
        if (task.program.index, place) not in self._blocked:
            self._blocked.add((task.program.index, place))
            where = f" ({place})" if place else ""
            _log.warning(
                "node %s waits for something outside of the simulation, which continues%s", task.program.what, where
            )

    def held_up(self, task: Task) -> None:
        """Take note of a thread that computes while others of its program could continue."""
        where = f" ({place})" if (place := _place(task)) else ""
        what = "node %s computes without a sleep or a spin, and its other threads wait until it has done so%s"
        _log.warning(what, task.program.what, where)

    def exceeded(self, task: Task, what: str) -> None:
        """Take note of a thread whose program takes too much, and has to end."""
        task.program.stop(what, _place(task))


@dataclass(frozen=True)
class _Start:
    """A start of a program that is to come.

    Attributes:
        time: The simulation time (ns).
        item: The program.
        place: Its place in the order of turns.
        retries: How often it was started again.
        follows: Whether it follows an end, so that a jump of time moves it.
    """

    time: int
    item: NodeProgram
    place: int
    retries: int = 0
    follows: bool = False


def find_program(node: NodeProgram, packages: PackageIndex) -> PythonProgram:
    """Find the script of a node program.

    Raises:
        InputError: If it does not exist, or is not in Python.
    """
    if not node.package:
        file = Path(node.executable)
        if not file.is_file():
            raise InputError("the node's script does not exist", file=file)
        return PythonProgram(file)
    own = built_in_programs(node.package)
    try:
        known = own | python_programs(packages.find(node.package))
    except MissingPackageError:
        if node.executable not in own:
            raise
        known = own
    if node.executable not in known:
        text = f"package {node.package!r} has no Python program {node.executable!r}"
        raise InputError(text, value=node.executable, valid=known)
    return known[node.executable]


def _folder_of(packages: PackageIndex, files: Sequence[Path]) -> Callable[[str], Path | None]:
    """Return what finds the folders of ROS packages, near the programs, too."""

    @cache
    def folder_of(name: str) -> Path | None:
        for file in files:
            with suppress(MissingPackageError):
                return packages.find(name, file)
        return None

    return folder_of


def _place(task: Task) -> str:
    """Return the file and line of a program's own code that a thread runs; empty without one."""
    frame = None if task.thread is None else sys._current_frames().get(task.thread.ident or 0)
    place: str = task.program.place(frame)
    return place
