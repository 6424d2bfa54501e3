"""Stand-in for ``rclpy.executors``: spinning is waiting for the baton with something to do."""

import inspect
from collections.abc import Callable, Coroutine
from math import inf
from typing import Any

from drake_twin.nodes.rclpy.context import default_context
from drake_twin.nodes.rclpy.logging import RcutilsLogger
from drake_twin.nodes.rclpy.task import Future, Task
from drake_twin.nodes.task import Task as Thread
from drake_twin.nodes.task import present_task

_MOST_THREADS = 8  # of a MultiThreadedExecutor, whatever the machine has, so that runs are repeatable


class TimeoutException(Exception):
    """Raised when a wait has taken too long."""


class ShutdownException(Exception):
    """Raised by an executor that has been shut down."""


class ExternalShutdownException(Exception):
    """Raised when the context has been shut down."""

    def __init__(self, *args: Any) -> None:
        super().__init__("context has been shutdown externally", *args)


class ConditionReachedException(Exception):
    """Raised when a condition holds."""


class TimeoutObject:
    """A wait that may take too long."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


class Executor:
    """Calls back for nodes.

    Args:
        context: The context.
    """

    def __init__(self, *, context: Any = None) -> None:
        self._context = context or default_context()
        self._nodes: list[Any] = []
        self._tasks: list[Task] = []
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
        return True

    def remove_node(self, node: Any) -> None:
        if node in self._nodes:
            self._nodes.remove(node)

    def get_nodes(self) -> list[Any]:
        return list(self._nodes)

    def wake(self) -> None:
        self._is_awake = True

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        self._is_shutdown = True
        return True

    def __enter__(self) -> "Executor":
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()

    def spin(self) -> None:
        """Call back until the context is shut down."""
        while self._context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Call back until a future is done, or for some simulation time (s)."""
        end = inf if timeout_sec is None or timeout_sec < 0 else present_task().now + round(timeout_sec * 1e9)
        while self._context.ok() and not future.has_ended and not self._is_shutdown:
            now = present_task().now
            if now >= end and timeout_sec:
                return
            self._spin_once(max(0.0, end - now), lambda: future.has_ended)
            if timeout_sec == 0:
                return

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Call back once, after at most some simulation time (s)."""
        self._spin_once(inf if timeout_sec is None or timeout_sec < 0 else timeout_sec * 1e9, lambda: False)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        self._spin_once(inf if timeout_sec is None or timeout_sec < 0 else timeout_sec * 1e9, lambda: future.has_ended)

    def _spin_once(self, timeout: float, is_over: Callable[[], bool]) -> None:
        """Call back once, after at most ns, or until a condition holds."""
        thread = present_task()
        if self._is_shutdown:
            raise ShutdownException
        work = self._next_work()
        if work is None:
            if timeout <= 0:
                thread.count_idle_call()
            else:
                until = inf if timeout == inf else max(thread.after, thread.now + timeout)
                thread.wait(lambda: self._next_work() is not None or self._is_over() or is_over(), until, self._due)
            self._is_awake = False
            if not self._context.ok():
                raise ExternalShutdownException
            work = None if is_over() else self._next_work()
        if work is not None:
            self._execute(work)

    def _is_over(self) -> bool:
        return self._is_shutdown or self._is_awake or not self._context.is_valid

    def _next_work(self) -> Any:
        """Return what can be done now: a task, or an entity."""
        for task in self._tasks:
            if task.is_ready():
                return task
        for node in self._nodes:
            for entity in node.entities:
                if entity.is_ready() and entity.callback_group.can_execute(entity):
                    return entity
        return None

    def _due(self) -> float:
        due = inf
        for node in self._nodes:
            for timer in node._timers:
                if (own := timer.due()) < due and timer.callback_group.can_execute(timer):
                    due = own
        return due

    def _execute(self, work: Any) -> None:
        if not isinstance(work, Task):
            work.callback_group.beginning_execution(work)
        self._run(work)

    def _run(self, work: Any) -> None:
        """Do what has been begun: a task, or one thing of an entity."""
        if isinstance(work, Task):
            self._run_task(work)
            return
        group = work.callback_group
        try:
            found = work.execute()
        except BaseException:
            group.ending_execution(work)
            raise
        if inspect.iscoroutine(found):
            self._follow(found, lambda: group.ending_execution(work))
        else:
            group.ending_execution(work)

    def _follow(self, coroutine: Coroutine[Any, Any, Any], end: Callable[[], None]) -> None:
        """Run a callback that awaits."""

        async def run() -> None:
            try:
                await coroutine
            finally:
                end()

        self._run_task(self.create_task(run))

    def _run_task(self, task: Task) -> None:
        try:
            task()
        finally:
            if task.has_ended and task in self._tasks:
                self._tasks.remove(task)


class SingleThreadedExecutor(Executor):
    """Calls back in the thread that spins."""


class MultiThreadedExecutor(Executor):
    """Calls back in several threads, so that a callback can wait for another.

    Args:
        num_threads: How many callbacks can be under way.
        context: The context.
    """

    def __init__(self, num_threads: int | None = None, *, context: Any = None) -> None:
        super().__init__(context=context)
        self._number = max(1, num_threads or _MOST_THREADS)
        self._workers: list[_Worker] = []
        self._error: BaseException | None = None

    @property
    def _is_busy(self) -> bool:
        return len(self._workers) >= self._number and all(worker.is_busy for worker in self._workers)

    def _next_work(self) -> Any:
        return None if self._error is None and self._is_busy else super()._next_work()

    def _is_over(self) -> bool:
        return self._error is not None or super()._is_over()

    def _due(self) -> float:
        return inf if self._is_busy else super()._due()

    def _spin_once(self, timeout: float, is_over: Callable[[], bool]) -> None:
        if self._error is None:
            super()._spin_once(timeout, is_over)
        if self._error is not None:
            error, self._error = self._error, None
            raise error

    def _execute(self, work: Any) -> None:
        if isinstance(work, Task) and not work.is_ready():
            return
        worker = next((item for item in self._workers if not item.is_busy), None)
        if worker is None:
            worker = _Worker()
            self._workers.append(worker)
            worker.thread = present_task().new_thread(worker.run)
            worker.thread.is_daemon = True
        if not isinstance(work, Task):
            work.callback_group.beginning_execution(work)
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
