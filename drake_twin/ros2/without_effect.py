"""What ROS's Python modules accept in the twin without an effect, each with the reason: the one list of it.

A member, or a parameter of a member in parentheses, stands here under the name by which it is imported. What a program
would miss is not listed: it raises ``NotImplementedError``, or becomes a finding. A test fails for a member of a
stand-in that does nothing, and for a parameter that nothing reads, if it is not here.
"""

from collections.abc import Mapping

_BY_REASON: Mapping[str, tuple[str, ...]] = {
    "the twin ends its nodes, as Ctrl-C would": (
        "launch.actions.ExecuteLocal(sigkill_timeout)",
        "launch.actions.ExecuteLocal(sigterm_timeout)",
    ),
    "it changes only what is printed": (
        "launch.actions.ExecuteLocal(cached_output)",
        "launch.actions.ExecuteLocal(emulate_tty)",
        "launch.actions.ExecuteLocal(log_cmd)",
        "launch.actions.ExecuteLocal(output_format)",
        "launch_ros.actions.Node(exec_name)",
        "rclpy.logging.set_logger_level(detailed_error)",
    ),
    "nothing starts after a shutdown": ("launch.actions.TimerAction(cancel_on_shutdown)",),
    "a launch file is evaluated at once, and nothing is left to wait for": (
        "launch.LaunchContext.add_completion_future",
        "launch.LaunchContext.add_completion_future(completion_future)",
        "launch.LaunchDescriptionEntity.get_asyncio_future",
        "launch.actions.ExecuteLocal.get_asyncio_future",
        "launch.actions.OpaqueCoroutine.get_asyncio_future",
        "launch.actions.TimerAction.get_asyncio_future",
    ),
    "nobody is asked while a launch file is evaluated": ("launch.LaunchContext(noninteractive)",),
    "no process of the launch has a number": (
        "launch.events.process.matches_pid(pid)",
        "launch.events.process.SignalProcess(signal_number)",
    ),
    "a base class does nothing by itself": (
        "launch.Action.execute",
        "launch.Action.execute(context)",
        "launch.LaunchDescriptionEntity.visit",
        "launch.LaunchDescriptionEntity.visit(context)",
        "launch.Substitution.perform",
        "launch.Substitution.perform(context)",
    ),
    "its result does not depend on it": (
        "launch.LaunchDescription.visit(context)",
        "launch.substitutions.TextSubstitution.perform(context)",
        "rclpy.action.server.default_cancel_callback(cancel_request)",
        "rclpy.impl.rcutils_logger.LoggingFilter.should_log",
        "rclpy.impl.rcutils_logger.LoggingFilter.should_log(context)",
        "rclpy.action.server.default_goal_callback(goal_request)",
        "rclpy.callback_groups.MutuallyExclusiveCallbackGroup.can_execute(entity)",
        "rclpy.callback_groups.MutuallyExclusiveCallbackGroup.ending_execution(entity)",
        "rclpy.callback_groups.ReentrantCallbackGroup.beginning_execution",
        "rclpy.callback_groups.ReentrantCallbackGroup.beginning_execution(entity)",
        "rclpy.callback_groups.ReentrantCallbackGroup.can_execute",
        "rclpy.callback_groups.ReentrantCallbackGroup.can_execute(entity)",
        "rclpy.callback_groups.ReentrantCallbackGroup.ending_execution",
        "rclpy.callback_groups.ReentrantCallbackGroup.ending_execution(entity)",
        "rclpy.lifecycle.SimpleManagedEntity.on_activate(state)",
        "rclpy.lifecycle.SimpleManagedEntity.on_deactivate(state)",
        *(
            f"rclpy.lifecycle.{kind}.on_{transition}(state)"
            for kind in ("ManagedEntity",)
            for transition in ("activate", "cleanup", "configure", "deactivate", "error", "shutdown")
        ),
    ),
    "the value is read as its type where it is used": (
        "launch.utilities.type_utils.normalize_typed_substitution(data_type)",
    ),
    "the file's name tells how it is read": (
        "launch.launch_description_sources.FrontendLaunchDescriptionSource(parser)",
    ),
    "every component of a container is loaded alike": ("launch_ros.descriptions.ComposableNode(extra_arguments)",),
    "an exact copy of every message arrives at the next step": (
        *(
            f"rclpy.action.Action{side}({what}_qos_profile)"
            for side, end in (("Client", "sub"), ("Server", "pub"))
            for what in ("cancel_service", f"feedback_{end}", "goal_service", "result_service", f"status_{end}")
        ),
        "rclpy.publisher.Publisher.wait_for_all_acked",
        "rclpy.publisher.Publisher.wait_for_all_acked(timeout)",
    ),
    "a topic has its ROS name everywhere": (
        "rclpy.node.Node.get_publisher_names_and_types_by_node(no_demangle)",
        "rclpy.node.Node.get_subscriber_names_and_types_by_node(no_demangle)",
    ),
    "a result is kept as long as its server": (
        "rclpy.action.ActionServer(result_timeout)",
        "rclpy.action.ActionServer.notify_goal_done",
    ),
    "the graph tells it of its events, and an executor asks it without a wait set": (
        *(
            f"rclpy.{kind}.{member}"
            for kind in ("action.ActionClient", "action.ActionServer", "event_handler.EventHandler")
            for member in ("add_to_wait_set", "add_to_wait_set(wait_set)", "is_ready(wait_set)")
        ),
    ),
    "a context has nothing that is left after its shutdown": ("rclpy.Context.destroy",),
    "one thread of a program runs at a time, and none has to be waited for": (
        "rclpy.executors.Executor.shutdown(timeout_sec)",
    ),
    "the context is the node's": (
        "rclpy.guard_condition.GuardCondition(context)",
        "rclpy.timer.Timer(context)",
    ),
    "loggers need no set-up": (
        "rclpy.Context.init(initialize_logging)",
        "rclpy.logging.initialize",
        "rclpy.logging.shutdown",
    ),
}

# Parameters that become a finding with the program's line, or the launch file's, where they are given.
AS_FINDINGS = (
    "launch.actions.ExecuteProcess(cwd)",
    "launch.actions.ExecuteProcess(prefix)",
)
WITHOUT_EFFECT: Mapping[str, str] = {name: reason for reason, names in _BY_REASON.items() for name in names}


def parameters_without_effect(member: str) -> tuple[str, ...]:
    """Return the parameters of a class or function that it accepts without an effect."""
    start = f"{member}("
    return tuple(name[len(start) : -1] for name in WITHOUT_EFFECT if name.startswith(start))
