"""OpenCV's and Qt's windows in node programs: where none can be shown, they are looked at by nobody.

That is so without a display, and with ``opencv-python-headless``: ROS's OpenCV would end the node there, or the whole
process. Images are shown nowhere, which one finding says; no key is ever pressed, and trackbars keep their values.
``waitKey`` waits in simulation time, for a loop around it would hold up the simulation otherwise. Without a display Qt
draws into memory, as it would abort the process.
"""

import functools
import importlib.abc
import os
import sys
import time
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

from drake_twin.nodes.process_calls import seen_by_nodes
from drake_twin.nodes.task import Task

_NO_KEY = -1
_SHOWN = 1.0  # of getWindowProperty: a window that the user has not closed
_ANSWERS = {"getWindowProperty": _SHOWN, "getWindowImageRect": (0, 0, 0, 0), "selectROI": (0, 0, 0, 0)}
_SILENT = (
    *("namedWindow", "destroyWindow", "destroyAllWindows", "resizeWindow", "moveWindow", "setWindowTitle"),
    *("setWindowProperty", "startWindowThread", "setMouseCallback", "setTrackbarMin", "setTrackbarMax"),
    *_ANSWERS,
)
_TRACKBARS = ("createTrackbar", "setTrackbarPos", "getTrackbarPos")
_KEYS = ("waitKey", "waitKeyEx", "pollKey")
_QT = frozenset(("PyQt5", "PyQt6", "PySide2", "PySide6"))
_PLATFORM = "QT_QPA_PLATFORM"


def opencv_spec(name: str) -> ModuleSpec | None:
    """Return how to import ``cv2``, whose windows are replaced for node programs then; None for another module."""
    if name != "cv2":
        return None
    spec = PathFinder.find_spec(name)
    if spec is not None and spec.loader is not None:
        spec.loader = _Loader(spec.loader)
    return spec


def prepare_qt(name: str, program: Any) -> None:
    """Let Qt draw into memory where it would abort the process, if a module of it is about to be imported."""
    if name in _QT and not _has_display() and not os.environ.get(_PLATFORM):
        os.environ[_PLATFORM] = "offscreen"  # for processes of the program
        os.putenv(_PLATFORM, "offscreen")
        program.ignored(f"no window shows what {name} draws, without a display")


def replace_windows(cv2: ModuleType) -> None:
    """Replace the functions of OpenCV's windows for node programs; other threads have the real ones."""
    for name in ("imshow", *_SILENT, *_TRACKBARS, *_KEYS):
        real = getattr(cv2, name, None)
        if real is not None and not hasattr(real, "__wrapped__"):
            own = _wait_key if name in _KEYS else _trackbar if name in _TRACKBARS else _window
            setattr(cv2, name, seen_by_nodes(real, functools.partial(own, name)))


class _Loader(importlib.abc.Loader):
    """Loads OpenCV as its own loader does; its ``__init__`` puts another module into its place."""

    def __init__(self, real: Any):
        self._real = real

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        found: ModuleType | None = self._real.create_module(spec)
        return found

    def exec_module(self, module: ModuleType) -> None:
        self._real.exec_module(module)
        replace_windows(sys.modules.get("cv2", module))


def _window(name: str, task: Task, real: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    found = _shown(real, arguments, options)
    if found is None:
        if name == "imshow":
            task.program.ignored("no window shows cv2.imshow's images: OpenCV cannot open one here")
        return _ANSWERS.get(name)
    return found[0]


def _trackbar(name: str, task: Task, real: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    found = _shown(real, arguments, options)
    if found is not None:
        return found[0]
    values = task.program.rclpy.setdefault("trackbars", {})
    place = arguments[:2]  # its name and the window's
    if name == "getTrackbarPos":
        return values.get(place, -1)
    values[place] = arguments[2] if len(arguments) > 2 else options.get("value", options.get("pos", 0))
    return None


def _wait_key(name: str, task: Task, real: Callable[..., Any], delay: int = 0) -> int:
    found = _shown(real, () if name == "pollKey" else (1,), {})  # the window's own events take a moment
    time.sleep(max(delay, 0) * 1e-3)
    return _NO_KEY if found is None else found[0]


def _shown(real: Callable[..., Any], arguments: Sequence[Any], options: dict[str, Any]) -> tuple[Any] | None:
    """Call OpenCV's own function; return its result, or None where it cannot open windows."""
    if not _has_display():
        return None
    try:
        return (real(*arguments, **options),)
    except Exception as error:
        if "not implemented" in str(error):
            return None
        raise


def _has_display() -> bool:
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
