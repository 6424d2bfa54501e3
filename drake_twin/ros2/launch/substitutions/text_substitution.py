"""Text as it is."""

from collections.abc import Iterable

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution


class TextSubstitution(Substitution):
    """Text as it is."""

    def __init__(self, *, text: str):
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected a str, but got {type(text).__name__}: {text!r}")
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        return self.text

    def describe(self) -> str:
        """Return the text, quoted."""
        return repr(self.text)


def joined_words(words: Iterable[SomeSubstitutionsType]) -> SomeSubstitutionsType:
    """Return words with spaces between them."""
    parts: list[SomeSubstitutionsType] = []
    for word in words:
        parts += [" ", word]
    return parts[1:] or ""
