"""``$(name arguments)`` in the text of XML and YAML launch files and of parameter files."""

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.expose import instantiate_substitution
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution


def parse_substitution(text: str) -> list[Substitution]:
    """Return text with ``$(…)`` in it as a list of substitutions.

    Raises:
        InputError: If a parenthesis is missing, or a substitution is unknown or has wrong arguments.
    """
    parts, _ = _parse(text, 0, end="")
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
        while position < len(text) and text[position].isspace():
            position += 1
        if position >= len(text):
            break
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
        piece, position = _parse(text, position, end=" \t\n()")
        parts += piece
        if position >= len(text) or text[position].isspace():
            break
        if text[position] == ")":
            if depth == 0:
                break
            depth -= 1
        else:
            depth += 1
        parts.append(TextSubstitution(text=text[position]))
        position += 1
    return parts, position
