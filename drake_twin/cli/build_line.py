"""The line of the terminal that shows what is being built; without a terminal, lines about steps that take long."""

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence

from drake_twin.program import say
from drake_twin.progress import heard

_PERIOD = 0.2  # s between two updates
_LONG = 2.0  # s, after which a step is said where no terminal shows it
_SILENCE = 10.0  # s, after which one of many short steps is said there
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
    steps = _Steps(is_shown=is_shown) if sys.stderr is not None else None
    stopped_at, is_over = None, False

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
        look()
        if steps is not None:
            steps.begin(what)

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
        if steps is not None:
            steps.end()


class _Imports:
    """Finds no module, and looks for signals with each one that this thread imports: all of Drake takes a second."""

    def __init__(self, look: Callable[[], None]):
        self._look, self._thread = look, threading.get_ident()

    def find_spec(self, *_: object) -> None:
        if threading.get_ident() == self._thread:
            self._look()


class _Steps:
    """Says the steps that take long, from a thread of its own, while another one is busy with them.

    Args:
        is_shown: Whether there is a terminal, on whose line each step is shown that takes longer than `_PERIOD`.
    """

    def __init__(self, *, is_shown: bool):
        self._is_shown, self._stream = is_shown, sys.stderr  # which xacro has redirected meanwhile
        self._step, self._since, self._is_over = "", time.perf_counter(), threading.Event()
        self._thread = threading.Thread(target=self._say, name="build_line", daemon=True)
        self._thread.start()

    def begin(self, what: str) -> None:
        """Begin the next step."""
        self._step, self._since = what, time.perf_counter()

    def end(self) -> None:
        """Clear the line, and say nothing more."""
        self._is_over.set()
        self._thread.join()
        if self._is_shown:
            say("\r\033[K", self._stream, end="")

    def _say(self) -> None:
        said, spoken = "", time.perf_counter()
        while not self._is_over.wait(_PERIOD):
            step, now = self._step, time.perf_counter()
            is_due = self._is_shown or now - self._since > _LONG or now - spoken > _SILENCE
            if step == said or not is_due:
                continue
            said, spoken = step, now
            before, end = ("\r\033[K", "") if self._is_shown else ("", "\n")
            say(f"{before}{said} …", self._stream, end=end)
