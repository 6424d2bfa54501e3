"""``$(name arguments)`` in the text of XML and YAML launch files and of parameter files."""

from drake_twin.errors import InputError
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.frontend.expose import instantiate_substitution
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution


def parse_substitution(string_value: str) -> list[Substitution]:
    """Return text with ``$(…)`` in it as a list of substitutions.

    Raises:
        InputError: If a parenthesis is missing, or a substitution is unknown or has wrong arguments.
    """
    parts, _ = _parse(string_value, 0, end="")
    return parts or [TextSubstitution(text="")]


def _parse(text: str, position: int, end: str) -> tuple[list[Substitution], int]:
    """Parse up to one of the characters in ``end``; a backslash takes the next character as it is."""
    parts: list[Substitution] = []
    plain = ""
    while position < len(text) and text[position] not in end:
        if text.startswith("$(", position):
            if plain:
                parts.append(TextSubstitution(text=plain))
                plain = ""
            part, position = _parse_one(text, position + 2)
            parts.append(part)
        elif text[position] == "\\" and position + 1 < len(text) and text[position + 1] in "$()'\"\\":
            plain += text[position + 1]
            position += 2
        else:
            plain += text[position]
            position += 1
    if plain:
        parts.append(TextSubstitution(text=plain))
    return parts, position


def _parse_one(text: str, start: int) -> tuple[Substitution, int]:
    """Parse a substitution after its ``$(``; return it and the position after its ``)``."""
    position = start
    while position < len(text) and (text[position].isalnum() or text[position] in "_-"):
        position += 1
    name = text[start:position]
    arguments: list[list[Substitution]] = []
    while position < len(text):
        blanks = position
        while position < len(text) and text[position].isspace():
            position += 1
        if position >= len(text):
            break
        if text[blanks:position] not in ("", " "):
            current_context().refused_by_ros(f"more than one blank in $({name} …)")
        character = text[position]
        if character == ")":
            return instantiate_substitution(name, arguments), position + 1
        if character in "'\"":
            argument, position = _parse(text, position + 1, end=character)
            if position >= len(text):
                break
            position += 1
            arguments.append(argument or [TextSubstitution(text="")])
        else:
            argument, position = _parse_unquoted(text, position)
            arguments.append(argument)
    raise InputError(f"'$({text[start : start + 40]}…' is not closed with a parenthesis")


def _parse_unquoted(text: str, position: int) -> tuple[list[Substitution], int]:
    """Parse an argument without quotes: it ends with a space or the closing parenthesis, and may hold pairs of them."""
    parts: list[Substitution] = []
    depth = 0
    while position < len(text):
        start = position
        piece, position = _parse(text, start, end=" \t\n()")
        parts += piece
        if "\\" not in text[start:position] and any(
            isinstance(part, TextSubstitution) and ("'" in part.text or '"' in part.text) for part in piece
        ):
            current_context().refused_by_ros(f"a quote within {text!r}")
        if position >= len(text) or text[position].isspace():
            break
        if text[position] == ")":
            if depth == 0:
                break
            depth -= 1
        else:
            depth += 1
            current_context().refused_by_ros(f"parentheses in {text!r} without quotes around them")
        parts.append(TextSubstitution(text=text[position]))
        position += 1
    return parts, position
