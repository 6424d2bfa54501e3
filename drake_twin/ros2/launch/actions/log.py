"""Stand-ins for ``launch.actions.log``."""

from drake_twin.ros2.actions import Log, LogDebug, LogError, LogInfo, LogWarning

__all__ = ["Log", "LogDebug", "LogError", "LogInfo", "LogWarning"]
