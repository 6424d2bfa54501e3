"""The thread that a twin belongs to: its members refuse all others, except those marked with `any_thread`.

Drake evaluates one context in one thread only: a second one that reads it ends the process. So whatever reaches the
simulation is a public member of an `Owned` class, which is guarded when the class is made.
"""

import functools
import threading
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, NoReturn, TypeVar

from drake_twin.errors import CopyError, InputError, ThreadError

_Member = TypeVar("_Member", bound=Callable[..., Any])


class _Here(threading.local):
    is_owner = False


class Single:
    """Base of what cannot be copied or pickled: a copy would share the simulation."""

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        """Refuse `copy` and `pickle`.

        Raises:
            CopyError: Always.
        """
        kind = type(self).__name__
        raise CopyError(
            f"a {kind} cannot be copied or pickled, for the copy would share the running simulation: twin.snapshot() is"
            " a copy of its state, and Twin(twin.scenario) another twin"
        )


class Owner(Single):
    """The thread that a twin belongs to: the one that made it, until it hands it over or ends.

    Attributes:
        here: ``here.is_owner`` is whether the calling thread is known as the owner; it ends with the thread.
        guests: Return whether the calling thread may use the twin while the owner waits for it, as for a node's.
        is_advancing: Returns whether the twin is advancing.
    """

    def __init__(self) -> None:
        self.here = _Here()
        self.guests: list[Callable[[], bool]] = []
        self.is_advancing: Callable[[], bool] = lambda: False
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self.admit("twin")

    @property
    def name(self) -> str | None:
        """The name of the thread; None while the twin belongs to none."""
        thread = self._thread
        return thread.name if thread is not None and thread.is_alive() else None

    @property
    def is_here(self) -> bool:
        """Whether the twin belongs to the calling thread."""
        return self.here.is_owner

    def hand_over(self) -> None:
        """Let the twin belong to the next thread that uses it.

        Raises:
            ThreadError: If it belongs to another thread.
            InputError: If called inside a callback.
        """
        self.admit("twin.owner.hand_over")
        if self.is_advancing():
            raise InputError("a callback cannot hand over the twin that calls it: let it end first")
        with self._lock:
            self._thread, self.here.is_owner = None, False

    def admit(self, member: str) -> None:
        """Let the calling thread use the twin; a twin that belongs to no living thread is its own from now on.

        Args:
            member: What is used.

        Raises:
            ThreadError: If the twin belongs to another thread.
        """
        if self.here.is_owner:
            return
        for is_guest in self.guests:
            if is_guest():
                return
        with self._lock:
            if self.name is None:
                self._thread, self.here.is_owner = threading.current_thread(), True
                return
            owner = self.name
        raise ThreadError(
            f"{member}: the twin belongs to the thread {owner!r}, and this is {threading.current_thread().name!r}. Ask"
            f" from here with twin.inbox.ask(function).result(), or call twin.owner.hand_over() in {owner!r} first"
        )

    def guard(self, what: str, function: Callable[[], None]) -> Callable[[], None]:
        """Return a function that the twin hands out, which raises `ThreadError` in other threads."""

        def guarded() -> None:
            self.admit(what)
            function()

        return guarded


def any_thread(member: _Member) -> _Member:
    """Mark a method, or what a property reads, as safe in any thread: it reads one value that is never half written."""
    member.__dict__["is_for_any_thread"] = True
    return member


def is_for_any_thread(member: Any) -> bool:
    """Return whether a method or property is marked with `any_thread`."""
    return hasattr(member.fget if isinstance(member, property) else member, "is_for_any_thread")


def public_members(kind: type) -> Iterator[tuple[str, Any]]:
    """Yield the public methods and properties that a class itself defines, by their names."""
    for name, member in vars(kind).items():
        if not name.startswith("_") and (isinstance(member, property) or callable(member)):
            yield name, member


class Owned(Single):
    """Base of what belongs to a twin's thread: each public method and property raises `ThreadError` in others.

    Args:
        path: How a user writes an object of the subclass, such as ``twin.entities``.

    Attributes:
        PATHS: Path → class, of all subclasses with one.
    """

    PATHS: ClassVar[dict[str, type["Owned"]]] = {}
    _owner: Owner

    def __init_subclass__(cls, *, path: str = "", **more: Any) -> None:
        super().__init_subclass__(**more)
        if not path:
            return
        cls.PATHS[path] = cls
        for name, member in public_members(cls):
            if is_for_any_thread(member):
                continue
            where = f"{path}.{name}"
            if isinstance(member, property):
                get, put = (each and _guarded(where, each) for each in (member.fget, member.fset))
                setattr(cls, name, property(get, put, doc=member.__doc__))
            else:
                setattr(cls, name, _guarded(where, member))


def _guarded(where: str, member: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that raises in a thread that the twin does not belong to."""

    @functools.wraps(member)
    def guarded(self: Owned, /, *arguments: Any, **named: Any) -> Any:
        if not self._owner.here.is_owner:
            self._owner.admit(where)
        return member(self, *arguments, **named)

    return guarded
