"""Stand-in for ``rclpy.node``."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from drake_twin.nodes.action_graph import ActionGraph
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.rclpy._rclpy_pybind11 import InvalidHandle, RCLError, RCLInvalidROSArgsError
from drake_twin.nodes.rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from drake_twin.nodes.rclpy.client import Client, ClientHandle
from drake_twin.nodes.rclpy.clock import Clock, Jumps, ROSClock
from drake_twin.nodes.rclpy.context import Context, checked_arguments, default_context
from drake_twin.nodes.rclpy.exceptions import NotInitializedException
from drake_twin.nodes.rclpy.guard_condition import GuardCondition
from drake_twin.nodes.rclpy.handle import NodeHandle
from drake_twin.nodes.rclpy.logging import RcutilsLogger, end_lines, publish_lines
from drake_twin.nodes.rclpy.logging_service import LoggingService
from drake_twin.nodes.rclpy.names import check_name, check_namespace, check_node_name, expanded_name
from drake_twin.nodes.rclpy.node_graph import NodeGraph
from drake_twin.nodes.rclpy.node_parameters import NodeParameters
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.parameter_ranges import PARAM_REL_TOL
from drake_twin.nodes.rclpy.parameter_service import ParameterService
from drake_twin.nodes.rclpy.publisher import Publisher, PublisherHandle
from drake_twin.nodes.rclpy.qos_overriding_options import override_by_parameters
from drake_twin.nodes.rclpy.qos_profiles import profile_of, qos_profile_services_default
from drake_twin.nodes.rclpy.service import Service, ServiceHandle
from drake_twin.nodes.rclpy.subscription import Subscription, SubscriptionHandle
from drake_twin.nodes.rclpy.timer import Rate, Timer
from drake_twin.nodes.rclpy.type_description_service import TypeDescriptionService
from drake_twin.nodes.rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from drake_twin.nodes.rclpy.waitable import Waitable, Waiting
from drake_twin.nodes.task import present_task
from drake_twin.ros2.launched import remapped
from drake_twin.ros2.ros_arguments import RosArguments, parameters_of
from drake_twin.twin.event_topics import PARAMETER_EVENTS

HIDDEN_NODE_PREFIX = "_"
MsgType = TypeVar("MsgType")
SrvType, SrvTypeRequest, SrvTypeResponse = TypeVar("SrvType"), TypeVar("SrvTypeRequest"), TypeVar("SrvTypeResponse")
_Item = TypeVar("_Item")


class Node(NodeParameters, NodeGraph):
    """A node of the graph that node programs and the twin share."""

    PARAM_REL_TOL = PARAM_REL_TOL

    def __init__(
        self,
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
    ):
        self._context: Any = default_context() if context is None else context
        if not self._context.is_valid:
            raise NotInitializedException("cannot create node")
        program = present_task().program
        own = checked_arguments(cli_args or (), RCLInvalidROSArgsError)
        of_all = self._context.arguments if use_global_arguments else RosArguments(())
        self._twin_arguments = arguments = own.before(of_all)
        self._twin_name = check_node_name(node_name)
        self._twin_namespace = check_namespace(namespace or "")
        self._twin_name = arguments.name_for(self._twin_name) or self._twin_name
        self._twin_namespace = arguments.namespace_for(check_node_name(node_name)) or self._twin_namespace
        self._twin_full = f"{self._twin_namespace.rstrip('/')}/{self._twin_name}"
        self._twin_graph: Graph = program.rclpy["graph"]
        self._twin_handle = NodeHandle(self, self._twin_graph, lambda: self._twin_graph.remove_node(self._twin_full))
        self._twin_actions: ActionGraph = program.rclpy["actions"]
        given = parameters_of(self._twin_full, of_all.parameters) | parameters_of(self._twin_full, own.parameters)
        given.update({item.name: item.value for item in parameter_overrides or ()})
        events = self._twin_graph.twin.graph.events[PARAMETER_EVENTS]
        NodeParameters.__init__(self, given, allow_undeclared_parameters, events)
        self._logger = RcutilsLogger(self._twin_handle.logger_name)
        self._twin_publishes_log = enable_rosout and arguments.publishes_log
        if self._twin_publishes_log:
            publish_lines(self._logger.name)
        self._clock = ROSClock()
        self._clock.follow_twin()
        self._twin_jumps = Jumps(self._clock)
        self._rate_group = ReentrantCallbackGroup()
        self._default_callback_group: CallbackGroup = MutuallyExclusiveCallbackGroup()
        self._timers: list[Timer] = []
        self._subscriptions: list[Subscription] = []
        self._guards: list[GuardCondition] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._publishers: list[Publisher] = []
        self._twin_waitables: list[Any] = []
        self._twin_entities: list[Any] = []
        self._twin_executor: Any = None
        self._twin_graph.add_node(self._twin_full, program)
        self._twin_graph.node_logs[self._twin_full] = self._twin_publishes_log
        program.jumped.append(self._twin_jump)
        if automatically_declare_parameters_from_overrides:
            items = self._parameter_overrides.items()
            self.declare_parameters("", [(name, item.value) for name, item in items], ignore_override=True)
        for name, read_only in (("use_sim_time", False), ("start_type_description_service", True)):
            if name not in self._parameters:
                self._twin_declare_quickly(name, True, read_only=read_only)
        self.add_waitable(self._twin_jumps)
        if start_parameter_services:
            ParameterService(self)
        if enable_logger_service:
            LoggingService(self)
        TypeDescriptionService(self)

    # What it is ------------------------------------------------------------------------------------------------------

    @property
    def context(self) -> Context:
        context: Context = self._context
        return context

    @property
    def default_callback_group(self) -> CallbackGroup:
        return self._default_callback_group

    @property
    def executor(self) -> Any:
        return self._twin_executor

    @executor.setter
    def executor(self, executor: Any) -> None:
        before, self._twin_executor = self._twin_executor, executor
        if executor is before:
            return
        if before is not None:
            before.remove_node(self)
        if executor is not None:
            executor.add_node(self)

    @property
    def handle(self) -> NodeHandle:
        return self._twin_handle

    @handle.setter
    def handle(self, value: Any) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    publishers = property(lambda self: iter(self._publishers))
    subscriptions = property(lambda self: iter(self._subscriptions))
    clients = property(lambda self: iter(self._clients))
    services = property(lambda self: iter(self._services))
    timers = property(lambda self: iter(self._timers))
    guards = property(lambda self: iter(self._guards))
    waitables = property(lambda self: iter(self._twin_waitables))

    def get_name(self) -> str:
        self._twin_handle.check()
        return self._twin_name

    def get_namespace(self) -> str:
        self._twin_handle.check()
        return self._twin_namespace

    def get_fully_qualified_name(self) -> str:
        self._twin_handle.check()
        return self._twin_full

    def get_clock(self) -> Clock:
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        return self._logger

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        self._twin_handle.check()
        full = expanded_name(topic, self._twin_namespace, self._twin_name)
        return (
            full
            if only_expand
            else remapped(full, self._twin_namespace, self._twin_full, self._twin_arguments.remappings)
        )

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        return self.resolve_topic_name(service, only_expand=only_expand)

    def _twin_resolved(self, name: str, *, is_service: bool = False) -> str:
        """Return a full name, or raise the error that says where it is wrong."""
        try:
            return self.resolve_topic_name(name)
        except RCLError:
            check_name(name, self._twin_namespace, self._twin_name, is_service=is_service)
            raise

    # What it has -----------------------------------------------------------------------------------------------------

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: Any,
        *,
        callback_group: Any = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Publisher:
        self._twin_handle.check()
        qos, name = profile_of(qos_profile), self._twin_resolved(topic)
        if qos_overriding_options is not None:
            override_by_parameters("publisher", self, name, qos, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = PublisherHandle(self._twin_handle, msg_type, name, qos)
        options = {"event_callbacks": event_callbacks, "callback_group": callback_group or self._default_callback_group}
        publisher = publisher_class(impl, msg_type, topic, qos, **options)
        self._publishers.append(publisher)
        for handler in publisher.event_handlers:
            self.add_waitable(handler)
        return publisher

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: Any,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
    ) -> Subscription:
        self._twin_handle.check()
        qos, name = profile_of(qos_profile), self._twin_resolved(topic)
        group = callback_group or self._default_callback_group
        if qos_overriding_options is not None:
            override_by_parameters("subscription", self, name, qos, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = SubscriptionHandle(self._twin_handle, msg_type, name, qos)
        item = Subscription(impl, msg_type, topic, callback, group, qos, raw, event_callbacks=event_callbacks)
        self._subscriptions.append(item)
        for handler in item.event_handlers:
            self.add_waitable(handler)
        return self._twin_added(item)

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: Any = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        check_is_valid_srv_type(srv_type)
        self._twin_handle.check()
        impl = ClientHandle(self._twin_handle, srv_type, self._twin_resolved(srv_name, is_service=True))
        group = callback_group or self._default_callback_group
        client = Client(self._context, impl, srv_type, srv_name, qos_profile or qos_profile_services_default, group)
        self._clients.append(client)
        return self._twin_added(client)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: Any = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        check_is_valid_srv_type(srv_type)
        self._twin_handle.check()
        impl = ServiceHandle(self._twin_handle, srv_type, self._twin_resolved(srv_name, is_service=True))
        group = callback_group or self._default_callback_group
        service = Service(impl, srv_type, srv_name, callback, group, qos_profile or qos_profile_services_default)
        self._services.append(service)
        return self._twin_added(service)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        period = int(float(timer_period_sec) * 1e9)
        if period < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        group = callback_group or self._default_callback_group
        timer = Timer(callback, group, period, clock or self._clock, context=self._context, autostart=autostart)
        self._timers.append(timer)
        return self._twin_added(timer)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self._context)

    def create_guard_condition(self, callback: Any, callback_group: CallbackGroup | None = None) -> GuardCondition:
        guard = GuardCondition(callback, callback_group or self._default_callback_group, self._context)
        self._guards.append(guard)
        return self._twin_added(guard)

    def add_waitable(self, waitable: Any) -> None:
        self._twin_waitables.append(waitable)
        self._twin_added(Waiting(waitable) if isinstance(waitable, Waitable) else waitable)

    def remove_waitable(self, waitable: Any) -> None:
        waiting = next((item for item in self._twin_entities if getattr(item, "waitable", None) is waitable), waitable)
        if self._twin_removed(waitable, self._twin_waitables) and waiting in self._twin_entities:
            self._twin_entities.remove(waiting)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        return self._twin_destroyed(publisher, self._publishers)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        return self._twin_destroyed(subscription, self._subscriptions)

    def destroy_client(self, client: Client) -> bool:
        return self._twin_destroyed(client, self._clients)

    def destroy_service(self, service: Service) -> bool:
        return self._twin_destroyed(service, self._services)

    def destroy_timer(self, timer: Timer) -> bool:
        return self._twin_destroyed(timer, self._timers)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        return self._twin_destroyed(guard, self._guards)

    def destroy_rate(self, rate: Rate) -> bool:
        rate.destroy()
        return self.destroy_timer(rate.timer)

    def destroy_node(self) -> None:
        """Take back all that the node has."""
        if self._twin_handle.is_destroyed:
            return
        end_lines(self._logger.name)
        for items in (
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self._timers,
            self._guards,
            self._twin_waitables,
        ):
            for item in list(items):
                self._twin_destroyed(item, items)
        self._twin_handle.destroy_when_not_in_use()
        if self._twin_executor is not None:
            self._twin_executor.remove_node(self)

    # -----------------------------------------------------------------------------------------------------------------

    def _twin_jump(self, by: int) -> None:
        self._twin_jumps.put(by)
        for timer in self._timers:
            timer.jump()

    def _twin_added(self, item: _Item) -> _Item:
        item.callback_group.add_entity(item)  # type: ignore[attr-defined]
        self._twin_entities.append(item)
        self._twin_entities.sort(key=_order)
        if self._twin_executor is not None:
            self._twin_executor.wake()
        return item

    def _twin_removed(self, item: Any, items: list[Any]) -> bool:
        if item not in items:
            return False
        items.remove(item)
        if item in self._twin_entities:
            self._twin_entities.remove(item)
        return True

    def _twin_destroyed(self, item: Any, items: list[Any]) -> bool:
        if not self._twin_removed(item, items):
            return False
        for handler in getattr(item, "event_handlers", ()):
            self.remove_waitable(handler)
        with suppress(InvalidHandle):
            item.destroy()
        return True


_KINDS = (Timer, Subscription, GuardCondition, Client, Service)


def _order(item: Any) -> int:
    """Return the order in which an executor looks at what is ready, as in rclpy."""
    return next((index for index, kind in enumerate(_KINDS) if isinstance(item, kind)), len(_KINDS))
