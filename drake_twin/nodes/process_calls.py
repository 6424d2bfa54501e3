"""What of the process each node program has for itself: signals, its exit, what it does then, its folder, its forks."""

import atexit
import functools
import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import MethodType
from typing import Any

from drake_twin.nodes import child_processes
from drake_twin.nodes.task import Abandoned, Task, forget_tasks, here

_HARMLESS = frozenset((signal.SIGCHLD, signal.SIGCONT, signal.SIGURG, signal.SIGWINCH))


def seen_by_nodes(real: Callable[..., Any], own: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that is the real one for other threads, and another one for those of node programs.

    As an attribute of a class it becomes a method only where the real one does: ``now = time.time`` does not.

    Args:
        real: The real one.
        own: Takes the thread's task and the real one before the arguments.
    """

    @functools.wraps(real)
    def call(real: Callable[..., Any], /, *arguments: Any, **options: Any) -> Any:
        task = here()
        return real(*arguments, **options) if task is None else own(task, real, *arguments, **options)

    unbound = MethodType(call, real)
    if not hasattr(type(real), "__get__"):
        return unbound
    return functools.wraps(real)(lambda *arguments, **options: unbound(*arguments, **options))


def _set_signal(task: Task, real: Callable[..., Any], number: int, handler: Any) -> Any:
    """The handler of Ctrl-C is called when the run ends; those of other signals when the program sends them."""
    before = _handler_of(task.program, number)
    task.program.handlers[int(number)] = handler
    return before


def _get_signal(task: Task, real: Callable[..., Any], number: int) -> Any:
    return _handler_of(task.program, number)


def _handler_of(program: Any, number: int) -> Any:
    default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
    return program.handlers.get(int(number), default)


def _set_wakeup(task: Task, real: Callable[..., Any], descriptor: int, **options: Any) -> int:
    before, task.program.wakeup = task.program.wakeup, descriptor
    return int(before)


def _alarm(task: Task, real: Callable[..., Any], *arguments: Any) -> Any:
    if any(arguments):
        raise OSError("a node cannot set an alarm, which would be the twin's")
    return real(*arguments)


def _kill(task: Task, real: Callable[..., Any], process: int, number: int) -> None:
    if process != os.getpid() or not number:
        real(process, number)
    else:
        _signal_itself(task, real, number)


def _signal_itself(task: Task, real: Callable[..., Any], number: int) -> None:
    """Do what a signal does to a program, without the process."""
    handler = _handler_of(task.program, number)
    if callable(handler):
        if handler is signal.default_int_handler and task is not task.program.main:
            task.program.main.end(KeyboardInterrupt)
        else:
            task.program.handle(handler, number, None)
    elif handler != signal.SIG_IGN and number not in _HARMLESS:
        _exit(task, real, 128 + number)


def _exit(task: Task, real: Callable[..., Any], code: int) -> None:
    """End the program of the present thread."""
    task.program.exit(code)
    raise Abandoned


def _main_thread(task: Task, real: Callable[..., Any]) -> Any:
    """The thread that the program began with: ``asyncio`` makes a loop for it alone, and looks after signals there."""
    return task.program.main.thread


def _register(
    task: Task, real: Callable[..., Any], function: Callable[..., Any], *arguments: Any, **options: Any
) -> Callable[..., Any]:
    task.program.at_exit.append((function, arguments, options))
    return function


def _unregister(task: Task, real: Callable[..., Any], function: Callable[..., Any]) -> None:
    task.program.at_exit[:] = [item for item in task.program.at_exit if item[0] != function]


def _change_folder(task: Task, real: Callable[..., Any], path: Any) -> None:
    if task.is_outside:
        real(path)
        return
    if not task.program.folder:
        task.program.outer_folder = os.getcwd()
    real(path)
    task.program.folder = os.getcwd()


def _worker_failed(task: Task, real: Callable[..., Any], *arguments: Any, **options: Any) -> None:
    """A worker of ``concurrent.futures`` takes its thread's end for an error, which Python lets it reach by a queue."""
    if not isinstance(sys.exception(), (Abandoned, KeyboardInterrupt)):
        real(*arguments, **options)


# (place, name, what node programs have there, see `seen_by_nodes`)
REPLACEMENTS: tuple[tuple[Any, str, Callable[..., Any]], ...] = (
    (logging.getLogger("concurrent.futures"), "critical", _worker_failed),
    (signal, "signal", _set_signal),
    (signal, "getsignal", _get_signal),
    (signal, "set_wakeup_fd", _set_wakeup),
    (signal, "alarm", _alarm),
    (signal, "setitimer", _alarm),
    (signal, "raise_signal", _signal_itself),
    (os, "kill", _kill),
    (os, "_exit", _exit),
    (os, "chdir", _change_folder),
    (atexit, "register", _register),
    (atexit, "unregister", _unregister),
    (threading, "main_thread", _main_thread),
    *child_processes.REPLACEMENTS,
)


def follow_forks(restore: Callable[[], None]) -> None:
    """Let a process that a node forks be a plain one, with the real time and no baton to wait for.

    Args:
        restore: Lets all threads see the process as it is.
    """

    def begin_child() -> None:
        task = here()
        forget_tasks()
        restore()
        if task is not None:
            task.program.children.limit_forks()

    os.register_at_fork(after_in_child=begin_child)
