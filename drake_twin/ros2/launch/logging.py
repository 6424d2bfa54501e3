"""Stand-ins for ``launch.logging``."""

import logging
from types import SimpleNamespace

__all__ = ["get_logger", "launch_config"]

launch_config = SimpleNamespace(log_dir="", level=logging.INFO)


def get_logger(name: str | None = None) -> logging.Logger:
    """Return a logger of Python's."""
    return logging.getLogger(f"launch_file.{name}" if name else "launch_file")
