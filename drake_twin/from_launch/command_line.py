"""Parsing of the command lines of ROS's own executables."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field
from difflib import get_close_matches

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.ros2.launched import LaunchedProcess
from drake_twin.values import parse_number


@dataclass(frozen=True)
class CommandLine:
    """The words after an executable.

    Attributes:
        options: Option without its dashes → its values in order; ``true`` for one without a value.
        words: The words that are not options.
        process: The process, for error messages.
    """

    options: Mapping[str, tuple[str, ...]]
    words: tuple[str, ...]
    process: LaunchedProcess
    defaults: Mapping[str, object] = field(default_factory=dict)

    def text(self, *names: str) -> str | None:
        """Return the last value of an option under the first given of several names; None if none of them is given."""
        for name in names:
            if name in self.options:
                return self.options[name][-1]
            if str(self.defaults.get(name, "")):
                return str(self.defaults[name])
        return None

    def number(self, *names: str) -> float:
        """Return an option that is a number; zero if it is not given.

        Raises:
            InputError: If it is not a finite number.
        """
        text = self.text(*names)
        try:
            return 0.0 if text is None else parse_number(text)
        except ValueError as error:
            raise self.error(f"-{names[0]} is {text!r}, which is {error}") from None

    def flag(self, *names: str) -> bool:
        """Return whether an option is given without a value or as true."""
        text = self.text(*names)
        return text is not None and text.lower() not in ("false", "0")

    def unknown(self, known: Collection[str]) -> list[str]:
        """Return the options that are not among the known ones, each with its dash and the closest known one."""
        found = []
        for name in (name for name in self.options if name not in known):
            close = get_close_matches(name, known, n=1)
            found.append(f"-{name}" + (f" (did you mean -{close[0]}?)" if close else ""))
        return found

    def error(self, message: str) -> InputError:
        """Return an error at the place where the process was launched."""
        return self.process.error(message)


def command_line(
    process: LaunchedProcess,
    words: Sequence[str] | None = None,
    *,
    flags: Collection[str] = (),
    lists: Collection[str] = (),
    verbatim: Collection[str] = (),
    defaults: Mapping[str, object] | None = None,
    is_gflags: bool = False,
) -> CommandLine:
    """Parse a command line: ``-x 1``, ``--x 1``, ``--x=1`` and ``-x=1`` are the same.

    Args:
        process: The process.
        words: The words; the process's own arguments by default.
        flags: Options without a value; ``-1`` may be one of them.
        lists: Options that take all words up to the next option.
        verbatim: Options that take the next word as their value, even if it looks like an option.
        defaults: Values of options that are not given, for example from the node's parameters.
        is_gflags: Whether gflags parses it, which takes dashes in a name for underscores.
    """
    options: dict[str, list[str]] = {}
    rest: list[str] = []
    words = process.arguments if words is None else words
    position = 0
    while position < len(words):
        word = words[position]
        position += 1
        if not _is_option(word) and not (word.startswith("-") and word.lstrip("-") in flags):
            rest.append(word)
            continue
        name, equals, value = word.lstrip("-").partition("=")
        name = name.replace("-", "_") if is_gflags else name
        values = options.setdefault(name, [])
        if equals:
            values.append(value)
        elif name in lists:
            while position < len(words) and not _is_option(words[position]):
                values.append(words[position])
                position += 1
        elif name in flags or position >= len(words) or (_is_option(words[position]) and name not in verbatim):
            values.append("true")
        else:
            values.append(words[position])
            position += 1
    known = {name: tuple(values) for name, values in options.items() if values}
    return CommandLine(known, tuple(rest), process, dict(defaults or {}))


def _is_option(word: str) -> bool:
    if not word.startswith("-") or word == "-":
        return False
    try:
        float(word)
    except ValueError:
        return True
    return False
