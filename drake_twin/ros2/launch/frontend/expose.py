"""What XML and YAML launch files may name: the tags of actions and the names of substitutions.

A class or a parse method registers itself with `expose_action` or `expose_substitution`, in the twin's own modules, in
launch files, in the launch extensions of the user's packages, and in modules that the entry-point groups
``drake_twin.launch_actions`` and ``drake_twin.substitutions`` name.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from drake_twin.errors import InputError
from drake_twin.extensions import Registry
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch_extensions import extension_problems, load_extensions

__all__ = ["expose_action", "expose_substitution", "instantiate_substitution"]

# What a parse method returns: a class (or what makes an object), and its keyword arguments.
Parsed = tuple[Callable[..., Any], dict[str, Any]]
_Exposed = TypeVar("_Exposed", bound=Callable[..., Any])
_TREE = Path(__file__).parents[2]


class LaunchRegistry(Registry[Callable[..., Parsed]]):
    """Parse methods by name. Those of launch files and of modules that end with them end with the evaluation.

    Args:
        noun: What has such a name.
        decorator: The decorator's name.
        folder: The name of the folders with the twin's own.
        group: The entry-point group.
    """

    def __init__(self, noun: str, decorator: str, folder: str, group: str):
        packages = [f"drake_twin.ros2.{path.parent.name}.{folder}" for path in sorted(_TREE.glob(f"*/{folder}"))]
        super().__init__(noun, decorator, group, packages)
        self._later: set[str] = set()

    def expose(self, name: str, *, jazzy: bool = True) -> Callable[[_Exposed], _Exposed]:
        """Return a decorator that registers a class with a classmethod ``parse``, or a parse method.

        Args:
            name: The name.
            jazzy: Whether ROS 2 Jazzy knows it; else a package's own takes its place.
        """
        if not jazzy:
            self._later.add(name)

        def register(exposed: _Exposed) -> _Exposed:
            method = getattr(exposed, "parse", None) if isinstance(exposed, type) else exposed
            if not callable(method):
                raise RuntimeError(f"{exposed!r} is exposed as {name!r}, and has no class method parse")
            self.add(name, method, exposed, replace=name in self._later)
            return exposed

        return register

    def is_in_jazzy(self, name: str) -> bool:
        """Return whether ROS 2 Jazzy knows a name, as one of its own, or from a launch file or one of its packages."""
        return name not in self._later or self.is_of_others(name)

    def _import_others(self) -> None:
        load_extensions(self.group)


ACTIONS = LaunchRegistry("element", "expose_action", "actions", "drake_twin.launch_actions")
SUBSTITUTIONS = LaunchRegistry("substitution", "expose_substitution", "substitutions", "drake_twin.substitutions")


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
    method = SUBSTITUTIONS.get(name)
    if method is None:
        message = f"unknown substitution $({name} …){extension_problems()}"
        raise InputError(message, value=name, valid=sorted(SUBSTITUTIONS))
    if not SUBSTITUTIONS.is_in_jazzy(name):
        current_context().refused_by_ros(f"ROS 2 Jazzy has no $({name} …)")
    try:
        kind, arguments = method(args)
    except InputError as error:
        raise InputError(f"$({name} …) {error.message}", valid=error.valid, value=error.value) from None
    return kind(**arguments)
