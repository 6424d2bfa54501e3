"""Stand-ins for ``launch.events``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "execution_complete": "ExecutionComplete",
        "include_launch_description": "IncludeLaunchDescription",
        "matchers": "matches_action",
        "shutdown": "Shutdown",
        "timer_event": "TimerEvent",
    },
)
