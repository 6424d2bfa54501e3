"""What the groups of a twin's methods have in common."""

import functools
from collections.abc import Callable
from typing import Concatenate, ParamSpec, Protocol, TypeVar

from drake_twin.twin.recording import Recorder
from drake_twin.twin.session import Session
from drake_twin.twin.stepper import Stepper

_P = ParamSpec("_P")
_R = TypeVar("_R")


class Steps(Protocol):
    """What has methods that callbacks cannot call."""

    _stepper: Stepper


_S = TypeVar("_S", bound=Steps)


class Group:
    """Methods of a twin under one name, as `Twin` has it.

    Args:
        session: The twin's session.
        stepper: Advances it.
        recorder: Records the calls.
    """

    def __init__(self, session: Session, stepper: Stepper, recorder: Recorder):
        self._session, self._stepper, self._recorder = session, stepper, recorder


def outside_callbacks(what: str) -> Callable[[Callable[Concatenate[_S, _P], _R]], Callable[Concatenate[_S, _P], _R]]:
    """Decorate a method that callbacks cannot call; a refused call is not recorded."""

    def decorate(method: Callable[Concatenate[_S, _P], _R]) -> Callable[Concatenate[_S, _P], _R]:
        @functools.wraps(method)
        def call(self: _S, /, *arguments: _P.args, **named: _P.kwargs) -> _R:
            self._stepper.refuse_inside_callback(what)
            return method(self, *arguments, **named)

        return call

    return decorate
