"""What Foxglove's SDK logs about clients: each cause once, for a client can repeat it as often as it likes."""

import logging
import re

_log = logging.getLogger(__name__)
_MOST_LINES = 100
_LONGEST = 200  # characters; the SDK repeats what it was sent
_CLIENT = re.compile(r"\[?[0-9a-fA-F.:]*[.:][0-9a-fA-F.:]*\]?:\d+")
_LEFT = "Connection reset"  # a client that has gone without a word


class _SdkLines(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._logged: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        text = _CLIENT.sub("a client", record.getMessage())[:_LONGEST]
        cause = re.sub(r"\d+", "0", text)
        if _LEFT not in text and cause not in self._logged and len(self._logged) < _MOST_LINES:
            self._logged.add(cause)
            _log.warning("foxglove: %s", text)


def log_causes_once() -> None:
    """Let the SDK log only warnings, and each once, unless the program has settings of its own for its loggers."""
    for name in ("foxglove", "foxglove_py"):
        logger = logging.getLogger(name)
        if logger.level == logging.NOTSET and not logger.handlers:
            logger.setLevel(logging.WARNING)
            logger.addHandler(_SdkLines())
            logger.propagate = False
