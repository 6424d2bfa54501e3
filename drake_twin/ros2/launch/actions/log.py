"""Logs messages."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_text


@expose_action("log_info", jazzy=False)
class LogInfo(Action):
    """Logs a message."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.msg = normalize_to_list_of_substitutions(as_text(msg))

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<log_info>``."""
        _, arguments = super().parse(entity, parser)

        return cls, {**arguments, "msg": parser.parse_required(entity, "message")["message"]}

    def execute(self, context: LaunchContext) -> None:
        """Log the message."""
        context.log.append(context.perform_substitution(self.msg))


@expose_action("log")
class Log(LogInfo):
    """Logs a message at a level."""

    def __init__(self, *, msg: SomeSubstitutionsType, level: SomeSubstitutionsType = "INFO", **kwargs: Any):
        super().__init__(msg=msg, **kwargs)
        self.level = level

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<log>``."""
        _, arguments = super().parse(entity, parser)

        level = parser.parse_optional(entity, "level")
        if level:
            entity.refused_by_ros("ROS 2 Jazzy knows no level")
        return (cls if level else LogInfo), {**arguments, **level}

    def execute(self, context: LaunchContext) -> None:
        """Log the message."""
        level = context.perform_substitution(self.level)
        context.log.append(f"[{level}] {context.perform_substitution(self.msg)}")


class _LogAtLevel(Log):
    _level = ""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(msg=msg, level=self._level, **kwargs)

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for an element that has a message only."""
        _, arguments = super(Log, cls).parse(entity, parser)
        return cls, arguments


@expose_action("log_warning", jazzy=False)
class LogWarning(_LogAtLevel):
    """Logs a warning."""

    _level = "WARNING"


@expose_action("log_error", jazzy=False)
class LogError(_LogAtLevel):
    """Logs an error."""

    _level = "ERROR"


@expose_action("log_debug", jazzy=False)
class LogDebug(_LogAtLevel):
    """Logs a message for debugging."""

    _level = "DEBUG"
