"""Stand-in for ``rclpy.node``."""

from collections.abc import Callable
from typing import Any, TypeVar

from drake_twin.nodes.action_graph import ActionGraph
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from drake_twin.nodes.rclpy.client import Client
from drake_twin.nodes.rclpy.clock import Clock, Jumps, ROSClock
from drake_twin.nodes.rclpy.context import Context, default_context
from drake_twin.nodes.rclpy.exceptions import NotInitializedException
from drake_twin.nodes.rclpy.guard_condition import GuardCondition
from drake_twin.nodes.rclpy.logging import RcutilsLogger, end_lines, publish_lines
from drake_twin.nodes.rclpy.names import check_namespace, check_node_name, full_name, overrides
from drake_twin.nodes.rclpy.node_parameters import NodeParameters
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.parameter_service import ParameterService
from drake_twin.nodes.rclpy.publisher import Publisher
from drake_twin.nodes.rclpy.qos import profile_of, qos_profile_services_default
from drake_twin.nodes.rclpy.service import Service
from drake_twin.nodes.rclpy.subscription import Subscription
from drake_twin.nodes.rclpy.timer import Rate, Timer
from drake_twin.nodes.rclpy.topic_endpoint_info import GraphQueries
from drake_twin.nodes.rclpy.waitable import Waitable, Waiting
from drake_twin.nodes.task import present_task
from drake_twin.ros2.launched import remapped
from drake_twin.ros2.ros_arguments import split_ros_arguments
from drake_twin.twin.event_topics import PARAMETER_EVENTS

HIDDEN_NODE_PREFIX = "_"
_Item = TypeVar("_Item")


