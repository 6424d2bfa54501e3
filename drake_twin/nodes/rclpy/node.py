"""Stand-in for ``rclpy.node``."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from drake_twin.nodes.rclpy._rclpy_pybind11 import InvalidHandle, RCLError, RCLInvalidROSArgsError
from drake_twin.nodes.rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from drake_twin.nodes.rclpy.client import Client, ClientHandle
from drake_twin.nodes.rclpy.clock import Clock, Jumps, ROSClock
from drake_twin.nodes.rclpy.context import Context, checked_arguments, default_context
from drake_twin.nodes.rclpy.exceptions import NotInitializedException
from drake_twin.nodes.rclpy.guard_condition import GuardCondition
from drake_twin.nodes.rclpy.logging import RcutilsLogger, end_lines, publish_lines
from drake_twin.nodes.rclpy.logging_service import LoggingService
from drake_twin.nodes.rclpy.names import check_name, check_namespace, check_node_name
from drake_twin.nodes.rclpy.node_graph import NodeGraph
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.node_parameters import NodeParameters
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.parameter_ranges import PARAM_REL_TOL
from drake_twin.nodes.rclpy.parameter_service import ParameterService
from drake_twin.nodes.rclpy.publisher import Publisher, PublisherHandle
from drake_twin.nodes.rclpy.qos_overriding_options import _declare_qos_parameters
from drake_twin.nodes.rclpy.qos_profiles import profile_of, qos_profile_services_default
from drake_twin.nodes.rclpy.service import Service, ServiceHandle
from drake_twin.nodes.rclpy.subscription import Subscription, SubscriptionHandle
from drake_twin.nodes.rclpy.timer import Rate, Timer
from drake_twin.nodes.rclpy.type_description_service import TypeDescriptionService
from drake_twin.nodes.rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from drake_twin.nodes.rclpy.waitable import Waitable, Waiting
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
        own = checked_arguments(cli_args or (), RCLInvalidROSArgsError)
        of_all = self._context.arguments if use_global_arguments else RosArguments(())
        arguments = own.before(of_all)
        given_name, given_namespace = check_node_name(node_name), check_namespace(namespace or "")
        self.__handle = NodeHandle(
            arguments.name_for(given_name) or given_name,
            arguments.namespace_for(given_name) or given_namespace,
            self._context,
            arguments,
        )
        self.__handle.add_waitable = self.add_waitable
        name, graph = self.__handle.name, self.__handle.graph
        given = parameters_of(name, of_all.parameters) | parameters_of(name, own.parameters)
        given.update({item.name: item.value for item in parameter_overrides or ()})
        events = graph.twin.graph.events[PARAMETER_EVENTS]
        NodeParameters.__init__(self, given, allow_undeclared_parameters, events)
        self._logger = RcutilsLogger(self.__handle.logger_name)
        publishes_log = enable_rosout and arguments.publishes_log
        if publishes_log:
            publish_lines(self._logger.name)
        self._clock = ROSClock()
        self._clock._follow_twin()
        self.__jumps = Jumps(self._clock)
        self._rate_group = ReentrantCallbackGroup()
        self._default_callback_group: CallbackGroup = MutuallyExclusiveCallbackGroup()
        self._timers: list[Timer] = []
        self._subscriptions: list[Subscription] = []
        self._guards: list[GuardCondition] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._publishers: list[Publisher] = []
        self.__waitables: list[Any] = []
        graph.add_node(name, self.__handle.program)
        graph.node_logs[name] = publishes_log
        self.__handle.program.jumped.append(self.__jump)
        if automatically_declare_parameters_from_overrides:
            items = self._parameter_overrides.items()
            self.declare_parameters("", [(name, item.value) for name, item in items], ignore_override=True)
        for own_name, read_only in (("use_sim_time", False), ("start_type_description_service", True)):
            if own_name not in self._parameters:
                self._rclpy_declare_quickly(own_name, True, read_only=read_only)
        self.add_waitable(self.__jumps)
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
        return self.__handle.executor

    @executor.setter
    def executor(self, executor: Any) -> None:
        before, self.__handle.executor = self.__handle.executor, executor
        if executor is before:
            return
        if before is not None:
            before.remove_node(self)
        if executor is not None:
            executor.add_node(self)

    @property
    def handle(self) -> NodeHandle:
        return self.__handle

    @handle.setter
    def handle(self, value: Any) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    publishers = property(lambda self: iter(self._publishers))
    subscriptions = property(lambda self: iter(self._subscriptions))
    clients = property(lambda self: iter(self._clients))
    services = property(lambda self: iter(self._services))
    timers = property(lambda self: iter(self._timers))
    guards = property(lambda self: iter(self._guards))
    waitables = property(lambda self: iter(self.__waitables))

    def get_name(self) -> str:
        self.__handle.check()
        return self.__handle.base

    def get_namespace(self) -> str:
        self.__handle.check()
        return self.__handle.namespace

    def get_fully_qualified_name(self) -> str:
        self.__handle.check()
        return self.__handle.name

    def get_clock(self) -> Clock:
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        return self._logger

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        self.__handle.check()
        full = self.__handle.expanded(topic)
        return full if only_expand else self.__handle.remapped(full)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        return self.resolve_topic_name(service, only_expand=only_expand)

    def __resolved(self, name: str, *, is_service: bool = False) -> str:
        """Return a full name, or raise the error that says where it is wrong."""
        try:
            return self.resolve_topic_name(name)
        except RCLError:
            check_name(name, self.__handle.namespace, self.__handle.base, is_service=is_service)
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
        self.__handle.check()
        qos, name = profile_of(qos_profile), self.__resolved(topic)
        if qos_overriding_options is not None:
            _declare_qos_parameters(Publisher, self, name, qos, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = PublisherHandle(self.__handle, msg_type, name, qos)
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
        self.__handle.check()
        qos, name = profile_of(qos_profile), self.__resolved(topic)
        group = callback_group or self._default_callback_group
        if qos_overriding_options is not None:
            _declare_qos_parameters(Subscription, self, name, qos, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = SubscriptionHandle(self.__handle, msg_type, name, qos)
        item = Subscription(impl, msg_type, topic, callback, group, qos, raw, event_callbacks=event_callbacks)
        self._subscriptions.append(item)
        for handler in item.event_handlers:
            self.add_waitable(handler)
        return self.__added(item)

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: Any = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        check_is_valid_srv_type(srv_type)
        self.__handle.check()
        impl = ClientHandle(self.__handle, srv_type, self.__resolved(srv_name, is_service=True))
        group = callback_group or self._default_callback_group
        client = Client(self._context, impl, srv_type, srv_name, qos_profile or qos_profile_services_default, group)
        self._clients.append(client)
        return self.__added(client)

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
        self.__handle.check()
        impl = ServiceHandle(self.__handle, srv_type, self.__resolved(srv_name, is_service=True))
        group = callback_group or self._default_callback_group
        service = Service(impl, srv_type, srv_name, callback, group, qos_profile or qos_profile_services_default)
        self._services.append(service)
        return self.__added(service)

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
        return self.__added(timer)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self._context)

    def create_guard_condition(self, callback: Any, callback_group: CallbackGroup | None = None) -> GuardCondition:
        guard = GuardCondition(callback, callback_group or self._default_callback_group, self._context)
        self._guards.append(guard)
        return self.__added(guard)

    def add_waitable(self, waitable: Any) -> None:
        self.__waitables.append(waitable)
        self.__added(Waiting(waitable) if isinstance(waitable, Waitable) else waitable)

    def remove_waitable(self, waitable: Any) -> None:
        entities = self.__handle.entities
        waiting = next((item for item in entities if getattr(item, "waitable", None) is waitable), waitable)
        if self.__removed(waitable, self.__waitables):
            self.__handle.remove(waiting)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        return self.__destroyed(publisher, self._publishers)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        return self.__destroyed(subscription, self._subscriptions)

    def destroy_client(self, client: Client) -> bool:
        return self.__destroyed(client, self._clients)

    def destroy_service(self, service: Service) -> bool:
        return self.__destroyed(service, self._services)

    def destroy_timer(self, timer: Timer) -> bool:
        return self.__destroyed(timer, self._timers)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        return self.__destroyed(guard, self._guards)

    def destroy_rate(self, rate: Rate) -> bool:
        rate.destroy()
        return self.destroy_timer(rate.timer)

    def destroy_node(self) -> None:
        """Take back all that the node has."""
        if self.__handle.is_destroyed:
            return
        end_lines(self._logger.name)
        for items in (
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self._timers,
            self._guards,
            self.__waitables,
        ):
            for item in list(items):
                self.__destroyed(item, items)
        self.__handle.destroy_when_not_in_use()
        if self.__handle.executor is not None:
            self.__handle.executor.remove_node(self)

    # -----------------------------------------------------------------------------------------------------------------

    def __jump(self, by: int) -> None:
        self.__jumps.put(by)
        for timer in self._timers:
            timer._jump()

    def __added(self, item: _Item) -> _Item:
        item.callback_group.add_entity(item)  # type: ignore[attr-defined]
        self.__handle.add(item, _order)
        return item

    def __removed(self, item: Any, items: list[Any]) -> bool:
        if item not in items:
            return False
        items.remove(item)
        self.__handle.remove(item)
        return True

    def __destroyed(self, item: Any, items: list[Any]) -> bool:
        if not self.__removed(item, items):
            return False
        for handler in getattr(item, "event_handlers", ()):
            self.remove_waitable(handler)
        if hasattr(item, "destroy"):  # a waitable of a user's own may have nothing to end
            with suppress(InvalidHandle):
                item.destroy()
        return True


_KINDS = (Timer, Subscription, GuardCondition, Client, Service)


def _order(item: Any) -> int:
    """Return the order in which an executor looks at what is ready, as in rclpy."""
    return next((index for index, kind in enumerate(_KINDS) if isinstance(item, kind)), len(_KINDS))
