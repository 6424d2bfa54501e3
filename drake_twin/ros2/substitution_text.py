"""``$(name arguments)`` in the text of XML and YAML launch files and of parameter files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2 import substitutions as subs
from drake_twin.ros2.substitution import SomeSubstitutionsType, Substitution, TextSubstitution

_Arguments = list[list[Substitution]]


def parse_substitution(text: str) -> list[Substitution]:
    """Text with ``$(…)`` in it as a list of substitutions.

    Raises:
        InputError: a parenthesis is missing, or a substitution is not known or has wrong arguments.
    """
    parts, _ = _parse(text, 0, end="")
    return parts or [TextSubstitution(text="")]


def _parse(text: str, position: int, end: str) -> tuple[list[Substitution], int]:
    """Text and substitutions up to one of the characters in ``end``; backslash takes the next character as it is."""
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
    """A substitution after its ``$(``; returns it and the position after its ``)``."""
    position = start
    while position < len(text) and (text[position].isalnum() or text[position] in "_-"):
        position += 1
    name = text[start:position]
    arguments: _Arguments = []
    while position < len(text):
        while position < len(text) and text[position].isspace():
            position += 1
        if position >= len(text):
            break
        character = text[position]
        if character == ")":
            return _instantiate(name, arguments), position + 1
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
    """An argument without quotes: it ends with a space or the closing parenthesis; parentheses in it are paired."""
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


def _instantiate(name: str, arguments: _Arguments) -> Substitution:
    if name not in SUBSTITUTIONS:
        raise InputError(f"the substitution $({name} …) is not known", value=name, valid=sorted(SUBSTITUTIONS))
    make, least, most = SUBSTITUTIONS[name]
    if not least <= len(arguments) <= most:
        needed = str(least) if least == most else f"{least} to {most}"
        raise InputError(f"$({name} …) takes {needed} arguments, and there are {len(arguments)}")
    return make(*arguments)


def _eval(*arguments: SomeSubstitutionsType) -> Substitution:
    """``$(eval 'expression' modules)``; without quotes, the words are the expression."""
    if len(arguments) == 1:
        return subs.PythonExpression(arguments[0])
    if len(arguments) == 2 and all(isinstance(part, TextSubstitution) for part in arguments[1]):
        modules = "".join(part.text for part in arguments[1])
        if modules.replace(",", "").replace(" ", "").replace(".", "").isidentifier():
            return subs.PythonExpression(arguments[0], [module.strip() for module in modules.split(",")])
    words: list[Any] = []
    for argument in arguments:
        words += [TextSubstitution(text=" "), *argument]
    return subs.PythonExpression(words[1:])


def _optional_env(name: SomeSubstitutionsType, *default: SomeSubstitutionsType) -> Substitution:
    words: list[Any] = []
    for part in default:
        words += [TextSubstitution(text=" "), *part]
    return subs.EnvironmentVariable(name, default_value=words[1:] or "")


def _env(name: SomeSubstitutionsType, default: SomeSubstitutionsType | None = None) -> Substitution:
    return subs.EnvironmentVariable(name, default_value=default)


def _command(command: SomeSubstitutionsType, on_stderr: SomeSubstitutionsType = "fail") -> Substitution:
    return subs.Command(command, on_stderr=on_stderr)


def _variable(name: SomeSubstitutionsType, default: SomeSubstitutionsType | None = None) -> Substitution:
    return subs.LaunchConfiguration(name, default=default)


_MANY = 100

# Name → what makes it, and how many arguments it takes.
SUBSTITUTIONS: dict[str, tuple[Callable[..., Substitution], int, int]] = {
    "all": (subs.AllSubstitution, 0, _MANY),
    "and": (subs.AndSubstitution, 2, 2),
    "anon": (subs.AnonName, 1, 1),
    "any": (subs.AnySubstitution, 0, _MANY),
    "arg": (_variable, 1, 1),
    "command": (_command, 1, 2),
    "dirname": (subs.ThisLaunchFileDir, 0, 0),
    "env": (_env, 1, 2),
    "equals": (subs.EqualsSubstitution, 2, 2),
    "eval": (_eval, 1, _MANY),
    "exec-in-pkg": (subs.ExecutableInPackage, 2, 2),
    "file-content": (subs.FileContent, 1, 1),
    "filename": (subs.ThisLaunchFile, 0, 0),
    "find": (subs.FindPackageShare, 1, 1),
    "find-exec": (lambda name: subs.FindExecutable(name=name), 1, 1),
    "find-pkg-prefix": (subs.FindPackagePrefix, 1, 1),
    "find-pkg-share": (subs.FindPackageShare, 1, 1),
    "for-var": (subs.ForEachVar, 1, 2),
    "if": (subs.IfElseSubstitution, 1, 3),
    "index": (subs.ForLoopIndex, 1, 1),
    "launch_log_dir": (subs.LaunchLogDir, 0, 0),
    "log_dir": (subs.LaunchLogDir, 0, 0),
    "not": (subs.NotSubstitution, 1, 1),
    "not-equals": (subs.NotEqualsSubstitution, 2, 2),
    "optenv": (_optional_env, 1, _MANY),
    "or": (subs.OrSubstitution, 2, 2),
    "param": (subs.Parameter, 1, 1),
    "string-join": (lambda delimiter, *parts: subs.StringJoinSubstitution(parts, delimiter), 1, _MANY),
    "path-join": (lambda *parts: subs.PathJoinSubstitution(parts), 1, _MANY),
    "var": (_variable, 1, 2),
}
