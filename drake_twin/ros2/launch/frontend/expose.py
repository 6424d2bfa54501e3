"""What XML and YAML launch files may name: the tags of actions and the names of substitutions.

A class or a parse method registers itself with `expose_action` or `expose_substitution`. The twin's own modules are
imported when a name is looked up that is not registered yet, and then the launch extensions of the user's packages.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

from drake_twin.errors import InputError
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch_extensions import extension_problems, load_extensions, load_own_modules

__all__ = ["expose_action", "expose_substitution", "instantiate_substitution"]

# What a parse method returns: a class (or what makes an object), and its keyword arguments.
Parsed = tuple[Callable[..., Any], dict[str, Any]]
_Exposed = TypeVar("_Exposed", bound=Callable[..., Any])


class Registry:
    """Parse methods by name.

    Those of the twin's own modules stay. Those of launch files and their packages end with the evaluation, and take
    precedence.

    Args:
        folder: The name of the folders whose modules register themselves.
    """

    def __init__(self, folder: str):
        self._folder = folder
        self._own: dict[str, Callable[..., Parsed]] = {}
        self._others: dict[str, Callable[..., Parsed]] = {}
        self._later: set[str] = set()

    def expose(self, name: str, *, jazzy: bool = True) -> Callable[[_Exposed], _Exposed]:
        """Return a decorator that registers a class with a classmethod ``parse``, or a parse method.

        Args:
            name: The name.
            jazzy: Whether ROS 2 Jazzy knows it.
        """
        if not jazzy:
            self._later.add(name)

        def register(exposed: _Exposed) -> _Exposed:
            method = getattr(exposed, "parse", None) if isinstance(exposed, type) else exposed
            if not callable(method):
                raise RuntimeError(f"{exposed!r} is exposed as {name!r}, and has no class method parse")
            own = exposed.__module__.startswith("drake_twin.")
            (self._own if own else self._others)[name] = method
            return exposed

        return register

    def find(self, name: str) -> Callable[..., Parsed] | None:
        """Return a parse method; None for an unknown name."""
        for load in (None, partial(load_own_modules, self._folder), load_extensions):
            if load is not None:
                load()
            method = self._others.get(name) or self._own.get(name)
            if method is not None:
                return method
        return None

    def is_in_jazzy(self, name: str) -> bool:
        """Return whether ROS 2 Jazzy knows a name, as one of its own."""
        return name not in self._later or name in self._others

    def is_of_package(self, name: str) -> bool:
        """Return whether a launch file or one of its packages registered a name."""
        return name in self._others

    def names(self) -> list[str]:
        """Return the names that are known, sorted."""
        return sorted({*self._own, *self._others})

    @contextmanager
    def evaluation(self) -> Iterator[None]:
        """Forget at the end what launch files registered in between."""
        before, self._others = self._others, {}
        try:
            yield
        finally:
            self._others = before


ACTIONS = Registry("actions")
SUBSTITUTIONS = Registry("substitutions")


def expose_action(name: str, *, jazzy: bool = True) -> Callable[[_Exposed], _Exposed]:
    """Return a decorator that makes an action a tag of XML and YAML launch files.

    Args:
        name: The tag; ``-`` and ``_`` are the same in it.
        jazzy: Whether ROS 2 Jazzy knows it.
    """
    return ACTIONS.expose(name.replace("-", "_"), jazzy=jazzy)


def expose_substitution(name: str, *, jazzy: bool = True) -> Callable[[_Exposed], _Exposed]:
    """Return a decorator that makes a substitution known as ``$(name …)``.

    Args:
        name: The name.
        jazzy: Whether ROS 2 Jazzy knows it.
    """
    return SUBSTITUTIONS.expose(name, jazzy=jazzy)


def instantiate_substitution(name: str, args: Sequence[Any] = ()) -> Any:
    """Return the substitution that ``$(name args…)`` means.

    Raises:
        InputError: If the name is unknown, or the arguments are wrong.
    """
    method = SUBSTITUTIONS.find(name)
    if method is None:
        message = f"unknown substitution $({name} …){extension_problems()}"
        raise InputError(message, value=name, valid=SUBSTITUTIONS.names())
    if not SUBSTITUTIONS.is_in_jazzy(name):
        current_context().refused_by_ros(f"ROS 2 Jazzy has no $({name} …)")
    try:
        kind, arguments = method(args)
    except InputError as error:
        raise InputError(f"$({name} …) {error.message}", valid=error.valid, value=error.value) from None
    return kind(**arguments)
