"""What every substitution is: text that is only known when the launch file is evaluated."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

# Text, a substitution, or a list of them that is joined.
SomeSubstitutionsType = Any


class SubstitutionFailure(RuntimeError):  # noqa: N818  # ROS's own name
    """A substitution that cannot be performed."""


class Substitution:
    """Text that is only known when the launch file is evaluated."""

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        raise NotImplementedError(f"{type(self).__name__} says nothing in perform()")

    def describe(self) -> str:
        """The substitution as a person would write it."""
        return f"{type(self).__name__}()"

    def __truediv__(self, other: SomeSubstitutionsType) -> Substitution:
        from drake_twin.ros2.substitutions import PathJoinSubstitution

        return PathJoinSubstitution([self, other])

    def __add__(self, other: SomeSubstitutionsType) -> list[Any]:
        return [self, *(other if isinstance(other, list | tuple) else [other])]

    def __radd__(self, other: SomeSubstitutionsType) -> list[Any]:
        return [*(other if isinstance(other, list | tuple) else [other]), self]

    def __repr__(self) -> str:
        return self.describe()


class TextSubstitution(Substitution):
    """Text as it is."""

    def __init__(self, *, text: str):
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected a str, but got {type(text).__name__}: {text!r}")
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        return self.text

    def describe(self) -> str:
        """The text, quoted."""
        return repr(self.text)


def normalize_to_list_of_substitutions(subst: SomeSubstitutionsType) -> list[Substitution]:
    """Text, a path, a substitution or a list of them, as a list of substitutions."""
    if isinstance(subst, str):
        return [TextSubstitution(text=subst)]
    if isinstance(subst, PurePath):
        return [TextSubstitution(text=str(subst))]
    if isinstance(subst, Substitution) or hasattr(subst, "perform"):
        return [subst]
    if isinstance(subst, Iterable):
        return [item for part in subst for item in normalize_to_list_of_substitutions(part)]
    raise TypeError(
        f"text, a substitution or a list of them is needed, and {subst!r} is of type {type(subst).__name__}"
    )


def perform_substitutions(context: LaunchContext, subs: Sequence[Any]) -> str:
    """The joined text of normalized substitutions."""
    return "".join(str(sub.perform(context)) for sub in subs)


def perform(context: LaunchContext, subst: SomeSubstitutionsType) -> str:
    """The text of anything that `normalize_to_list_of_substitutions` takes."""
    return perform_substitutions(context, normalize_to_list_of_substitutions(subst))


def describe_all(subst: SomeSubstitutionsType) -> str:
    """Substitutions as ``ros2 launch --show-args`` prints them: text as it is, the others described."""
    parts = normalize_to_list_of_substitutions(subst)
    return "".join(part.text if isinstance(part, TextSubstitution) else part.describe() for part in parts)


def as_texts(value: Any) -> Any:
    """Numbers and truth values, which ROS takes in some places, as text."""
    if isinstance(value, bool | int | float):
        return str(value)
    if isinstance(value, list | tuple):
        return [as_texts(item) for item in value]
    return value
