"""ROS 2's substitutions that compare and decide: their texts are ``true`` and ``false``."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    Substitution,
    as_texts,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class _Comparison(Substitution):
    def __init__(self, left: Any, right: Any):
        self.left = normalize_to_list_of_substitutions(as_texts(left))
        self.right = normalize_to_list_of_substitutions(as_texts(right))

    def _equal(self, context: LaunchContext) -> bool:
        left, right = perform_substitutions(context, self.left), perform_substitutions(context, self.right)
        if left == right:
            return True
        booleans = [_BOOLEANS.get(text.lower()) for text in (left, right)]
        if None not in booleans:
            return booleans[0] == booleans[1]
        try:
            return math.isclose(float(left), float(right))
        except ValueError:
            return False


class EqualsSubstitution(_Comparison):
    """``true`` if two texts, numbers or truth values are equal."""

    def perform(self, context: LaunchContext) -> str:
        """``true`` or ``false``."""
        return _text_of(self._equal(context))


class NotEqualsSubstitution(_Comparison):
    """``true`` if two texts, numbers or truth values differ."""

    def perform(self, context: LaunchContext) -> str:
        """``true`` or ``false``."""
        return _text_of(not self._equal(context))


_BOOLEANS = {"true": True, "1": True, "on": True, "yes": True, "false": False, "0": False, "off": False, "no": False}


def _text_of(value: bool) -> str:
    return "true" if value else "false"


def _boolean(context: LaunchContext, subst: SomeSubstitutionsType) -> bool:
    text = perform(context, subst)
    value = _BOOLEANS.get(text.strip().lower())
    if value is None:
        raise InputError(f"{text!r} is neither true nor false", valid=["true", "false"])
    return value


class NotSubstitution(Substitution):
    """``true`` if its text says false."""

    def __init__(self, value: SomeSubstitutionsType):
        self.value = normalize_to_list_of_substitutions(as_texts(value))

    def perform(self, context: LaunchContext) -> str:
        """``true`` or ``false``."""
        return _text_of(not _boolean(context, self.value))


class _Connective(Substitution):
    _combine: Callable[[Iterable[bool]], bool]

    def __init__(self, *args: SomeSubstitutionsType):
        self.args = [normalize_to_list_of_substitutions(as_texts(arg)) for arg in args]

    def perform(self, context: LaunchContext) -> str:
        """``true`` or ``false``."""
        return _text_of(type(self)._combine([_boolean(context, arg) for arg in self.args]))


class AllSubstitution(_Connective):
    """``true`` if all its texts say true."""

    _combine = staticmethod(all)


class AnySubstitution(_Connective):
    """``true`` if one of its texts says true."""

    _combine = staticmethod(any)


class AndSubstitution(AllSubstitution):
    """``true`` if both texts say true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType):
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """``true`` if one of two texts says true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType):
        super().__init__(left, right)


class IfElseSubstitution(Substitution):
    """One of two texts, by a condition."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ):
        self.condition = normalize_to_list_of_substitutions(as_texts(condition))
        self.if_value = normalize_to_list_of_substitutions(as_texts(if_value))
        self.else_value = normalize_to_list_of_substitutions(as_texts(else_value))

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        return perform_substitutions(context, self.if_value if _boolean(context, self.condition) else self.else_value)
