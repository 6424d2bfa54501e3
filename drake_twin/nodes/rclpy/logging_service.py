"""Stand-in for ``rclpy.logging_service``."""

from typing import Any

from drake_twin.nodes.rclpy import logging
from drake_twin.nodes.rclpy.impl.logging_severity import LoggingSeverity


class LoggingService:
    """The two services for the levels of loggers."""

    def __init__(self, node: Any):
        from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

        self._get_logger_service = node.create_service(GetLoggerLevels, "~/get_logger_levels", self._get_logger_levels)
        self._set_logger_service = node.create_service(SetLoggerLevels, "~/set_logger_levels", self._set_logger_levels)

    def _get_logger_levels(self, request: Any, response: Any) -> Any:
        from rcl_interfaces.msg import LoggerLevel

        for name in request.names:
            level = logging.get_logger(name).get_effective_level()
            response.levels.append(LoggerLevel(name=name, level=int(level)))
        return response

    def _set_logger_levels(self, request: Any, response: Any) -> Any:
        from rcl_interfaces.msg import SetLoggerLevelsResult

        for item in request.levels:
            result = SetLoggerLevelsResult(successful=True)
            try:
                logging.set_logger_level(item.name, LoggingSeverity(item.level))
            except ValueError:
                result = SetLoggerLevelsResult(successful=False, reason="Failed reason: Invalid logger level.")
            response.results.append(result)
        return response
