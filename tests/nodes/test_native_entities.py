"""Names of rclpy that are not documented, and that programs use all the same; what they do is what rclpy 7.1 does."""

from node_runs import HEAD, lines, running, script

TAKEN = """
import time
from std_srvs.srv import SetBool

rclpy.init()
node = Node("my")
subscription = node.create_subscription(String, "talk", lambda message: None, 10)
service = node.create_service(SetBool, "ask", lambda request, response: response)
client = node.create_client(SetBool, "ask")
with subscription.handle, service.handle:
    print(subscription.handle.take_message(String, False), service.handle.service_take_request(SetBool.Request))
node.create_publisher(String, "talk", 10).publish(String(data="a"))
future = client.call_async(SetBool.Request(data=True))
time.sleep(0.1)
message, times = subscription.handle.take_message(subscription.msg_type, False)
request, header = service.handle.service_take_request(service.srv_type.Request)
print(message.data, times["source_timestamp"] > 0, request.data, header.source_timestamp > 0)
service.send_response(SetBool.Response(message="done"), header)
rclpy.spin_until_future_complete(node, future)
print(future.result().message, subscription._callback_type.name)
"""

WAITABLES = """
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.task import Future
from rclpy.waitable import NumberOfEntities, Waitable
from std_srvs.srv import SetBool

PROFILE = rclpy.qos.QoSProfile(depth=10).get_c_qos_profile()


class Waiting(Waitable):
    def __init__(self, kind, entity, take):
        super().__init__(ReentrantCallbackGroup())
        self.kind, self.entity, self.take, self.future = kind, entity, take, Future()

    def get_num_entities(self):
        return NumberOfEntities(**{{"subscription": {{"num_subs": 1}}}}.get(self.kind, {{}}))

    def add_to_wait_set(self, wait_set):
        self.index = getattr(wait_set, f"add_{{self.kind}}")(self.entity)

    def is_ready(self, wait_set):
        return wait_set.is_ready(self.kind, self.index)

    def take_data(self):
        return self.take()

    async def execute(self, taken):
        self.future.set_result(taken)


def finished(kind, entity, take, begin=lambda: None):
    waitable = Waiting(kind, entity, take)
    node.add_waitable(waitable)
    begin()
    rclpy.spin_until_future_complete(node, waitable.future, timeout_sec=1.0)
    node.remove_waitable(waitable)
    return waitable.future.result()


rclpy.init()
node = Node("my", cli_args=["--ros-args", "-r", "talk:=said"])
publisher = node.create_publisher(String, "said", 10)
heard = _rclpy.Subscription(node.handle, String, "talk", PROFILE)
begin = lambda: publisher.publish(String(data="a"))
print(finished("subscription", heard, lambda: heard.take_message(String, False)[0].data, begin))
guard = _rclpy.GuardCondition(node.context.handle)
print(finished("guard_condition", guard, lambda: "triggered", guard.trigger_guard_condition))
start = node.get_clock().now()
timer = _rclpy.Timer(node.get_clock().handle, node.context.handle, 250_000_000, True)
print(finished("timer", timer, lambda: timer.call_timer() or (node.get_clock().now() - start).nanoseconds))
server = _rclpy.Service(node.handle, SetBool, "ask", PROFILE)
client = _rclpy.Client(node.handle, SetBool, "ask", PROFILE)
print(client.service_server_is_available(), client.take_response(SetBool.Response))
begin = lambda: client.send_request(SetBool.Request(data=True))
request, header = finished("service", server, lambda: server.service_take_request(SetBool.Request), begin)
begin = lambda: server.service_send_response(SetBool.Response(message="yes"), header)
number, response = finished("client", client, lambda: client.take_response(SetBool.Response), begin)
print(request.data, number, response.message)
heard.destroy_when_not_in_use()
try:
    heard.take_message(String, False)
except _rclpy.InvalidHandle as error:
    print(type(error).__name__, node.count_subscribers("/said"))
""".replace("{{", "{").replace("}}", "}")

ODDS = """
import inspect
import warnings
import rclpy.action.server
from rcl_interfaces.msg import Log
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.executors import TimeoutObject, await_or_execute
from rclpy.lifecycle import LifecycleNode

rclpy.init()
with rclpy.context.Context().handle:
    pass
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    profile = rclpy.qos.QoSProfile(depth=0)
    profile.depth = 1
    rclpy.qos.QoSProfile(history=rclpy.qos.HistoryPolicy.KEEP_ALL, depth=0)
    print([str(item.message).partition(";")[0] for item in caught])
parameters = inspect.signature(rclpy.create_node).parameters
print(rclpy.action.server.GoalEvent.ABORT.value, TimeoutObject(1.0).timeout, *parameters)
future = rclpy.get_global_executor().create_task(await_or_execute, max, 1, 2)
rclpy.get_global_executor().spin_until_future_complete(future)
print(future.result())
print(_rclpy.rmw_qos_profile_t.predefined("qos_profile_sensor_data").to_dict()["depth"])
node = LifecycleNode("managed")
machine = node._state_machine
print(machine.current_state, machine.initialized, machine.available_transitions[0], machine.service_get_state.name)
node.trigger_configure()
print(machine.current_state, machine.get_transition_by_label("activate"), node._service_get_state.service_name)
try:
    machine.trigger_transition_by_label("configure", True)
except RuntimeError as error:
    print(type(error).__name__)
quiet = LifecycleNode("quiet", enable_communication_interface=False)
print(quiet._state_machine.service_get_state, hasattr(quiet, "_service_get_state"))
try:
    LifecycleNode("wrong", enable_communication_interface="yes")
except TypeError as error:
    print("TypeError")
node.get_logger().info("before")
told = []
node.create_subscription(Log, "/rosout", lambda log: told.append(log.msg), 10)
node.create_subscription(
    Log, "/rosout", lambda log: told.append(f"late {log.msg}"),
    rclpy.qos.QoSProfile(depth=10, durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL),
)
node.get_logger().info("after")
rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=0.2)
print(told)
"""


def ran(tmp_path, capsys, text):
    with running(script(tmp_path, "my.py", HEAD + text)) as twin:
        twin.advance_to(3.0)
        assert twin.findings == ()
    return [line for line in lines(capsys) if not line.startswith("[INFO]")]


def test_messages_and_requests_are_taken_without_a_callback(tmp_path, capsys):
    assert ran(tmp_path, capsys, TAKEN) == ["None (None, None)", "a True True True", "done MessageOnly"]


def test_a_waitable_waits_for_entities_of_its_own(tmp_path, capsys):
    assert ran(tmp_path, capsys, WAITABLES) == [
        "a",
        "triggered",
        "250000000",
        "True (None, None)",
        "True 1 yes",
        "InvalidHandle 0",
    ]


def test_small_things_that_programs_ask_for(tmp_path, capsys):
    assert ran(tmp_path, capsys, ODDS) == [
        '["A zero depth with KEEP_LAST doesn\'t make sense"]',
        (
            "3 1.0 node_name context cli_args namespace use_global_arguments enable_rosout start_parameter_services "
            "parameter_overrides allow_undeclared_parameters automatically_declare_parameters_from_overrides "
            "enable_logger_service"
        ),
        "2",
        "5",
        "(1, 'unconfigured') True (1, 'configure', 1, 'unconfigured', 10, 'configuring') /managed/get_state",
        "(2, 'inactive') 3 /managed/get_state",
        "RCLError",
        "None False",
        "TypeError",
        "['after', 'late before', 'late after']",
    ]
