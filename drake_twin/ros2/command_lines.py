"""The command lines of XML and YAML launch files."""

from collections.abc import Iterable, Iterator

from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution


def split_command_line(parts: Iterable[Substitution]) -> list[list[Substitution]]:
    """Split a command line into words, each a list of substitutions.

    Only the text between substitutions is split, and quotes are kept whole.
    """
    words: list[list[Substitution]] = []
    open_word: list[Substitution] | None = None
    for piece in _pieces(parts):
        if piece is None:
            if open_word is not None:
                words.append(open_word)
            open_word = None
        else:
            open_word = [*(open_word or []), piece]
    if open_word is not None:
        words.append(open_word)
    return words


def _pieces(parts: Iterable[Substitution]) -> Iterator[Substitution | None]:
    """Yield pieces of words; None where a word ends."""
    for part in parts:
        if not isinstance(part, TextSubstitution):
            yield part
            continue
        piece, quote, quoted = "", "", False
        if part.text.count('"') % 2 or part.text.count("'") % 2:
            current_context().refused_by_ros(f"a quote that is not closed in the text {part.text!r} of a command line")
        for character in part.text:
            if quote:
                if character == quote:
                    quote = ""
                else:
                    piece += character
            elif character in "'\"" and part.text.count(character) > 1:
                quote, quoted = character, True
            elif character.isspace():
                if piece or quoted:
                    yield TextSubstitution(text=piece)
                piece, quoted = "", False
                yield None
            else:
                piece += character
        if piece or quoted:
            yield TextSubstitution(text=piece)
