"""Stand-in for ``rclpy.task``."""

import inspect
import sys
import warnings
from collections.abc import Callable, Generator
from contextvars import ContextVar
from typing import Any

from drake_twin.nodes.task import present_task

_of_executor = ContextVar("_of_executor", default=False)  # whether what awaits is continued by an executor


class Future:
    """A result to come."""

    def __init__(self, *, executor: Any = None):
        self._done = self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._is_fetched = False
        self._callbacks: list[Callable[[Any], Any]] = []
        self._executor = executor

    def __del__(self) -> None:
        if self._exception is not None and not self._is_fetched:
            print(f"The following exception was never retrieved: {self._exception}", file=sys.stderr)

    def __await__(self) -> Generator[Any, None, Any]:
        if not self._done and not _of_executor.get() and (waiter := self._asyncio_future()) is not None:
            yield from waiter
        while not self._done:
            yield self
        return self.result()

    def _asyncio_future(self) -> Any:
        """Return a future of the running loop of ``asyncio`` that is done with this one; None without a loop."""
        asyncio = sys.modules.get("asyncio")
        loop = None if asyncio is None else asyncio._get_running_loop()
        if loop is None:
            return None
        waiter = loop.create_future()

        def finish() -> None:
            if not waiter.done():
                waiter.set_result(None)

        self.add_done_callback(lambda _: loop.call_soon_threadsafe(finish))
        return waiter

    def cancel(self) -> None:
        if not self._done:
            self._cancelled = True
            self._call_back()

    def cancelled(self) -> bool:
        return self._cancelled

    def done(self) -> bool:
        present_task()
        return self._done

    def result(self) -> Any:
        if self._exception is not None:
            self._is_fetched = True
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        self._is_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        self._result = result
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        self._exception, self._is_fetched = exception, False
        self._finish()

    def add_done_callback(self, callback: Callable[[Any], Any]) -> None:
        if self._done and self._executor is None:
            callback(self)
        elif self._done:
            self._schedule(callback)
        else:
            self._callbacks.append(callback)

    def remove_done_callback(self, callback: Callable[[Any], Any]) -> bool:
        count = len(self._callbacks)
        self._callbacks = [item for item in self._callbacks if item != callback]
        return len(self._callbacks) < count

    def _set_executor(self, executor: Any) -> None:
        """Let an executor call back when it is done."""
        self._executor = executor

    def _finish(self) -> None:
        self._done, self._cancelled = True, False
        self._call_back()

    def _call_back(self) -> None:
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            self._schedule(callback)

    def _schedule(self, callback: Callable[[Any], Any]) -> None:
        if self._executor is None:
            try:
                callback(self)
            except Exception as error:  # as there may be more of them
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)
        else:
            self._executor.create_task(callback, self)


class Task(Future):
    """A function or a coroutine that an executor runs."""

    def __init__(self, handler: Any, args: Any = (), kwargs: Any = None, executor: Any = None):
        super().__init__(executor=executor)
        self._args, self._kwargs = tuple(args or ()), kwargs or {}
        self._handler = handler
        self._awaited: Future | None = None
        if inspect.iscoroutinefunction(handler):
            self._handler = handler(*self._args, **self._kwargs)
        self._executing = False

    def _is_ready(self) -> bool:
        """Return whether it can continue."""
        return not self._executing and not self._done and (self._awaited is None or self._awaited._done)

    def executing(self) -> bool:
        return self._executing

    def __call__(self) -> None:
        if self._done or self._executing:
            return
        self._executing = True
        try:
            if inspect.iscoroutine(self._handler):
                self._continue()
                return
            found = self._handler(*self._args, **self._kwargs)
            if inspect.iscoroutine(found):
                self._handler = found
                self._continue()
            else:
                self.set_result(found)
        except Exception as error:
            self.set_exception(error)
        finally:
            self._executing = False

    def _continue(self) -> None:
        token = _of_executor.set(True)
        try:
            awaited = self._handler.send(None)
        except StopIteration as end:
            self.set_result(end.value)
        else:
            self._awaited = awaited if isinstance(awaited, Future) else None
        finally:
            _of_executor.reset(token)
