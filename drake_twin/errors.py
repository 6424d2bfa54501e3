"""The exceptions of the twin: each prints as one paragraph that says what to do."""

import traceback
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).parent


def did_you_mean(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return ``. Did you mean 'NAME'?`` with the known name that is closest; empty where none is close.

    Args:
        name: The name as written.
        known: The names that would have been right.
        cutoff: How alike the two must be, from 0 to 1.
    """
    close = get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return f". Did you mean {close[0]!r}?" if close else ""


class TwinError(Exception):
    """The base of all errors that the twin raises.

    Attributes:
        exit_code: What a program of this package returns when the error ends it.
    """

    exit_code = 1


class InputError(TwinError):
    """Raised for a file, an argument or a call that cannot be used as it is.

    The text reads ``FILE:LINE: message. Valid: a, b, c.``; each part is left out when it is not known.

    Args:
        message: What is wrong, naming the value.
        file: The file that holds the wrong value.
        line: Its line, counted from 1.
        valid: What would have been accepted; ``value`` is compared with it to suggest the closest.
        value: The refused value, when it is one of many names.
    """

    exit_code = 2

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        valid: Iterable[str] | None = None,
        value: str | None = None,
    ):
        self.message = message
        self.file = None if file is None else str(file)
        self.line = line
        self.valid = None if valid is None else list(valid)
        self.value = value
        super().__init__(message)

    def __str__(self) -> str:
        place = ""
        if self.file is not None:
            file = " ".join(self.file.split()) if set("\n\r").intersection(self.file) else self.file
            place = f"{file}: " if self.line is None else f"{file}:{self.line}: "
        text = place + str(self.message).rstrip(".") + "."  # Gymnasium makes an error of an error
        if self.valid is not None:
            text += did_you_mean(str(self.value), self.valid).removeprefix(".") if self.value else ""
            text += f" Valid: {', '.join(self.valid)}." if self.valid else " There are no valid choices."
        return text


class CommandError(InputError):
    """Raised for a message that a controller does not accept.

    Attributes:
        deactivates: Whether ros2_control deactivates the controller that receives such a message.
    """

    def __init__(self, message: str, *, deactivates: bool = False, **more: Any):
        super().__init__(message, **more)
        self.deactivates = deactivates

    def about(self, topic: str) -> "CommandError":
        """Return the same error with the topic or action that it is about."""
        more = {"valid": self.valid, "value": self.value}
        return CommandError(f"{topic}: {self.message}", deactivates=self.deactivates, **more)


class CopyError(InputError, TypeError):
    """Raised where a twin, or what belongs to it, is copied or pickled."""


class RunError(TwinError):
    """Raised when the twin fails while it runs."""


class ThreadError(TwinError, RuntimeError):
    """Raised in a thread that the twin does not belong to, by what only its own thread can use."""


def described(error: BaseException) -> str:
    """Return an exception's class and text, with the line of the code from outside this package that raised it."""
    frames = traceback.extract_tb(error.__traceback__)
    outside = [frame for frame in frames if not Path(frame.filename).is_relative_to(_PACKAGE)]
    where = f" ({outside[-1].filename}:{outside[-1].lineno})" if outside else ""
    return f"{type(error).__name__}: {error}{where}"
