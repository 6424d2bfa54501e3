"""Which lines of a place of a program are printed: ``once``, all but the first, or at most one in a time."""

from typing import Any, ClassVar, NamedTuple

from drake_twin.nodes.rclpy.clock import Clock
from drake_twin.nodes.rclpy.impl.logging_severity import LoggingSeverity

_CLOCK = "throttle_time_source_type"


class LoggingFilter:
    """Decides whether a line is printed, by the context of its place."""

    params: ClassVar[dict[str, Any]] = {}  # option → its value where none is given; None for one that is required

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Put the options into a context.

        Raises:
            TypeError: If one is missing.
        """
        for name, default in cls.params.items():
            context[name] = kwargs.get(name, default)
            if context[name] is None:
                text = f'Required parameter "{name}" was not specified for logging filter "{cls.__name__}"'
                raise TypeError(text)

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Return whether a line is printed now, and count the call."""
        return True


class Once(LoggingFilter):
    """Lets the first line through."""

    params: ClassVar[dict[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        had, context["has_been_logged_once"] = context["has_been_logged_once"], True
        return not had


class Throttle(LoggingFilter):
    """Lets a line through if the last one is long enough ago.

    A clock that starts at zero holds the first lines back there, as in ROS; a wall clock is never near zero there,
    so that the first line passes here, too, and one after the time has begun again.
    """

    params: ClassVar[dict[str, Any]] = {"throttle_duration_sec": None, _CLOCK: Clock()}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        clock = context[_CLOCK]
        if not isinstance(clock, Clock):
            raise ValueError(f'Received {_CLOCK} of "{clock}" is not a clock instance')
        context["throttle_last_logged"] = 0 if _starts_at_zero(clock) else None

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        clock, last = context[_CLOCK], context["throttle_last_logged"]
        now = clock.now().nanoseconds
        if last is not None and now < last and not _starts_at_zero(clock):
            last = None
        if last is not None and now < last + context["throttle_duration_sec"] * 1e9:
            return False
        context["throttle_last_logged"] = now
        return True


class SkipFirst(LoggingFilter):
    """Lets all lines but the first through."""

    params: ClassVar[dict[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        had, context["first_has_been_skipped"] = context["first_has_been_skipped"], True
        return bool(had)


supported_filters: dict[str, type[LoggingFilter]] = {"throttle": Throttle, "skip_first": SkipFirst, "once": Once}


class CallerId(NamedTuple):
    """A place of a program that logs."""

    function_name: str
    file_path: str
    line_number: int
    last_index: int


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the filters of which options are given, neither zero nor False, in their order.

    Raises:
        TypeError: If an option is unknown, or one that a filter requires is missing.
    """
    found = [name for name, each in supported_filters.items() if any(kwargs.get(key) for key in each.params)]
    for name in found:
        for key, default in supported_filters[name].params.items():
            if default is None and key not in kwargs:
                text = f'required parameter "{key}" not specified'
                raise TypeError(f'{text} but is required for the the logging filter "{name}"')
    known = [key for each in supported_filters.values() for key in each.params]
    for key in kwargs:
        if key not in known:
            raise TypeError(f'parameter "{key}" is not one of the recognized logging options "{known}"')
    return found


class Call:
    """The calls of a place of a program that logs.

    Args:
        name: The logger's name.
        severity: The level.
        options: The first call's options, of which those that are zero or False count as not given.

    Raises:
        TypeError: If an option is unknown, or is one of a filter without that which it requires.
        ValueError: If the clock of a throttle is not one.
    """

    def __init__(self, name: str, severity: LoggingSeverity, options: dict[str, Any]):
        self._name, self._severity = name, severity
        self._filters = [supported_filters[each] for each in get_filters_from_kwargs(**options)] if options else []
        self._context: dict[str, Any] = {}
        for each in self._filters:
            each.initialize_context(self._context, **options)

    def check(self, other: "Call") -> None:
        """Check a later call at this place.

        Raises:
            ValueError: If it is not the same.
        """
        if other._severity != self._severity:
            raise ValueError("Logger severity cannot be changed between calls.")
        if other._name != self._name:
            raise ValueError("Logger name cannot be changed between calls.")
        if other._filters != self._filters:
            raise ValueError("Requested logging filters cannot be changed between calls.")
        if any(other._context[key] != self._context[key] for each in self._filters for key in each.params):
            raise ValueError("Logging filter parameters cannot be changed between calls.")

    def is_due(self) -> bool:
        """Return whether the line is to be printed; a filter that holds it back hides the call from those after it."""
        return all(each.should_log(self._context) for each in self._filters)


def _starts_at_zero(clock: Clock) -> bool:
    return bool(getattr(clock, "ros_time_is_active", False))
