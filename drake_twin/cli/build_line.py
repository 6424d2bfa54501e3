"""The line of the terminal that shows what is being built."""

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from importlib.abc import MetaPathFinder

from drake_twin.program import say
from drake_twin.progress import heard

_PERIOD = 0.2  # s between two updates
_PATIENCE = 0.3  # s from a signal on, within which a twin is still built, so that it writes its summary


@contextlib.contextmanager
def build_line(stopped: Sequence[int]) -> Iterator[None]:
    """Show the progress of what is built inside the block, and end it when a signal arrives and it takes long.

    Args:
        stopped: The signals that have arrived.

    Raises:
        KeyboardInterrupt: If a signal has arrived, and the twin is not built shortly after it.
    """
    is_shown = sys.stderr is not None and sys.stderr.isatty()
    last, stopped_at, is_over = time.perf_counter(), None, False

    def look() -> None:
        nonlocal stopped_at, is_over
        if not stopped:
            return
        now = time.perf_counter()
        if stopped_at is None:
            stopped_at = now
        if now - stopped_at > _PATIENCE:
            is_over = True
            raise KeyboardInterrupt

    def show(what: str) -> None:
        nonlocal last
        look()
        now = time.perf_counter()
        if is_shown and now - last > _PERIOD:
            last = now
            say(f"\r\033[K{what} …", sys.stderr, end="")

    imports = _Imports(look)
    sys.meta_path.insert(0, imports)
    try:
        with heard(show):
            yield
    except Exception:
        if is_over:  # pydrake makes an ImportError of what is raised when it imports something itself
            raise KeyboardInterrupt from None
        raise
    finally:
        sys.meta_path.remove(imports)
        if is_shown:
            say("\r\033[K", sys.stderr, end="")


class _Imports(MetaPathFinder):
    """Finds no module, and looks for signals with each one that this thread imports: all of Drake takes a second."""

    def __init__(self, look: Callable[[], None]):
        self._look, self._thread = look, threading.get_ident()

    def find_spec(self, *_: object) -> None:
        if threading.get_ident() == self._thread:
            self._look()
