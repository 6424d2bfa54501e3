"""The levels of a program's loggers."""

from drake_twin.nodes.rclpy.impl.logging_severity import LoggingSeverity
from drake_twin.nodes.task import here


def levels() -> dict[str, LoggingSeverity]:
    """Return the levels of the program's loggers, by their names; that of the root has none."""
    task = here()
    found: dict[str, LoggingSeverity] = {} if task is None else task.program.rclpy.setdefault("log_levels", {})
    return found


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set the level of all loggers of a name, and of those below it that have none of their own."""
    levels()[name] = LoggingSeverity(level)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level of a logger, or of the first one above it that has one."""
    if own := levels():
        names = name.split(".") if name else []
        for count in range(len(names), -1, -1):
            level = own.get(".".join(names[:count]))
            if level or (level is not None and not count):
                return level
    return LoggingSeverity.INFO


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level that a logger has itself."""
    return levels().get(name, LoggingSeverity.UNSET)


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return a level by its name.

    Raises:
        RuntimeError: If the name is unknown.
    """
    if log_severity.upper() not in LoggingSeverity.__members__:
        valid = ", ".join(LoggingSeverity.__members__).lower()
        raise RuntimeError(f"unknown log level {log_severity!r}. Valid: {valid}")
    return LoggingSeverity[log_severity.upper()]
