"""What the programs of this package share: errors in one paragraph, exit codes, output that never fails."""

import argparse
import atexit
import contextlib
import gc
import logging
import os
import signal
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from errno import EDQUOT, EFBIG, ENOSPC
from pathlib import Path
from typing import Any, NoReturn, TextIO

from drake_twin.errors import InputError, RunError, TwinError
from drake_twin.extensions import place_of_others
from drake_twin.python_process import STOPS
from drake_twin.requirements import imports_explained

_NOT_WRITTEN = (ENOSPC, EDQUOT, EFBIG)  # other errors of a pipe or a terminal are the wish of its reader
_lost_output: list[str] = []  # why a part of standard output is lost

PATIENCE = 2.0  # s from a signal on, in which a program ends by itself
NO_MEMORY = "there is not enough memory; each file that was written is whole"
FIGURES = (".png", ".svg", ".pdf")


def check_figure(option: str, file: Path | None) -> None:
    """Check that a figure can be written to a file, before anything runs.

    Raises:
        InputError: If its suffix is unknown or its folder does not exist.
    """
    if file is not None and file.suffix not in FIGURES:
        raise InputError(f"{option} {file}: unknown format", value=file.suffix, valid=FIGURES)
    if file is not None and not file.absolute().parent.is_dir():
        raise InputError(f"{option} {file}: the folder does not exist")


class ArgumentParser(argparse.ArgumentParser):
    """Reports wrong arguments like any other wrong input, and takes them in any order."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse a command line; ``name:=value`` may stand after options."""
        return self.parse_intermixed_args(args, namespace)

    def error(self, message: str) -> NoReturn:
        """Raise an error of the command line.

        Raises:
            InputError: Always.
        """
        raise InputError(f"{message} (--help lists the options)")


def add_strict(parser: Any, consequence: str) -> None:
    """Add ``--strict`` and ``--strict=mended``, which mean the same in every program."""
    what = "when something that a file asks for is ignored or not started"
    parser.add_argument("--strict", dest="strict", action="store_const", const="lost", help=f"{consequence} {what}")
    parser.add_argument(
        "--strict=mended", dest="strict", action="store_const", const="mended", help="likewise when something is mended"
    )


def add_keep_going(parser: Any) -> None:
    """Add ``--keep-going``; `drake_twin.cli.lost.check_lost` reads it."""
    what = "exit code 0 also when a robot, a part of it or a world that the files ask for is lost, or a node fails"
    parser.add_argument("--keep-going", action="store_true", help=what)


def add_repeated(parser: Any, option: str, metavar: str, what: str, more: str = "") -> None:
    """Add an option that may be repeated; its values are a list.

    Args:
        parser: The parser, or a group of it.
        option: The option.
        metavar: What stands for its value.
        what: What it does.
        more: What else is to be known of repeating it.
    """
    parser.add_argument(option, action="append", default=[], metavar=metavar, help=f"{what} (may be repeated{more})")


def version_text() -> str:
    """Return the package's name and version."""
    import drake_twin

    return f"drake_twin {drake_twin.__version__}"


def add_version(parser: argparse.ArgumentParser) -> None:
    """Add ``--version``, which prints the version and ends the program."""
    parser.add_argument("--version", action=_PrintVersion, nargs=0, help="print the version and end")


class _PrintVersion(argparse.Action):
    """Reads the version only when it is printed: reading it takes time that every start would lose."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> None:
        print(version_text())
        parser.exit()


def run_program(program: Callable[[Sequence[str]], int], arguments: Sequence[str] | None) -> int:
    """Run a program and turn its errors into messages and exit codes.

    Args:
        program: Takes the arguments and returns the exit code.
        arguments: The command line without the program's name; the process's own by default.

    Returns:
        The exit code: the program's, 1 for a failure while running, 2 for input that cannot be used, 130 for Ctrl-C.
    """
    # NumPy's threads for large matrices, of which the twin has none, would wait for work in a loop: 0.1 s of two cores
    # after the import. They read this then, so that a program imports NumPy within `program`.
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "4")
    gc.enable()  # see `drake_twin`
    arguments = sys.argv[1:] if arguments is None else arguments
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without "…" shows a question mark
    log = logging.getLogger("drake_twin")
    if not any(isinstance(handler, _LogHandler) for handler in log.handlers):
        log.addHandler(_LogHandler(logging.WARNING))
        logging.getLogger().addHandler(_OthersLogHandler(logging.WARNING))
    try:
        with imports_explained():
            return _unless_lost(program(arguments))
    except TwinError as error:
        if "--debug" in arguments:
            raise
        say(f"error: {error}", sys.stderr)
        return error.exit_code
    except OSError as error:  # a folder that is gone, a disk that is full
        if "--debug" in arguments:
            raise
        say(f"error: {error}", sys.stderr)
        return 1 if error.errno in _NOT_WRITTEN else 2
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # of a plug-in: the twin's own mistakes show their traceback
        if _lacks_memory(error) and "--debug" not in arguments:
            say(f"error: {NO_MEMORY} (--debug: the traceback)", sys.stderr)
            return 1
        place = place_of_others(error)
        if place is None or "--debug" in arguments:
            raise
        what = " ".join(f"{type(error).__name__}: {error}".split())
        say(f"error: {place}: {what}: code of another package has failed (--debug: the traceback)", sys.stderr)
        return 1


def _lacks_memory(error: BaseException | None) -> bool:
    """Return whether an error comes from a lack of memory; pydrake, while it is imported, raises ImportError then."""
    while error is not None and not isinstance(error, MemoryError):
        error = error.__cause__ or error.__context__
    return error is not None


def _unless_lost(code: int) -> int:
    """Return a program's exit code; 1 in place of 0 if a part of its output is lost."""
    if not _lost_output:
        return code
    say(f"error: standard output cannot be written ({_lost_output.pop()}): a part of it is lost", sys.stderr)
    return code or 1


