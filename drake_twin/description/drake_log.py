"""Drake's log messages, filtered and collected."""

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager

_LOGGER = logging.getLogger("drake")

# What Drake and its libraries raise for what they cannot read; SystemExit, because some of Drake's checks exit.
DRAKE_RAISES = (RuntimeError, ValueError, IndexError, OverflowError, MemoryError, SystemExit)

_NOT_FOR_USERS = (
    "half spaces are not currently supported for deformable contact",  # the twin has no deformable bodies
    "Actuation (via non-zero effort limits) for ",  # only commanded joints have an actuator
    "The attribute 'type' found in a 'link' tag",  # a finding says it, with its line
    "Meshcat listening for connections",  # the program prints its page's address
)


def _concerns_users(record: logging.LogRecord) -> bool:
    return not any(text in record.getMessage() for text in _NOT_FOR_USERS)


_LOGGER.addFilter(_concerns_users)


@contextmanager
def captured_warnings() -> Iterator[list[str]]:
    """Collect what Drake would log inside the block, each message on one line, and keep it from stderr."""
    messages: list[str] = []

    def keep(record: logging.LogRecord) -> bool:
        messages.append(" ".join(record.getMessage().split()))
        return False

    _LOGGER.addFilter(keep)
    try:
        yield messages
    finally:
        _LOGGER.removeFilter(keep)


def reason_of(error: BaseException) -> str:
    """Return why Drake refuses something, in one line."""
    return without_literal(" ".join(str(error).split())) or "no reason given"


def without_literal(text: str) -> str:
    """Remove the position in the prepared text, which the user never sees, from a message of Drake's parser."""
    return re.sub(r"<(?:literal|data)-string>[.\w]*:\d*:? *(error: |warning: )?", "", text).strip()
