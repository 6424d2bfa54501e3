"""Text that is only known when the launch file is evaluated (``launch.substitution``)."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.expose import Parsed, instantiate_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext

__all__ = ["Substitution"]

# Text, a substitution, or a list of them that is joined.
SomeSubstitutionsType = Any

MANY = 100  # arguments of ``$(name …)`` where any number is meant


class Substitution(ABC):
    """Text that is only known when the launch file is evaluated."""

    @abstractmethod
    def perform(self, context: LaunchContext) -> str:
        """Return the text."""

    def describe(self) -> str:
        """Return the substitution as a person would write it."""
        return f"{type(self).__name__}()"

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return the class and its arguments for ``$(name …)`` in a launch file.

        Args:
            data: What follows the name: the constructor's arguments, in their order.

        Raises:
            InputError: If there are too few or too many.
        """
        parameters = inspect.signature(cls).parameters.values()
        required = sum(parameter.default is parameter.empty for parameter in parameters)
        check_count(data, required, len(parameters))
        return cls, dict(zip((parameter.name for parameter in parameters), data, strict=False))

    def __truediv__(self, other: SomeSubstitutionsType) -> Substitution:
        joined: Substitution = instantiate_substitution("path-join", [self, other])
        return joined

    def __add__(self, other: SomeSubstitutionsType) -> list[Any]:
        return [self, *(other if isinstance(other, list | tuple) else [other])]

    def __radd__(self, other: SomeSubstitutionsType) -> list[Any]:
        return [*(other if isinstance(other, list | tuple) else [other]), self]

    def __repr__(self) -> str:
        return self.describe()


def check_count(data: Sequence[SomeSubstitutionsType], least: int, most: int) -> None:
    """Refuse too few or too many arguments of ``$(name …)``.

    Raises:
        InputError: If there are.
    """
    if not least <= len(data) <= most:
        needed = str(least) if least == most else f"{least} to {most}"
        raise InputError(f"takes {needed} arguments, and there are {len(data)}")
