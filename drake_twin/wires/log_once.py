"""What other programs cause is logged once: they can cause it any number of times."""

import logging


class LogOnce:
    """Logs warnings, each once.

    Args:
        log: Where.
        name: What they are about, which goes before each; empty for nothing.
        most: How many different ones are logged.
    """

    def __init__(self, log: logging.Logger, name: str = "", most: int = 10):
        self._log, self._before, self._most = log, name and f"{name}: ", most
        self._logged: set[str] = set()

    def __call__(self, text: str) -> None:
        """Log a text, unless it has been."""
        if text not in self._logged and len(self._logged) < self._most:
            self._logged.add(text)
            self._log.warning("%s%s", self._before, text)
