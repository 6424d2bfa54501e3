"""Digital twins of ROS 2 robots in one Drake simulation, with no ROS installed.

The public names, imported when they are first used::

    from drake_twin import TwinBuilder, Scenario, Twin
"""

import sys

if sys.version_info < (3, 11):  # noqa: UP036  # before another module is read, whose syntax an older Python may lack
    import os
    import shlex

    _folder = shlex.quote(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    _refusal = (
        f"drake_twin needs Python 3.11 or newer, and {sys.executable} is {sys.version.split()[0]}:"
        f" `python3.11 -m venv .venv && .venv/bin/python -m pip install {_folder}`."
    )
    if sys.argv[:1] == ["-m"]:
        print(f"error: {_refusal}", file=sys.stderr)
        sys.exit(2)
    raise ImportError(_refusal)

# `python -m drake_twin.PROGRAM` imports this first, when Python has not yet put the program's file into `sys.argv`;
# another package's program may do so, too, and is left alone.
_first = "".join(sys.argv[:1])
_is_module = _first == "-m" and any(word.startswith(("drake_twin", "-mdrake_twin")) for word in sys.orig_argv)
_is_program = _is_module or _first.endswith("/drake-twin")
if _is_program:
    from drake_twin.allocator import simulates, start_again

    start_again()
    if simulates(sys.orig_argv[1:]):
        import gc

        gc.disable()  # what is imported lasts; `run_program` enables it

    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it without a message until it can end by itself

from typing import TYPE_CHECKING, Any  # noqa: E402  # a signal may arrive meanwhile

if TYPE_CHECKING:
    from drake_twin.builder.twin_builder import TwinBuilder
    from drake_twin.errors import CommandError, InputError, RunError, ThreadError, TwinError
    from drake_twin.findings import Finding, Kind, Weight
    from drake_twin.scenario import Command, Robot, Scenario, StaticTransform, World
    from drake_twin.show import TwinPage, show
    from drake_twin.twin.action import ActionGoal
    from drake_twin.twin.entity_state import EntityState
    from drake_twin.twin.recording import Recording
    from drake_twin.twin.replay import replay
    from drake_twin.twin.rewind import Rewind
    from drake_twin.twin.snapshot import Snapshot
    from drake_twin.twin.state import RobotState
    from drake_twin.twin.twin import Twin

__version__ = "0.2.0"  # the one place: pyproject.toml reads it here, .github/RELEASING.md says when it changes

_HOMES = {
    "builder.twin_builder": ("TwinBuilder",),
    "errors": ("CommandError", "InputError", "RunError", "ThreadError", "TwinError"),
    "findings": ("Finding", "Kind", "Weight"),
    "scenario": ("Command", "Robot", "Scenario", "StaticTransform", "World"),
    "show": ("TwinPage", "show"),
    "twin.action": ("ActionGoal",),
    "twin.entity_state": ("EntityState",),
    "twin.recording": ("Recording",),
    "twin.replay": ("replay",),
    "twin.rewind": ("Rewind",),
    "twin.snapshot": ("Snapshot",),
    "twin.state": ("RobotState",),
    "twin.twin": ("Twin",),
}

__all__ = [
    "ActionGoal",
    "Command",
    "CommandError",
    "EntityState",
    "Finding",
    "InputError",
    "Kind",
    "Recording",
    "Rewind",
    "Robot",
    "RobotState",
    "RunError",
    "Scenario",
    "Snapshot",
    "StaticTransform",
    "ThreadError",
    "Twin",
    "TwinBuilder",
    "TwinError",
    "TwinPage",
    "Weight",
    "World",
    "__version__",
    "replay",
    "show",
]

if not TYPE_CHECKING:  # else every name that is not there would have the type Any

    def __getattr__(name: str) -> Any:
        from importlib import import_module

        from drake_twin.requirements import imports_explained

        for module, names in _HOMES.items():
            if name in names:
                with imports_explained():
                    return getattr(import_module(f"drake_twin.{module}"), name)
        raise AttributeError(f"module 'drake_twin' has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})


def _refuse(kind: type[BaseException], error: BaseException, traceback: Any) -> None:
    """End a program whose modules cannot be imported with one paragraph and the exit code 2."""
    from drake_twin.program import leave, say
    from drake_twin.requirements import explanation

    explained = None if "--debug" in sys.argv else explanation(error)
    if explained is None:
        sys.__excepthook__(kind, error, traceback)
    else:
        say(f"error: {explained}", sys.stderr)
        leave(explained.exit_code)


if _is_program:
    sys.excepthook = _refuse
