"""Stand-in for ``rclpy.executors``: spinning is waiting for the baton with something to do."""

import inspect
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import inf
from typing import Any

from drake_twin.nodes.rclpy.context import default_context
from drake_twin.nodes.rclpy.coroutines import await_or_execute as await_or_execute
from drake_twin.nodes.rclpy.coroutines import followed, result_of
from drake_twin.nodes.rclpy.logging import RcutilsLogger
from drake_twin.nodes.rclpy.task import Future, Task
from drake_twin.nodes.rclpy.timer import Timer
from drake_twin.nodes.task import Task as Thread
from drake_twin.nodes.task import present_task

_MOST_THREADS = 8  # of a MultiThreadedExecutor, whatever the machine has, so that runs are repeatable


class TimeoutException(Exception):
    """Raised when a wait has taken too long."""


class ShutdownException(Exception):
    """Raised by an executor that has been shut down."""


class ExternalShutdownException(Exception):
    """Raised when the context has been shut down."""


class ConditionReachedException(Exception):
    """Raised when a condition holds."""


class TimeoutObject:
    """A wait that may take too long."""

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout

    @property
    def timeout(self) -> float:
        return self._timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._timeout = timeout


class Executor:
    """Calls back for nodes.

    As in rclpy, it works in rounds: each task that can continue, the newest one first, then all that is ready, once.

    Args:
        context: The context.
    """

    def __init__(self, *, context: Any = None) -> None:
        self._context = context or default_context()
        self._nodes: list[Any] = []
        self._tasks: list[Task] = []
        self._round: deque[Any] = deque()
        self._has_done_tasks = False
        self._given: list[Any] = []  # what `wait_for_ready_callbacks` has returned, and has not begun yet
        self._is_shutdown = False
        self._is_awake = False

    @property
    def context(self) -> Any:
        return self._context

    def create_future(self) -> Future:
        return Future(executor=self)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Run a function or a coroutine at the next spin."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append(task)
        return task

    def add_node(self, node: Any) -> bool:
        if node in self._nodes:
            return False
        self._nodes.append(node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Any) -> None:
        if node in self._nodes:
            self._nodes.remove(node)
            self.wake()

    def get_nodes(self) -> list[Any]:
        return list(self._nodes)

    def wake(self) -> None:
        self._is_awake = True

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        self._is_shutdown = True
        self._nodes.clear()
        self._round.clear()
        return True

    def __enter__(self) -> "Executor":
        return self

    def __exit__(self, exc_type: Any, exc_val: Any, exc_tb: Any) -> None:
        self.shutdown()

    def spin(self) -> None:
        """Call back until the context is shut down."""
        while self._context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Call back until a future is done, or for some simulation time (s)."""
        end = inf if timeout_sec is None or timeout_sec < 0 else present_task().now + round(timeout_sec * 1e9)
        while self._context.ok() and not future._done and not self._is_shutdown:
            now = present_task().now
            if now >= end and timeout_sec:
                return
            left = None if end == inf else max(0, end - now) * 1e-9
            self.spin_once_until_future_complete(future, left)
            if timeout_sec == 0:
                return

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Call back once, after at most some simulation time (s)."""
        raise NotImplementedError

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        """Call back once, after at most some simulation time (s), or until a future is done."""
        raise NotImplementedError

    def can_execute(self, entity: Any) -> bool:
        """Return whether the callback group of something lets it be done."""
        return entity not in self._given and bool(entity.callback_group.can_execute(entity))

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> tuple[Task, Any, Any]:
        """Wait for something to do; return it as a task, with what it is of and its node.

        Raises:
            TimeoutException: If there is nothing for some simulation time (s).
            ConditionReachedException: If a condition holds.
            ShutdownException: If the executor has been shut down.
            ExternalShutdownException: If the context has been shut down.
        """
        return next(self._wait_for_ready_callbacks(*args, **kwargs))

    def _wait_for_ready_callbacks(
        self,
        timeout_sec: Any = None,
        nodes: Sequence[Any] | None = None,
        condition: Callable[[], bool] = lambda: False,
    ) -> Iterator[tuple[Task, Any, Any]]:
        """Yield what there is to do, each time waiting as `wait_for_ready_callbacks` does."""
        while True:
            yield self._ready_callback(timeout_sec, nodes, condition)

    def _ready_callback(
        self, timeout_sec: Any, nodes: Sequence[Any] | None, condition: Callable[[], bool]
    ) -> tuple[Task, Any, Any]:
        work = self._next_work(_nanoseconds(timeout_sec), condition, self._nodes if nodes is None else nodes)
        if isinstance(work, Task):
            return work, None, None
        self._given.append(work)

        def begin() -> Any:
            self._given.remove(work)
            return self._begun(work) if work.callback_group.beginning_execution(work) else None

        node = next((node for node in self._nodes if work in node.handle.entities), None)
        task = self.create_task(begin)
        return task, getattr(work, "waitable", work), node

    def _next_work(self, timeout: float, is_over: Callable[[], bool], nodes: Sequence[Any]) -> Any:
        """Wait for something to do, at most for ns or until a condition holds; see `wait_for_ready_callbacks`."""
        thread = present_task()
        end = inf if timeout == inf else thread.now + timeout
        while True:
            if self._is_shutdown:
                raise ShutdownException
            if is_over():
                raise ConditionReachedException
            if (work := self._taken(nodes)) is not None:
                return work
            now = thread.now
            if now >= end:
                if timeout <= 0:
                    thread.count_idle_call()
                raise TimeoutException
            until = inf if end == inf else max(thread.after, end)
            due = partial(self._due, nodes)
            thread.wait(lambda: self._is_awake or self._is_over() or is_over() or self._has_work(nodes), until, due)
            self._is_awake = False
            if not self._context.ok() and not self._is_shutdown:
                raise ExternalShutdownException

    def _is_over(self) -> bool:
        return self._is_shutdown or not self._context.is_valid

    def _has_work(self, nodes: Sequence[Any]) -> bool:
        """Return whether anything can be done."""
        for node in nodes:
            for entity in node.handle.entities:
                if entity._is_ready() and self.can_execute(entity):
                    return True
        return bool(self._tasks) and any(task._is_ready() for task in self._tasks)

    def _taken(self, nodes: Sequence[Any]) -> Any:
        """Return what is to be done next, a task or an entity; None without anything."""
        for begins in (False, True, True):
            if begins:
                self._has_done_tasks = not self._has_done_tasks
                if not self._has_done_tasks:
                    self._round += [entity for node in nodes for entity in node.handle.entities if entity._is_ready()]
                elif self._tasks:
                    self._round += [task for task in reversed(self._tasks) if task._is_ready()]
            while self._round:
                work = self._round.popleft()
                if work._is_ready() and (isinstance(work, Task) or self.can_execute(work)):
                    return work
        self._has_done_tasks = True  # after the wait that follows, entities are first
        return None

    def _due(self, nodes: Sequence[Any]) -> float:
        due = inf
        for node in nodes:
            for timer in node.handle.entities:
                if not isinstance(timer, Timer):  # they are before all others
                    break
                if (own := timer._due()) < due and timer.callback_group.can_execute(timer):
                    due = own
        return due

    def _run(self, work: Any) -> None:
        """Do what has been begun: a task, or one thing of an entity.

        Raises:
            Exception: What a callback has raised.
        """
        if isinstance(work, Task):
            self._run_task(work)
            return
        found = self._begun(work)
        if found is not None and inspect.iscoroutine(found):
            self._run_task(self.create_task(result_of, found))

    def _begun(self, work: Any) -> Any:
        """Do one thing of an entity that its group has let begin; return a coroutine if it has to be awaited."""
        group, work.executor = work.callback_group, self
        try:
            found = work._execute()
        except BaseException:
            group.ending_execution(work)
            raise
        if found is not None and inspect.iscoroutine(found):
            return followed(found, lambda: group.ending_execution(work))
        group.ending_execution(work)
        return found

    def _run_task(self, task: Task) -> None:
        try:
            task()
        finally:
            if task._done and task in self._tasks:
                self._tasks.remove(task)
        if task._done and (error := task.exception()) is not None:
            raise error


