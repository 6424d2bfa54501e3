"""Stand-ins for ``launch.actions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "append_environment_variable": "AppendEnvironmentVariable",
        "declare_launch_argument": "DeclareLaunchArgument",
        "emit_event": "EmitEvent",
        "execute_local": "ExecuteLocal",
        "execute_process": "ExecuteProcess",
        "for_loop": "ForEach ForLoop",
        "group_action": "GroupAction",
        "include_launch_description": "IncludeLaunchDescription",
        "log": "Log LogDebug LogError LogInfo LogWarning",
        "opaque_coroutine": "OpaqueCoroutine",
        "opaque_function": "OpaqueFunction",
        "pop_environment": "PopEnvironment",
        "pop_launch_configurations": "PopLaunchConfigurations",
        "push_environment": "PushEnvironment",
        "push_launch_configurations": "PushLaunchConfigurations",
        "register_event_handler": "RegisterEventHandler",
        "reset_environment": "ResetEnvironment",
        "reset_launch_configurations": "ResetLaunchConfigurations",
        "set_environment_variable": "SetEnvironmentVariable",
        "set_launch_configuration": "SetLaunchConfiguration",
        "shutdown_action": "Shutdown",
        "timer_action": "CancelTimer TimerAction",
        "unregister_event_handler": "UnregisterEventHandler",
        "unset_environment_variable": "UnsetEnvironmentVariable",
        "unset_launch_configuration": "UnsetLaunchConfiguration",
    },
)
