"""Substitutions that decide: their texts are ``true`` and ``false``."""

from collections.abc import Callable, Iterable, Sequence

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts

_BOOLEANS = {"true": True, "1": True, "on": True, "yes": True, "false": False, "0": False, "off": False, "no": False}


def boolean_of(text: str) -> bool | None:
    """Return the truth value that a text says; None if it says none."""
    return _BOOLEANS.get(text.lower())


def text_of(value: bool) -> str:
    """Return a truth value as ROS writes it."""
    return "true" if value else "false"


def evaluate_boolean(context: LaunchContext, subst: SomeSubstitutionsType) -> bool:
    """Return the truth value that substitutions say.

    Raises:
        InputError: If they say something else.
    """
    text = context.perform_substitution(subst)
    value = boolean_of(text.strip())
    if value is None:
        raise InputError(f"{text!r} is neither true nor false", valid=["true", "false"])
    return value


@expose_substitution("not")
class NotSubstitution(Substitution):
    """``true`` if its text says false."""

    def __init__(self, value: SomeSubstitutionsType):
        self.value = normalize_to_list_of_substitutions(as_texts(value))

    def perform(self, context: LaunchContext) -> str:
        """Return ``true`` or ``false``."""
        return text_of(not evaluate_boolean(context, self.value))


class _Connective(Substitution):
    _combine: Callable[[Iterable[bool]], bool]

    def __init__(self, *args: SomeSubstitutionsType):
        self.args = [normalize_to_list_of_substitutions(as_texts(arg)) for arg in args]

    def perform(self, context: LaunchContext) -> str:
        """Return ``true`` or ``false``."""
        return text_of(type(self)._combine([evaluate_boolean(context, arg) for arg in self.args]))


class _Many(_Connective):
    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return what makes the substitution of any number of texts."""
        return lambda: cls(*data), {}


@expose_substitution("all")
class AllSubstitution(_Many):
    """``true`` if all its texts say true."""

    _combine = staticmethod(all)


@expose_substitution("any")
class AnySubstitution(_Many):
    """``true`` if one of its texts says true."""

    _combine = staticmethod(any)


@expose_substitution("and")
class AndSubstitution(_Connective):
    """``true`` if both texts say true."""

    _combine = staticmethod(all)

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType):
        super().__init__(left, right)


@expose_substitution("or")
class OrSubstitution(_Connective):
    """``true`` if one of two texts says true."""

    _combine = staticmethod(any)

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType):
        super().__init__(left, right)
