"""Stand-in for ``rclpy``: the client library of ROS 2 over a twin.

Names and behaviour are rclpy's of Jazzy; docstrings say what differs.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from drake_twin.nodes.rclpy.context import Context, default_context
from drake_twin.nodes.rclpy.executors import Executor, SingleThreadedExecutor
from drake_twin.nodes.rclpy.node import Node
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.signals import (
    SignalHandlerOptions,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.rclpy.utilities import get_default_context, get_rmw_implementation_identifier, ok, try_shutdown
from drake_twin.nodes.stand_ins import imported
from drake_twin.nodes.task import present_task

__all__ = [
    "Context",
    "Future",
    "Node",
    "Parameter",
    "SignalHandlerOptions",
    "create_node",
    "get_default_context",
    "get_global_executor",
    "get_rmw_implementation_identifier",
    "init",
    "install_signal_handlers",
    "ok",
    "shutdown",
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "try_shutdown",
    "uninstall_signal_handlers",
]


class _Initialized:
    """What ``init`` returns in Jazzy: a context manager that shuts down at its end."""

    def __init__(self, context: Context | None):
        self._given = context
        self.context = context or default_context()

    def __enter__(self) -> "_Initialized":
        return self

    def __exit__(self, *_: object) -> None:
        try_shutdown(context=self._given)


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> _Initialized:
    """Begin to use ROS."""
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if context is None else SignalHandlerOptions.NO
    (context or default_context()).init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)
    return _Initialized(context)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """End the use of ROS."""
    if uninstall_handlers or (uninstall_handlers is None and context is None):
        uninstall_signal_handlers()
    context = context or default_context(shutting_down=True)
    executor = present_task().program.rclpy.pop("executor", None)
    if executor is not None:
        executor.shutdown()
    context.shutdown()


def create_node(
    node_name: str,
    *,
    context: Context | None = None,
    cli_args: list[str] | None = None,
    namespace: str | None = None,
    use_global_arguments: bool = True,
    enable_rosout: bool = True,
    start_parameter_services: bool = True,
    parameter_overrides: list[Parameter] | None = None,
    allow_undeclared_parameters: bool = False,
    automatically_declare_parameters_from_overrides: bool = False,
    enable_logger_service: bool = False,
) -> Node:
    """Return a new node."""
    imported("rclpy.node")  # as rclpy's own does here
    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
        enable_logger_service=enable_logger_service,
    )


def get_global_executor() -> Executor:
    """Return the executor of `spin`, one of each program."""
    known = present_task().program.rclpy
    executor: Executor | None = known.get("executor")
    if executor is None or executor._is_shutdown:
        executor = known["executor"] = SingleThreadedExecutor()
    return executor


@contextmanager
def _executor_with(node: Node, executor: Executor | None) -> Iterator[Executor]:
    """Add a node to an executor, by default that of `spin`, and remove it at the end."""
    executor = executor or get_global_executor()
    try:
        executor.add_node(node)
        yield executor
    finally:
        executor.remove_node(node)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Call back once, after at most some simulation time (s)."""
    with _executor_with(node, executor) as executor:
        executor.spin_once(timeout_sec=timeout_sec)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Call back until the context is shut down."""
    with _executor_with(node, executor) as executor:
        while executor.context.ok() and not executor._is_shutdown:
            executor.spin_once()


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Call back until a future is done, or for some simulation time (s)."""
    with _executor_with(node, executor) as executor:
        executor.spin_until_future_complete(future, timeout_sec)