class SingleThreadedExecutor(Executor):
    """Calls back in the thread that spins."""

    def spin_once(self, timeout_sec: float | None = None) -> None:
        self._spin_once(timeout_sec)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        self._spin_once(timeout_sec, lambda: future._done)

    def _spin_once(self, timeout: Any, is_over: Callable[[], bool] = lambda: False) -> None:
        try:
            work = self._next_work(_nanoseconds(timeout), is_over, self._nodes)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        if isinstance(work, Task) or work.callback_group.beginning_execution(work):
            self._run(work)


class MultiThreadedExecutor(Executor):
    """Calls back in several threads, so that a callback can wait for another.

    Args:
        num_threads: How many callbacks can be under way.
        context: The context.
    """

    def __init__(self, num_threads: int | None = None, *, context: Any = None) -> None:
        super().__init__(context=context)
        if num_threads is not None and num_threads <= 0:
            raise ValueError("max_workers must be greater than 0")
        if num_threads == 1:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\nUse the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        self._number = max(1, num_threads or _MOST_THREADS)
        self._workers: list[_Worker] = []
        self._error: BaseException | None = None

    def spin_once(self, timeout_sec: float | None = None) -> None:
        self._spin_once(timeout_sec)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Any = None) -> None:
        self._spin_once(timeout_sec, lambda: future._done)

    @property
    def _is_busy(self) -> bool:
        return len(self._workers) >= self._number and all(worker.is_busy for worker in self._workers)

    def _has_work(self, nodes: Sequence[Any]) -> bool:
        return not self._is_busy and super()._has_work(nodes)

    def _taken(self, nodes: Sequence[Any]) -> Any:
        return None if self._is_busy else super()._taken(nodes)

    def _due(self, nodes: Sequence[Any]) -> float:
        return inf if self._is_busy else super()._due(nodes)

    def _spin_once(self, timeout: Any, is_over: Callable[[], bool] = lambda: False) -> None:
        try:
            work = self._next_work(_nanoseconds(timeout), lambda: self._error is not None or is_over(), self._nodes)
        except (ShutdownException, ExternalShutdownException, TimeoutException, ConditionReachedException):
            pass
        else:
            self._hand_over(work)
        if self._error is not None:
            error, self._error = self._error, None
            raise error

    def _hand_over(self, work: Any) -> None:
        """Let a thread do something."""
        if not isinstance(work, Task) and not work.callback_group.beginning_execution(work):
            return
        worker = next((item for item in self._workers if not item.is_busy), None)
        if worker is None:
            worker = _Worker()
            self._workers.append(worker)
            worker.thread = present_task().new_thread(worker.run)
            worker.thread.is_daemon = True
        worker.work = lambda: self._work(work)
        present_task().wait(lambda: worker.has_begun)
        worker.has_begun = False

    def _work(self, work: Any) -> None:
        try:
            self._run(work)
        except Exception as error:
            self._error = error


class _Worker:
    """A thread of an executor."""

    def __init__(self) -> None:
        self.thread: Thread | None = None
        self.work: Callable[[], None] | None = None
        self.has_begun = False

    @property
    def is_busy(self) -> bool:
        return self.work is not None

    def run(self) -> None:
        thread = present_task()
        while True:
            thread.wait(lambda: self.work is not None)
            self.has_begun = True
            assert self.work is not None
            try:
                self.work()
            except SystemExit as end:  # as in ROS, where it ends neither the thread nor the program
                RcutilsLogger("rclpy").warning(
                    f"sys.exit({end.code}) in a thread of an executor ends only the callback"
                )
            finally:
                self.work = None


def _nanoseconds(timeout: Any) -> float:
    """Return a timeout (s), which may be a `TimeoutObject`, in ns; infinite for None or a negative one."""
    seconds = timeout.timeout if isinstance(timeout, TimeoutObject) else timeout
    return inf if seconds is None or seconds < 0 else float(seconds * 1e9)
