"""Errors of a launch file's own Python code, reported with the lines of that file only."""

import sysconfig
import traceback
from pathlib import Path

from drake_twin.description.xacro_file import installed_xacro, xacro_error
from drake_twin.errors import InputError, TwinError
from drake_twin.findings import Place
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.packages import AbsentError, absent_package_in
from drake_twin.ros2.stand_in_modules import exports

_HIDDEN_FOLDERS = (
    str(Path(__file__).parent),
    "<frozen ",
    *{sysconfig.get_paths()[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")},
)


def launch_error(error: BaseException, context: LaunchContext, file: str | None = None) -> TwinError:
    """Return an exception of a launch file's code as an error that a person can act on.

    Args:
        error: The exception.
        context: The context, which knows the includes that led there.
        file: The launch file, where it is not the one at hand.
    """
    file = file or context.current_launch_file
    if isinstance(error, SystemExit) and isinstance(error.__context__, Exception):
        error = error.__context__  # xacro.process() ends the program where it fails
    frames = [frame for frame in _frames(error) if not _is_ours(frame)]
    own = [frame for frame in frames if frame.filename == file]
    position = Place(file, own[-1].lineno) if own and file else context.position
    line = None if position is None else position.line
    if isinstance(error, TwinError):
        if isinstance(error, InputError) and error.file is None and position is not None:
            error.file, error.line = position.file, position.line
        return error
    absent = _absence(error)
    if absent is not None:
        return AbsentError(absent, file=file, line=line)
    if isinstance(error, ImportError) and not isinstance(error, ModuleNotFoundError):
        known = sorted(exports(error.name or "") or ())
        if known:
            wanted = str(error).split("'")[1] if "'" in str(error) else str(error)
            return InputError(
                f"{error.name} has no {wanted!r} that the twin knows", file=file, line=line, valid=known, value=wanted
            )
    if isinstance(error, SyntaxError) and error.filename == file:
        return InputError(f"this is not Python: {error.msg}{_chain(context, file)}", file=file, line=error.lineno)
    if isinstance(error, KeyError) and _in_environment(error):
        return InputError(
            f"the launch file reads the environment variable {error.args[0]!r}, which is not set", file=file, line=line
        )
    if isinstance(error, Exception) and any(frame.filename == installed_xacro().__file__ for frame in _frames(error)):
        refused = xacro_error(error, Path(file or ""))
        refused.message += f", called by {file}" + (f":{line}" if line is not None else "")
        return refused
    if isinstance(error, RecursionError) and not frames:
        return InputError("what the launch file holds nests too deep", file=file, line=line)
    if isinstance(error, SystemExit):
        return InputError(f"the launch file ends the program ({_exit(error)})", file=file, line=line)
    lines = ["Traceback (most recent call last):\n", *traceback.format_list(frames)]
    lines += traceback.format_exception_only(type(error), error)
    return InputError(f"the launch file's code fails{_chain(context, file)}\n{''.join(lines).rstrip()}", file=file)


def _frames(error: BaseException) -> traceback.StackSummary:
    return traceback.extract_tb(error.__traceback__)


def _chain(context: LaunchContext, file: str | None) -> str:
    """Return ``, included by x:3, which is included by y:1``."""
    steps = [str(place) for _, place in reversed(context.files) if place is not None]
    if context.files and context.files[-1][0] != file and context.place is not None:
        steps.insert(0, str(context.place))  # being loaded
    return "".join(f", {'which is ' if index else ''}included by {step}" for index, step in enumerate(steps))


def _absence(error: BaseException) -> str | None:
    """Return why an exception means that something is absent; None if it does not."""
    cause = getattr(error, "exc", None)  # of a XacroException
    if cause is not None and isinstance(cause, Exception):
        return _absence(cause)
    package = absent_package_in(str(error)) or absent_package_in(str(getattr(error, "filename", "") or ""))
    if package is not None:
        return f"package {package!r} is absent, and the launch file reads from it"
    if isinstance(error, ModuleNotFoundError):
        return f"needs the Python module {error.name}, which is not there"
    return None


def _in_environment(error: KeyError) -> bool:
    last = traceback.extract_tb(error.__traceback__)[-1]
    return last.filename.endswith("os.py") or (last.filename == "<frozen os>")


def _exit(error: SystemExit) -> str:
    return error.code if isinstance(error.code, str) else f"exit code {error.code or 0}"


def _is_ours(frame: traceback.FrameSummary) -> bool:
    return frame.filename.startswith(_HIDDEN_FOLDERS)
