"""A place of a program that logs, and how often its lines are printed."""

from typing import Any

from drake_twin.nodes.rclpy.impl.logging_severity import LoggingSeverity

_THROTTLE, _CLOCK = "throttle_duration_sec", "throttle_time_source_type"
_OPTIONS = (_THROTTLE, _CLOCK, "skip_first", "once")


class Call:
    """A place of a program that logs.

    Args:
        name: The logger's name.
        severity: The level.
        options: The call's options, of which those that are zero or False count as not given.

    Raises:
        TypeError: If an option is unknown, or is one of a filter without that which it requires.
        ValueError: If the clock of a throttle is not one.
    """

    def __init__(self, name: str, severity: LoggingSeverity, options: dict[str, Any]):
        self._name, self._severity = name, severity
        self._given = {key: value for key, value in options.items() if value}
        throttles = _THROTTLE in self._given or _CLOCK in self._given
        if throttles and _THROTTLE not in options:
            text = f'required parameter "{_THROTTLE}" not specified'
            raise TypeError(f'{text} but is required for the the logging filter "throttle"')
        for key in options:
            if key not in _OPTIONS:
                text = f'parameter "{key}" is not one of the recognized logging options "{list(_OPTIONS)}"'
                raise TypeError(text)
        self._clock = self._given.get(_CLOCK)
        if self._clock is not None and not hasattr(self._clock, "clock_type"):
            text = f'Received throttle_time_source_type of "{self._clock}" is not a clock instance'
            raise ValueError(text)
        self._last: float | None = None
        self._count = 0

    def check(self, other: "Call") -> None:
        """Check a later call at this place.

        Raises:
            ValueError: If it is not the same.
        """
        if other._severity != self._severity:
            raise ValueError("Logger severity cannot be changed between calls.")
        if other._name != self._name:
            raise ValueError("Logger name cannot be changed between calls.")
        if other._given.keys() - {_CLOCK} != self._given.keys() - {_CLOCK}:
            raise ValueError("Requested logging filters cannot be changed between calls.")
        if other._given != self._given:
            raise ValueError("Logging filter parameters cannot be changed between calls.")

    def is_due(self, now: int) -> bool:
        """Return whether a line is to be printed at a simulation time (ns); every filter counts the call."""
        if _THROTTLE in self._given and not self._is_late_enough(now):
            return False
        if "skip_first" in self._given or "once" in self._given:
            self._count += 1
            first = 2 if "skip_first" in self._given else 1
            return self._count >= first if "once" not in self._given else self._count == first
        return True

    def _is_late_enough(self, now: int) -> bool:
        """Return whether the throttle lets a line pass; a clock that starts at zero holds it back there, as in ROS."""
        if self._clock is not None:
            now = self._clock.nanoseconds
            if self._last is None and getattr(self._clock, "ros_time_is_active", False):
                self._last = 0
        is_again = self._last is not None and now < self._last  # a wall clock never starts again
        if is_again and not getattr(self._clock, "ros_time_is_active", False):
            self._last = None
        if self._last is not None and now < self._last + self._given[_THROTTLE] * 1e9:
            return False
        self._last = now
        return True
