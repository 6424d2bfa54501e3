"""Code of other packages that a running twin calls between two steps: what fails is named, and not called again."""

import contextlib
import logging
from collections.abc import Callable, Iterator
from typing import Any, TypeVar
from weakref import WeakKeyDictionary, ref

import numpy as np

from drake_twin.errors import RunError, TwinError, described
from drake_twin.findings import Finding, Kind
from drake_twin.twin.twin import Twin

_log = logging.getLogger(__name__)
_T = TypeVar("_T")
_BEHIND = "it has changed the state by Drake's own methods, which no recording has: use those of twin.entities"

_known: WeakKeyDictionary[Twin, dict[str, "OthersCode"]] = WeakKeyDictionary()


class OthersCode:
    """Something that another package has added to a twin, such as a panel of the page or a service.

    Args:
        what: What it is, for the user: ``panel 'horn'``.
        twin: The twin that it works on; None for what other threads call, too, and what has none yet.

    Attributes:
        what: What it is.
        fault: Why it is not called any more; None while it is.
    """

    def __init__(self, what: str, twin: Twin | None = None):
        self.what = what
        self.fault: str | None = None
        self._twin = None if twin is None else ref(twin)  # `_known` must not keep it
        self._findings = None if twin is None else twin.more_findings

    @classmethod
    def of(cls, twin: Twin, what: str) -> "OthersCode":
        """Return the one of a name that a twin has, so that what has failed once stays so."""
        return _known.setdefault(twin, {}).setdefault(what, cls(what, twin))

    def tell(self, twin: Twin) -> None:
        """Let a fault of what was made before a twin be one of the twin's findings, also if it is there already."""
        self._findings = twin.more_findings
        self._find()

    def call(self, function: Callable[..., _T], *arguments: Any) -> _T:
        """Call a function of it; it may change a twin's state by the twin's own methods only.

        Raises:
            TwinError: What the function raises of this family, which is a refusal.
            RunError: If it raises anything else, now or at an earlier call.
        """
        twin = None if self._twin is None else self._twin()
        if twin is None:
            return self._tried(function, *arguments)
        with self._state_watched(twin):
            return self._tried(function, *arguments)

    def run(self, function: Callable[..., _T], *arguments: Any) -> _T | None:
        """Call a function of it that has nothing to refuse; None if it has failed."""
        try:
            return self.call(function, *arguments)
        except TwinError as error:
            self._fail(described(error))
            return None

    def _tried(self, function: Callable[..., _T], *arguments: Any) -> _T:
        if self.fault is None:
            try:
                return function(*arguments)
            except TwinError:
                raise
            except (Exception, SystemExit) as error:
                self._fail(described(error))
        raise RunError(f"{self.what} has failed, and is not called again: {self.fault}")

    @contextlib.contextmanager
    def _state_watched(self, twin: Twin) -> Iterator[None]:
        heard: list[str] = []

        def hear(name: str, _: tuple[Any, ...]) -> None:
            heard.append(name)

        before = _state(twin)
        twin.recorder.listeners.append(hear)
        try:
            yield
        finally:
            twin.recorder.listeners.remove(hear)
            simulated, state = _state(twin)
            if not heard and simulated == before[0] and state != before[1]:
                self._fail(_BEHIND)

    def _fail(self, why: str) -> None:
        if self.fault is None:
            self.fault = why
            _log.error("%s has failed, and is not called again: %s", self.what, why)
            self._find()

    def _find(self) -> None:
        if self._findings is not None and self.fault is not None:
            self._findings.append(Finding(Kind.FAILED, f"{self.what}: {self.fault}"))


def _state(twin: Twin) -> tuple[float, bytes]:
    """Return the count of simulated time, and the plant's ``[q; v]``."""
    state: np.ndarray = twin.plant.GetPositionsAndVelocities(twin.plant.GetMyContextFromRoot(twin.context))
    return twin.clock.simulated, state.tobytes()