class Node(NodeParameters, GraphQueries):
    """A node of the graph that node programs and the twin share."""

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
        self._context = context or default_context()
        if not self._context.is_valid:
            raise NotInitializedException("cannot create node")
        program = present_task().program
        arguments = split_ros_arguments(cli_args or ())
        if use_global_arguments:
            arguments = arguments.before(self._context.arguments)
        if enable_logger_service:
            program.ignored("enable_logger_service: the twin has no services for the levels of loggers")
        self._arguments = arguments
        self._name = check_node_name(arguments.name or node_name)
        self._namespace = check_namespace(arguments.namespace or namespace or "")
        self._full = f"{self._namespace.rstrip('/')}/{self._name}"
        self._graph: Graph = program.rclpy["graph"]
        self.actions: ActionGraph = program.rclpy["actions"]
        given = overrides(self._full, arguments)
        given.update({item.name: item.value for item in parameter_overrides or ()})
        events = self._graph.twin.graph.events[PARAMETER_EVENTS]
        NodeParameters.__init__(self, given, allow_undeclared_parameters, events)
        self._logger = RcutilsLogger(self._full.strip("/").replace("/", "."))
        if enable_rosout and arguments.publishes_log:
            publish_lines(self._logger.name)
        self._clock = ROSClock()
        self._clock.follow_twin()
        self._jumps = Jumps(self._clock)
        self._rate_group = ReentrantCallbackGroup()
        self._default_group: CallbackGroup = MutuallyExclusiveCallbackGroup()
        self.timers_of_clock: list[Timer] = []
        self._subscriptions: list[Subscription] = []
        self._guards: list[GuardCondition] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._publishers: list[Publisher] = []
        self._waitables: list[Any] = []
        self.entities: list[Any] = []
        self._executor: Any = None
        self._graph.add_node(self._full, program)
        program.jumped.append(self._jump)
        if "use_sim_time" in given:
            self.declare_parameter("use_sim_time", True)
        elif not automatically_declare_parameters_from_overrides:
            self._descriptors["use_sim_time"] = None  # made when it is asked for
            self._take([Parameter("use_sim_time", value=True)], is_declared=True)
        if automatically_declare_parameters_from_overrides:
            self.declare_parameters("", [(name, value) for name, value in given.items() if name != "use_sim_time"])
        self.add_waitable(self._jumps)
        if start_parameter_services:
            ParameterService(self, self._graph)

    # What it is ------------------------------------------------------------------------------------------------------

    @property
    def context(self) -> Context:
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        return self._default_group

    @property
    def executor(self) -> Any:
        return self._executor

    @executor.setter
    def executor(self, executor: Any) -> None:
        self._executor = executor
        if executor is not None:
            executor.add_node(self)

    @property
    def handle(self) -> "Node":
        return self

    publishers = property(lambda self: iter(self._publishers))
    subscriptions = property(lambda self: iter(self._subscriptions))
    clients = property(lambda self: iter(self._clients))
    services = property(lambda self: iter(self._services))
    timers = property(lambda self: iter(self.timers_of_clock))
    guards = property(lambda self: iter(self._guards))
    waitables = property(lambda self: iter(self._waitables))

    def get_name(self) -> str:
        return self._name

    def get_namespace(self) -> str:
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        return self._full

    def get_clock(self) -> Clock:
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        return self._logger

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        full = full_name(topic, self._namespace, self._full)
        return full if only_expand else remapped(full, self._namespace, self._full, self._arguments.remappings)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        full = full_name(service, self._namespace, self._full, is_service=True)
        return full if only_expand else remapped(full, self._namespace, self._full, self._arguments.remappings)

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
        name = self.resolve_topic_name(topic)
        _tell_ignored(event_callbacks, qos_overriding_options)
        publisher = publisher_class(self._graph, msg_type, name, profile_of(qos_profile), self._full)
        self._publishers.append(publisher)
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
        name, group = self.resolve_topic_name(topic), callback_group or self._default_group
        qos = profile_of(qos_profile)
        _tell_ignored(event_callbacks, qos_overriding_options)
        item = Subscription(self._graph, msg_type, name, callback, group, qos, raw, self._full)
        self._subscriptions.append(item)
        return self._added(item)

    def create_client(
        self, srv_type: Any, srv_name: str, *, qos_profile: Any = None, callback_group: CallbackGroup | None = None
    ) -> Client:
        name, group = self.resolve_service_name(srv_name), callback_group or self._default_group
        qos = qos_profile or qos_profile_services_default
        client = Client(self._graph, self._context, srv_type, name, qos, group, self._full)
        self._clients.append(client)
        return self._added(client)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: Any = None,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        name, group = self.resolve_service_name(srv_name), callback_group or self._default_group
        qos = qos_profile or qos_profile_services_default
        service = Service(self._graph, srv_type, name, callback, group, qos, self._full)
        self._services.append(service)
        return self._added(service)

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
            raise ValueError("timer period must not be negative")
        group = callback_group or self._default_group
        timer = Timer(callback, group, period, clock or self._clock, context=self._context, autostart=autostart)
        self.timers_of_clock.append(timer)
        return self._added(timer)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self._context)

    def create_guard_condition(self, callback: Any, callback_group: CallbackGroup | None = None) -> GuardCondition:
        guard = GuardCondition(callback, callback_group or self._default_group, self._context)
        self._guards.append(guard)
        return self._added(guard)

    def add_waitable(self, waitable: Any) -> None:
        self._waitables.append(waitable)
        self._added(Waiting(waitable) if isinstance(waitable, Waitable) else waitable)

    def remove_waitable(self, waitable: Any) -> None:
        waiting = next((item for item in self.entities if getattr(item, "waitable", None) is waitable), waitable)
        if self._removed(waitable, self._waitables) and waiting in self.entities:
            self.entities.remove(waiting)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        return self._destroyed(publisher, self._publishers)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        return self._destroyed(subscription, self._subscriptions)

    def destroy_client(self, client: Client) -> bool:
        return self._destroyed(client, self._clients)

    def destroy_service(self, service: Service) -> bool:
        return self._destroyed(service, self._services)

    def destroy_timer(self, timer: Timer) -> bool:
        return self._destroyed(timer, self.timers_of_clock)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        return self._destroyed(guard, self._guards)

    def destroy_rate(self, rate: Rate) -> bool:
        rate.destroy()
        return self.destroy_timer(rate.timer)

    def destroy_node(self) -> None:
        """Take back all that the node has."""
        self._graph.remove_node(self._full)
        end_lines(self._logger.name)
        for items in (
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self.timers_of_clock,
            self._guards,
            self._waitables,
        ):
            for item in list(items):
                self._destroyed(item, items)
        if self._executor is not None:
            self._executor.remove_node(self)

    def __enter__(self) -> "Node":
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy_node()

    # What others have ------------------------------------------------------------------------------------------------

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        present_task().count_idle_call()
        return list(self._graph.topics().items())

    def get_service_names_and_types(self) -> list[tuple[str, list[str]]]:
        present_task().count_idle_call()
        return self._graph.service_names()

    def get_node_names(self) -> list[str]:
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        present_task().count_idle_call()
        return [(name.rpartition("/")[2], name.rpartition("/")[0] or "/") for name in self._graph.node_names()]

    def get_fully_qualified_node_names(self) -> list[str]:
        return self._graph.node_names()

    def count_publishers(self, topic_name: str) -> int:
        present_task().count_idle_call()
        return len(self._graph.publishers_of(self.resolve_topic_name(topic_name)))

    def count_subscribers(self, topic_name: str) -> int:
        present_task().count_idle_call()
        return len(self._graph.subscribers_of(self.resolve_topic_name(topic_name)))

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        from drake_twin.nodes.simulated_time import wait_until

        name = "/" + fully_qualified_node_name.lstrip("/")
        return wait_until(present_task(), lambda: name in self._graph.node_names(), timeout)

    # -----------------------------------------------------------------------------------------------------------------

    def _jump(self, by: int) -> None:
        self._jumps.put(by)
        for timer in self.timers_of_clock:
            timer.jump()

    def _added(self, item: _Item) -> _Item:
        item.callback_group.add_entity(item)  # type: ignore[attr-defined]
        self.entities.append(item)
        self.entities.sort(key=_order)
        if self._executor is not None:
            self._executor.wake()
        return item

    def _removed(self, item: Any, items: list[Any]) -> bool:
        if item not in items:
            return False
        items.remove(item)
        if item in self.entities:
            self.entities.remove(item)
        return True

    def _destroyed(self, item: Any, items: list[Any]) -> bool:
        if not self._removed(item, items):
            return False
        item.destroy()
        return True


def _tell_ignored(event_callbacks: Any, qos_overriding_options: Any) -> None:
    program = present_task().program
    if event_callbacks is not None:
        program.ignored("event_callbacks: no event of quality of service happens in the twin")
    if qos_overriding_options is not None:
        program.ignored("qos_overriding_options: the profile that the program gives counts")


_KINDS = (Timer, Subscription, GuardCondition, Client, Service)


def _order(item: Any) -> int:
    """Return the order in which an executor looks at what is ready, as in rclpy."""
    return next((index for index, kind in enumerate(_KINDS) if isinstance(item, kind)), len(_KINDS))