def leave(code: int) -> NoReturn:
    """End the process without freeing what the operating system frees anyway, which takes 50 ms.

    Handlers of ``atexit`` run; threads are not waited for.
    """
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):  # the stream is closed
            stream.flush()
    os._exit(code)


@contextlib.contextmanager
def collecting_later() -> Iterator[None]:
    """Suspend garbage collection while many lasting objects are imported and created.

    The objects are moved to the oldest generation: the next collection would visit each of them, 60 ms for ten robots.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.freeze()
            gc.unfreeze()
            gc.enable()


class _LogHandler(logging.Handler):
    """Shows log records of a running twin, such as a controller that is deactivated."""

    shows_traceback = True  # of a node's error

    def emit(self, record: logging.LogRecord) -> None:
        text = f"{record.levelname.lower()}: {record.getMessage()}"
        if record.exc_info and self.shows_traceback:
            text += "\n" + logging.Formatter().formatException(record.exc_info)
        say(f"\r\033[K{text}" if sys.stdout is not None and sys.stdout.isatty() else text, sys.stderr)


class _OthersLogHandler(_LogHandler):
    """Shows log records of libraries, in place of Drake's handler, which would repeat the twin's own lines."""

    shows_traceback = False

    def emit(self, record: logging.LogRecord) -> None:
        if record.name.partition(".")[0] != "drake_twin":
            super().emit(record)


def say(text: str, stream: TextIO | None = None, end: str = "\n") -> None:
    """Print a text, and continue if the stream is closed: a closed pipe or terminal must not end a simulation."""
    stream = sys.stdout if stream is None else stream
    if stream is None:  # closed before the program started
        return
    try:
        stream.write(text + end)
        stream.flush()
    except (OSError, ValueError) as error:
        if stream is sys.stdout and isinstance(error, OSError) and _is_loss(error, stream):
            _lost_output[:] = [error.strerror or ""]
        with contextlib.suppress(OSError, ValueError):  # discard what the interpreter flushes at its end
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _is_loss(error: OSError, stream: TextIO) -> bool:
    """Return whether an error has lost what was to be kept: any of a file, that of a full disk anywhere."""
    with contextlib.suppress(OSError, ValueError):
        return error.errno in _NOT_WRITTEN or stat.S_ISREG(os.fstat(stream.fileno()).st_mode)
    return False


def write_each(writers: Iterable[Callable[[], None]], failure: RunError | None = None) -> RunError | None:
    """Write files, of which one that fails does not prevent the others.

    Args:
        writers: Each writes a file.
        failure: An error that was there before.

    Returns:
        The first error; later ones are printed.
    """
    for write in writers:
        try:
            write()
        except (RunError, MemoryError) as raised:
            error = RunError(NO_MEMORY) if isinstance(raised, MemoryError) else raised
            if failure is not None:
                say(f"error: {error}", sys.stderr)
            failure = failure or error
    return failure


@contextlib.contextmanager
def stop_signals() -> Iterator[list[int]]:
    """Collect Ctrl-C, SIGTERM and a closed terminal, so that a run ends between two steps and writes its files.

    Another one kills, unless it comes within `PATIENCE` of the first: who presses Ctrl-C twice loses no file. A closed
    terminal ends nothing that was started by ``nohup``.
    """
    stopped: list[int] = []
    previous: dict[int, Any] = {}
    first = 0.0

    def stop(number: int, _frame: Any) -> None:
        nonlocal first
        now = time.monotonic()
        stopped.append(number)
        if len(stopped) == 1:
            first = now
        elif now - first > PATIENCE:
            for each, handler in previous.items():
                signal.signal(each, handler)
            os.kill(os.getpid(), number)

    number: int
    for number in STOPS:
        if number == signal.SIGHUP and signal.getsignal(number) == signal.SIG_IGN:
            continue
        with contextlib.suppress(ValueError):  # only the main thread may handle signals
            previous[number] = signal.signal(number, stop)
    try:
        yield stopped
    finally:
        for number, handler in previous.items():
            if not stopped or handler != signal.SIG_DFL:  # which would kill with the exit code not yet told
                signal.signal(number, handler)
