"""Look ahead: what would happen if a command were sent, before the robot moves, in a process of its own.

A snapshot of the twin that follows the robot is continued in another process, faster than real time, while the twin
follows the robot as before.
"""

import contextlib
import os
import signal
import subprocess
import threading
import time as wall
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import CancelledError, Future
from functools import partial
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any, NamedTuple, Self

from drake_twin.errors import InputError, RunError, TwinError, described
from drake_twin.messages import shortened
from drake_twin.mirror.look_ahead_worker import DONE, INVALID, READY
from drake_twin.mirror.run_ahead import LONGEST_STEP
from drake_twin.mirror.trajectory_verdict import Allowed, Verdict
from drake_twin.python_process import python_command, stops_held_back
from drake_twin.scenario import Scenario
from drake_twin.scenario.absolute_files import with_files_found
from drake_twin.twin.plain_data import to_plain
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.twin import Twin
from drake_twin.values import is_number

LONGEST_CHECK = 60.0  # s of wall time after which a check is ended
LONGEST_DURATION = 3600.0  # s that can be simulated ahead
MOST_WAITING = 16
_START = 120.0  # s of wall time that the process may take to build its twin
_CLOSED = "nothing is looked ahead any more: it has been closed"


class PendingVerdict:
    """A check that is under way.

    Args:
        future: Its outcome.
    """

    def __init__(self, future: "Future[Verdict]"):
        self._future = future

    @property
    def is_done(self) -> bool:
        """Whether `result` returns, or raises, at once."""
        return self._future.done()

    def result(self, timeout: float | None = None) -> Verdict:
        """Wait for the verdict.

        Args:
            timeout: How long to wait at most (s of wall time).

        Raises:
            InputError: If the scenario cannot be built.
            RunError: If the verdict takes longer, or the process has ended without one.
        """
        try:
            return self._future.result(timeout)
        except TimeoutError:
            raise RunError(f"the check has no verdict after {timeout:g} s") from None
        except CancelledError:
            raise RunError("the check was cancelled") from None

    def cancel(self) -> bool:
        """Drop the check if it has not begun; return whether it is dropped."""
        return self._future.cancel()

    def later(self) -> Generator[None, None, Verdict]:
        """Yield until there is a verdict, and return it: for an answer of a service, which is continued each frame.

        Raises:
            InputError: As `result`.
            RunError: As `result`.
        """
        while not self.is_done:
            yield
        return self.result()


class _Request(NamedTuple):
    message: tuple[Any, ...]
    future: "Future[Verdict]"


