"""What rclpy does of which the twin makes use: a program that prints it, for the real one and for the double.

``rclpy_recorded.json`` has what rclpy 7.1.3 (ROS 2 Jazzy, rmw_cyclonedds_cpp) printed.
"""

import json
import sys
import time

import rclpy
from rcl_interfaces.srv import ListParameters
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String

HELLO = bytes.fromhex("000100000600000068656c6c6f00")
LIST = bytes.fromhex("0001000000000000000000000000000000000000")
found = {}


def outcome(function, *arguments, **options):
    """What a call returns, or the class of what it raises."""
    try:
        return function(*arguments, **options)
    except Exception as error:
        return type(error).__name__


def until(condition):
    end = time.monotonic() + 10
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


def quality(depth=10, latched=False):
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=depth, durability=durability, reliability=ReliabilityPolicy.RELIABLE)


def new_node(name, namespace="/"):
    parameter = rclpy.Parameter("start_type_description_service", value=False)
    options = {"enable_rosout": False, "start_parameter_services": False, "parameter_overrides": [parameter]}
    return rclpy.create_node(name, namespace=namespace, context=context, **options)


def wait(subscriptions=(), services=(), clients=(), timeout=10_000_000_000):
    counts = len(subscriptions), 1, 0, len(clients), len(services), 0
    wait_set = rclpy_implementation.WaitSet(*counts, context.handle)
    wait_set.clear_entities()
    wait_set.add_guard_condition(guard)
    for kind, ends in (("subscription", subscriptions), ("service", services), ("client", clients)):
        for end in ends:
            getattr(wait_set, f"add_{kind}")(end.handle)
    wait_set.wait(timeout)
    return [
        [end.handle.pointer in wait_set.get_ready_entities(kind) for end in ends]
        for kind, ends in (("subscription", subscriptions), ("service", services), ("client", clients))
    ]


def answered(client, service):
    """A request's way to the service and back, as bytes."""
    with client.handle:
        number = client.handle.send_request(deserialize_message(LIST, ListParameters.Request))
    ready = wait(services=[service])
    request, header = service.handle.service_take_request(ListParameters.Request)
    response = deserialize_message(LIST[:12], ListParameters.Response)
    service.send_response(response, header)
    ready += wait(clients=[client])
    header, response = client.handle.take_response(ListParameters.Response)
    same = header.request_id.sequence_number == number
    return ready, same, serialize_message(request).hex(), serialize_message(response).hex()


context = rclpy.Context()
rclpy.init(args=["drake_twin", "--ros-args", "-r", "/old:=/new"], context=context, domain_id=int(sys.argv[1]))
guard = rclpy_implementation.GuardCondition(context.handle)
node = new_node("one", "/space")
found["nodes"] = sorted(name for name in node.get_node_names_and_namespaces() if not name[0].startswith("_"))
publisher = node.create_publisher(String, "/topic", quality())
found["nobody listens"] = publisher.get_subscription_count()
heard = node.create_subscription(String, "/topic", lambda data: None, quality(), raw=True)
found["an own subscription counts"] = until(lambda: publisher.get_subscription_count() == 1)
found["nothing has come"] = outcome(heard.handle.take_message, String, True)
found["a guard condition ends a wait"] = (guard.trigger_guard_condition(), wait([heard]))
publisher.publish(HELLO)
found["an own message comes"] = wait([heard])
found["as bytes"] = [outcome(heard.handle.take_message, String, True)[0].hex()]
found["once"] = outcome(heard.handle.take_message, String, True)
found["what is no message"] = outcome(publisher.publish, 3)
found["remapped"] = node.create_publisher(String, "/old", quality()).handle.get_topic_name()
found["remapped subscription"] = node.create_subscription(
    String, "/old", print, quality(), raw=True
).handle.get_topic_name()
latched = node.create_publisher(String, "/latched", quality(1, latched=True))
latched.publish(HELLO)
late = node.create_subscription(String, "/latched", print, quality(1, latched=True), raw=True)
found["a late joiner hears the last message"] = wait([late])
service = node.create_service(ListParameters, "/list", lambda *_: None, qos_profile=quality(1000))
client = node.create_client(ListParameters, "/list")
absent = node.create_client(ListParameters, "/absent")
found["a service is there"] = until(client.service_is_ready), absent.service_is_ready()
found["no request"] = outcome(service.handle.service_take_request, ListParameters.Request)
found["no response"] = outcome(client.handle.take_response, ListParameters.Response)
found["answered"] = answered(client, service)
found["the types of a topic"] = dict(node.get_topic_names_and_types())["/topic"]
found["the types of a service"] = dict(node.get_service_names_and_types())["/list"]
other = new_node("two")
found["a node's publishers"] = sorted(node.get_publisher_names_and_types_by_node("one", "/space"))
found["those of no node"] = outcome(node.get_publisher_names_and_types_by_node, "three", "/")
found["a bad name"] = outcome(new_node, "a b"), outcome(node.create_publisher, String, "/a b", quality())
node.destroy_publisher(publisher)
found["a destroyed publisher"] = outcome(publisher.publish, HELLO)
found["fields"] = [
    String.get_fields_and_field_types(),
    ListParameters.Request.get_fields_and_field_types(),
    ListParameters.Response.get_fields_and_field_types(),
]
other.destroy_node()
node.destroy_node()
rclpy.shutdown(context=context)
bad = ["drake_twin", "--ros-args", "--nosuch"]
found["unknown arguments"] = outcome(rclpy.init, args=bad, context=rclpy.Context())
found["a bad rule"] = outcome(rclpy.init, args=["drake_twin", "--ros-args", "-r", "bad"], context=rclpy.Context())
print(json.dumps(found, indent=1))
