"""Drake's log messages, where the twin has its own way to show them."""

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager

_LOGGER = logging.getLogger("drake")

# What Drake and the libraries in it raise at what they cannot read; some checks of Drake's end the process if they can.
DRAKE_RAISES = (RuntimeError, ValueError, IndexError, OverflowError, MemoryError, SystemExit)

_NOT_FOR_USERS = (
    "half spaces are not currently supported for deformable contact",  # the twin has no deformable bodies
    "Actuation (via non-zero effort limits) for ",  # only what is commanded has an actuator
    "Meshcat listening for connections",  # the program says where its page is
)


def _concerns_users(record: logging.LogRecord) -> bool:
    return not any(text in record.getMessage() for text in _NOT_FOR_USERS)


_LOGGER.addFilter(_concerns_users)


@contextmanager
def captured_warnings() -> Iterator[list[str]]:
    """Collects what Drake would log inside the block, each message on one line, and keeps it from stderr."""
    messages: list[str] = []

    def keep(record: logging.LogRecord) -> bool:
        messages.append(" ".join(record.getMessage().split()))
        return False

    _LOGGER.addFilter(keep)
    try:
        yield messages
    finally:
        _LOGGER.removeFilter(keep)


def without_literal(text: str) -> str:
    """A message of Drake's parser without its place in the prepared text, which the user never sees."""
    return re.sub(r"<literal-string>[.\w]*:\d*:? *(error: |warning: )?", "", text).strip()
