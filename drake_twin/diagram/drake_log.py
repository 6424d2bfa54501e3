"""Drake's log messages, where the twin has its own way to show them."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

_LOGGER = logging.getLogger("drake")

# The twin has no deformable bodies, and says so on every ground otherwise.
_NOT_FOR_USERS = ("half spaces are not currently supported for deformable contact",)


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
