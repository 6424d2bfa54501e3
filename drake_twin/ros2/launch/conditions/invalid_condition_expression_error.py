"""The error of a condition's text."""

from drake_twin.errors import InputError


class InvalidConditionExpressionError(InputError):
    """Raised for a condition's text that is neither true nor false."""