class LookAhead:
    """Checks commands for the robots of a scenario; a context manager that ends its process.

    The process starts at once, and builds a twin of the scenario while others work. Where it ends, the check that it
    worked on has a readable error, and the next check starts another one. Node programs do not run in it, and neither
    do systems that extensions add to a diagram. Its methods may be called from any thread.

    Args:
        scenario: What the twin that is looked ahead from runs. A snapshot of another scenario, after a spawn for
            example, is simulated as well, but its diagram is built first.
        allowed: What is not a problem, unless a check says so.
        longest_step: How long the physics steps are at most (s); see `run_ahead`.
        longest_check: The wall time after which a check is ended (s).

    Raises:
        InputError: If a file of the scenario is missing.
    """

    def __init__(
        self,
        scenario: Scenario,
        allowed: Allowed | None = None,
        *,
        longest_step: float = LONGEST_STEP,
        longest_check: float = LONGEST_CHECK,
    ):
        self._scenario = with_files_found(scenario)
        self._allowed, self._longest_step, self._longest = allowed or Allowed(), longest_step, longest_check
        self._requests: SimpleQueue[_Request | None] = SimpleQueue()
        self._lock = threading.Lock()
        self._is_closed = False
        self._process: subprocess.Popen[bytes] | None = None
        self._link: Connection | None = None
        self._warm: Future[None] = Future()
        self._thread = threading.Thread(target=self._serve, name="look ahead", daemon=True)
        self._thread.start()

    @property
    def process_id(self) -> int | None:
        """The number of the process; None while there is not one."""
        process = self._process
        return None if process is None else process.pid

    def wait_until_warm(self, timeout: float | None = None) -> None:
        """Wait until the process that was started first has built its twin; checks do not need this.

        Args:
            timeout: How long to wait at most (s of wall time).

        Raises:
            InputError: If the scenario cannot be built.
            RunError: If the process has ended, or is not ready in that time.
        """
        try:
            self._warm.result(timeout)
        except TimeoutError:
            raise RunError(f"the process that looks ahead is not ready after {timeout:g} s") from None

    def check(
        self,
        snapshot: Snapshot,
        commands: Sequence[tuple[float, str, Any]] = (),
        duration: float | None = None,
        allowed: Allowed | None = None,
    ) -> PendingVerdict:
        """Begin to check commands, and return at once.

        Args:
            snapshot: The moment to begin at: `Twin.snapshot`.
            commands: When (s from then) what would be published on which topic, or be sent as a goal to which action:
                messages, or their fields. Without any, what is under way is continued.
            duration: How long to look ahead (s); by default until joints have settled after the last trajectory, or 5 s
                after the last command that has no end. The ends of trajectories that are later are not judged.
            allowed: What is not a problem.

        Raises:
            InputError: If an argument is invalid, `MOST_WAITING` checks wait, or this has been closed.
        """
        if not isinstance(snapshot, Snapshot):
            raise InputError(f"{shortened(snapshot)} is not a Snapshot: take one with Twin.snapshot()")
        if duration is None and not commands:
            raise InputError("a check without commands needs a duration (s)")
        if duration is not None and not (is_number(duration, 0.0) and 0.0 < duration <= LONGEST_DURATION):
            raise InputError(f"invalid duration {duration!r}: it must be above zero and at most {LONGEST_DURATION:g} s")
        plain = _plain_commands(commands)
        if self._is_closed:
            raise InputError(_CLOSED)
        if self._requests.qsize() >= MOST_WAITING:
            raise InputError(f"{MOST_WAITING} checks wait already: wait for their results before you ask for more")
        future: Future[Verdict] = Future()
        message = (snapshot, plain, duration, allowed or self._allowed, self._longest_step)
        self._requests.put(_Request(message, future))
        return PendingVerdict(future)

    def close(self) -> None:
        """End the process; checks that are under way raise `RunError`. Another call does nothing."""
        with self._lock:
            if self._is_closed:
                return
            self._is_closed = True
            if self._process is not None:
                self._process.kill()
        self._requests.put(None)
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # In the thread ---------------------------------------------------------------------------------------------------

    def _serve(self) -> None:
        _settle(self._warm, self._start)
        while (request := self._requests.get()) is not None:
            if request.future.set_running_or_notify_cancel():
                _settle(request.future, partial(self._verdict, request.message))
        self._end()
        while not self._requests.empty():
            request = self._requests.get()
            if request is not None and request.future.set_running_or_notify_cancel():
                request.future.set_exception(RunError(_CLOSED))

    def _verdict(self, message: tuple[Any, ...]) -> Verdict:
        if self._process is not None and self._process.poll() is not None:  # it has ended between two checks
            self._end()
        if self._process is None:
            self._start()
        verdict: Verdict = self._exchange(message, DONE, self._longest)
        return verdict

    def _start(self) -> None:
        """Start the process, and wait until it is ready.

        Raises:
            InputError: If the scenario cannot be built.
            RunError: If the process ends before.
        """
        ours, theirs = Pipe()
        numbers = (theirs.fileno(), os.getpid())
        with self._lock:
            if self._is_closed:
                raise RunError(_CLOSED)
            with stops_held_back():
                self._process = subprocess.Popen(
                    [*python_command("drake_twin.mirror.look_ahead_worker"), *map(str, numbers)],
                    pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
        theirs.close()
        self._link = ours
        self._exchange(self._scenario, READY, _START)

    def _exchange(self, message: Any, expected: str, longest: float) -> Any:
        """Send a message and return what is answered; without an answer the process is ended.

        Raises:
            InputError: If the answer is that something is invalid.
            RunError: If an answer is missing.
        """
        assert self._link is not None, "it has been started"
        begin = wall.monotonic()
        answer = None
        with contextlib.suppress(EOFError, OSError):
            self._link.send(message)
            if self._link.poll(max(0.0, longest - (wall.monotonic() - begin))):
                answer = self._link.recv()
            else:
                self._end()
                raise RunError(f"the process that looks ahead has not answered for {longest:g} s, and was ended")
        if answer is None:
            raise RunError(_CLOSED if self._is_closed else self._how_it_ended())
        what, value = answer
        if what != expected:
            if expected == READY:
                self._end()
            raise InputError(value) if what == INVALID else RunError(f"the check has failed: {value}")
        return value

    def _how_it_ended(self) -> str:
        process = self._process
        assert process is not None
        self._end()
        code = process.returncode
        how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"has ended with exit code {code}"
        return f"the process that looks ahead {how}, without a verdict; the next check starts another one"

    def _end(self) -> None:
        if self._link is not None:
            self._link.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._link = self._process = None


def check_trajectory(
    twin: Twin,
    topic: str,
    trajectory: Any,
    duration: float | None = None,
    allowed: Allowed | None = None,
    timeout: float | None = None,
) -> Verdict:
    """Check what would happen if a trajectory, or another command, were sent now.

    The first check of a twin starts a process, which takes seconds; it is closed with the twin.

    Args:
        twin: The twin, which is not changed.
        topic: The topic of the command, or an action.
        trajectory: The message, or its fields; of an action the goal.
        duration: How long to look ahead (s); by default until the joints have settled after the trajectory.
        allowed: What is not a problem.
        timeout: How long to wait for the verdict at most (s of wall time).

    Raises:
        InputError: If an argument is invalid, or the call is made inside a callback.
        RunError: If the verdict takes longer, or the process has ended without one.
    """
    return look_ahead_of(twin).check(twin.snapshot(), [(0.0, topic, trajectory)], duration, allowed).result(timeout)


def look_ahead_of(twin: Twin) -> LookAhead:
    """Return what looks ahead for a twin, and is closed with it; it is started when it is first asked for."""
    for companion in twin.companions:
        if isinstance(companion, LookAhead) and not companion._is_closed:
            return companion
    ahead = LookAhead(twin.scenario)
    twin.companions.append(ahead)
    return ahead


def answer_later(
    twin: Twin, topic: str, trajectory: Any, duration: float | None = None, allowed: Allowed | None = None
) -> Generator[None, None, dict[str, Any]]:
    """Check as `check_trajectory` does without waiting: the answer of a service that is given between advances.

    Args:
        twin: The twin, which is not changed.
        topic: The topic of the command, or an action.
        trajectory: The message, or its fields; of an action the goal.
        duration: How long to look ahead (s); by default until the joints have settled after the trajectory.
        allowed: What is not a problem.

    Returns:
        A generator that yields once a frame until there is a verdict, and returns its `Verdict.fields`. The snapshot is
        taken when it is first continued.

    Raises:
        InputError: As `check_trajectory`, when it is continued.
        RunError: Likewise.
    """
    pending = look_ahead_of(twin).check(twin.snapshot(), [(0.0, topic, trajectory)], duration, allowed)
    return (yield from pending.later()).fields()


def _settle(future: "Future[Any]", function: Callable[[], Any]) -> None:
    """Give a future what a function returns, or raises."""
    try:
        future.set_result(function())
    except TwinError as error:
        future.set_exception(error)
    except Exception as error:  # such as a process that cannot be started, or a scenario that cannot be sent
        future.set_exception(RunError(f"nothing can be looked ahead ({described(error)})"))


def _plain_commands(commands: Any) -> Any:
    """Return commands as plain data, which is a copy of them.

    Raises:
        InputError: If they are invalid.
    """
    checked = []
    if isinstance(commands, str | bytes):
        commands = [commands]
    for command in commands:
        if not isinstance(command, tuple | list) or len(command) != 3:
            raise InputError(f"{shortened(command)} is not a command: it has a time from now, a topic, and its fields")
        time, topic, data = command
        if not is_number(time, 0.0) or time > LONGEST_DURATION:
            raise InputError(f"invalid time {time!r} of a command: it must be from zero to {LONGEST_DURATION:g} s")
        if not isinstance(topic, str):
            raise InputError(f"{shortened(topic)} is not a topic: it must be a text")
        checked.append((float(time), topic, data))
    try:
        return to_plain(checked)
    except (TypeError, RecursionError) as error:
        raise InputError(f"the fields of a command cannot be sent to another process ({error})") from None
