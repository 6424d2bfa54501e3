"""What of the process each node program has for itself: signals, its exit, what it does then, its folder, its forks."""

import atexit
import os
import signal
from collections.abc import Callable
from typing import Any

from drake_twin.nodes.task import Abandoned, forget_tasks, here

_HARMLESS = frozenset((signal.SIGCHLD, signal.SIGCONT, signal.SIGURG, signal.SIGWINCH))


def _set_signal(real: Callable[..., Any]) -> Callable[..., Any]:
    """The handler of Ctrl-C is called when the run ends; those of other signals when the program sends them."""

    def set_handler(number: int, handler: Any) -> Any:
        task = here()
        if task is None:
            return real(number, handler)
        before = _handler_of(task.program, number)
        task.program.handlers[int(number)] = handler
        return before

    return set_handler


def _get_signal(real: Callable[..., Any]) -> Callable[..., Any]:
    def handler(number: int) -> Any:
        task = here()
        return real(number) if task is None else _handler_of(task.program, number)

    return handler


def _handler_of(program: Any, number: int) -> Any:
    default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
    return program.handlers.get(int(number), default)


def _alarm(real: Callable[..., Any]) -> Callable[..., Any]:
    def set_alarm(*arguments: Any) -> Any:
        if here() is not None and any(arguments):
            raise OSError("a node cannot set an alarm, which would be the twin's")
        return real(*arguments)

    return set_alarm


def _kill(real: Callable[..., Any]) -> Callable[..., Any]:
    def kill(process: int, number: int) -> None:
        if here() is None or process != os.getpid() or not number:
            real(process, number)
        else:
            _signal_itself(number)

    return kill


def _raise_signal(real: Callable[..., Any]) -> Callable[..., Any]:
    def raise_signal(number: int) -> None:
        if here() is None:
            real(number)
        else:
            _signal_itself(number)

    return raise_signal


def _signal_itself(number: int) -> None:
    """Do what a signal does to a program, without the process."""
    task = here()
    assert task is not None
    handler = _handler_of(task.program, number)
    if callable(handler):
        if handler is signal.default_int_handler and task is not task.program.main:
            task.program.main.end(KeyboardInterrupt)
        else:
            handler(number, None)
    elif handler != signal.SIG_IGN and number not in _HARMLESS:
        _exit_with(128 + number)


def _exit(real: Callable[..., Any]) -> Callable[..., Any]:
    def exit_at_once(code: int) -> None:
        if here() is None:
            real(code)
        _exit_with(code)

    return exit_at_once


def _exit_with(code: int) -> None:
    """End the program of the present thread."""
    task = here()
    assert task is not None
    task.program.exit(code)
    raise Abandoned


def _register(real: Callable[..., Any]) -> Callable[..., Any]:
    def register(function: Callable[..., Any], *arguments: Any, **options: Any) -> Callable[..., Any]:
        task = here()
        if task is None:
            real(function, *arguments, **options)
        else:
            task.program.at_exit.append((function, arguments, options))
        return function

    return register


def _unregister(real: Callable[..., Any]) -> Callable[..., Any]:
    def unregister(function: Callable[..., Any]) -> None:
        task = here()
        if task is None:
            real(function)
        else:
            task.program.at_exit[:] = [item for item in task.program.at_exit if item[0] != function]

    return unregister


def _change_folder(real: Callable[..., Any]) -> Callable[..., Any]:
    def change_folder(path: Any) -> None:
        task = here()
        if task is None or task.is_outside:
            real(path)
            return
        if not task.program.folder:
            task.program.outer_folder = os.getcwd()
        real(path)
        task.program.folder = os.getcwd()

    return change_folder


# (place, name, what makes the replacement from it)
REPLACEMENTS: tuple[tuple[Any, str, Callable[[Any], Any]], ...] = (
    (signal, "signal", _set_signal),
    (signal, "getsignal", _get_signal),
    (signal, "alarm", _alarm),
    (signal, "setitimer", _alarm),
    (signal, "raise_signal", _raise_signal),
    (os, "kill", _kill),
    (os, "_exit", _exit),
    (os, "chdir", _change_folder),
    (atexit, "register", _register),
    (atexit, "unregister", _unregister),
)


def follow_forks(restore: Callable[[], None]) -> None:
    """Let a process that a node forks be a plain one, with the real time and no baton to wait for.

    Args:
        restore: Lets all threads see the process as it is.
    """

    def begin_child() -> None:
        forget_tasks()
        restore()

    os.register_at_fork(after_in_child=begin_child)
