"""The one family of exceptions of the twin: each prints as one paragraph that a person can act on."""

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path
from typing import Any


class TwinError(Exception):
    """Anything the twin refuses or fails at.

    ``exit_code`` is what a program of this package returns when the error ends it.
    """

    exit_code = 1


class InputError(TwinError):
    """A file, an argument or a call that cannot be used as it is.

    The text reads ``FILE:LINE: message. Valid: a, b, c.``; each part is left out when it is not known.

    Args:
        message: what is wrong, naming the value.
        file: the file that holds the wrong value.
        line: its line, counted from 1.
        valid: what would have been accepted; ``value`` is compared with it to suggest the closest.
        value: the refused value, when it is one of many names.
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
            place = f"{self.file}: " if self.line is None else f"{self.file}:{self.line}: "
        text = place + self.message.rstrip(".") + "."
        if self.valid is not None:
            close = get_close_matches(str(self.value), self.valid, n=1) if self.value else []
            if close:
                text += f" Did you mean {close[0]!r}?"
            text += f" Valid: {', '.join(self.valid)}." if self.valid else " There is none to choose from."
        return text


class CommandError(InputError):
    """A message that a controller does not accept.

    Attributes:
        deactivates: whether ros2_control deactivates the controller that is sent such a message.
    """

    def __init__(self, message: str, *, deactivates: bool = False, **more: Any):
        super().__init__(message, **more)
        self.deactivates = deactivates

    def about(self, topic: str) -> "CommandError":
        """The same error, saying which topic or action it is about."""
        more = {"valid": self.valid, "value": self.value}
        return CommandError(f"{topic}: {self.message}", deactivates=self.deactivates, **more)


class RunError(TwinError):
    """A failure while the twin runs."""
