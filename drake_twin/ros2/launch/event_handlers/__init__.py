"""Stand-ins for ``launch.event_handlers``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "event_named": "event_named",
        "launch.event_handler": "BaseEventHandler",
        "on_action_event_base": "OnActionEventBase",
        "on_execution_complete": "OnExecutionComplete",
        "on_include_launch_description": "OnIncludeLaunchDescription",
        "on_process_exit": "OnProcessExit",
        "on_process_io": "OnProcessIO",
        "on_process_start": "OnProcessStart",
        "on_shutdown": "OnShutdown",
    },
)
