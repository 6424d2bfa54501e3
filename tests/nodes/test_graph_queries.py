"""What nodes ask of the graph about each other and the twin."""

from node_runs import HEAD, lines, running, script


def test_who_publishes_subscribes_and_offers(tmp_path, capsys):
    text = """
from rclpy.action.client import GoalStatus
from rclpy.action.server import GoalStatus as Same
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("asks", namespace="/a", start_parameter_services=False)
node.create_publisher(String, "talk", 10)
node.create_publisher(String, "/kept", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
node.create_subscription(String, "talk", print, 10)
node.create_service(Trigger, "go", lambda request, response: response)
rclpy.spin_once(node, timeout_sec=0.1)


def told(infos):
    names = [(info.node_namespace, info.node_name, info.topic_type, info.endpoint_type.name) for info in infos]
    return names, [info.qos_profile.durability.name for info in infos]


print(*told(node.get_publishers_info_by_topic("talk")))
print(*told(node.get_subscriptions_info_by_topic("talk")))
print(told(node.get_publishers_info_by_topic("/kept"))[1], told(node.get_publishers_info_by_topic("/tf_static"))[1])
print(node.get_publishers_info_by_topic("/nowhere"))
print(node.get_publisher_names_and_types_by_node("asks", "/a"))
print(node.get_subscriber_names_and_types_by_node("asks", "/a"))
print(node.get_service_names_and_types_by_node("asks", "/a"), node.count_services("go"), node.count_services("no"))
print(GoalStatus.STATUS_SUCCEEDED, GoalStatus is Same, isinstance(node.get_logger(), RcutilsLogger))
print(LoggingSeverity.WARN.value, TopicEndpointTypeEnum.PUBLISHER.value)
"""
    with running(script(tmp_path, "asks.py", HEAD + text)) as twin:
        twin.advance_to(0.2)
        assert twin.findings == ()
    kind = "std_msgs/msg/String"
    assert lines(capsys) == [
        f"[('/a', 'asks', '{kind}', 'PUBLISHER')] ['VOLATILE']",
        f"[('/a', 'asks', '{kind}', 'SUBSCRIPTION')] ['VOLATILE']",
        "['TRANSIENT_LOCAL'] ['TRANSIENT_LOCAL']",
        "[]",
        (
            f"[('/a/talk', ['{kind}']), ('/kept', ['{kind}']), "
            "('/parameter_events', ['rcl_interfaces/msg/ParameterEvent']), ('/rosout', ['rcl_interfaces/msg/Log'])]"
        ),
        f"[('/a/talk', ['{kind}'])]",
        (
            "[('/a/asks/get_type_description', ['type_description_interfaces/srv/GetTypeDescription']), "
            "('/a/go', ['std_srvs/srv/Trigger'])] 1 0"
        ),
        "4 True True",
        "30 1",
    ]


def test_profiles_are_those_that_rclpy_sees(tmp_path, capsys):
    """The lines are those of rclpy (Jazzy) with rmw_cyclonedds_cpp for the same node, but for the twin's own topics."""
    text = """
from rclpy.duration import Duration
from rclpy.qos import *


rclpy.init()
node = rclpy.create_node("asks", start_parameter_services=False)
node.create_publisher(String, "/a", 5)
manual = LivelinessPolicy.MANUAL_BY_TOPIC
spans = {"lifespan": Duration(seconds=2), "deadline": Duration(seconds=1)}
spans["liveliness_lease_duration"] = Duration(seconds=4)
lossy, kept = ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.TRANSIENT_LOCAL
node.create_publisher(String, "/b", QoSProfile(depth=3, reliability=lossy, durability=kept, liveliness=manual, **spans))
node.create_publisher(String, "/c", QoSProfile(history=HistoryPolicy.KEEP_ALL))
node.create_publisher(String, "/d", qos_profile_system_default)
open_ = QoSProfile(depth=7, reliability=ReliabilityPolicy.BEST_AVAILABLE, lifespan=Duration(seconds=2))
node.create_subscription(String, "/a", print, open_)
node.create_subscription(String, "/b", print, qos_profile_sensor_data)
rclpy.spin_once(node, timeout_sec=0.1)
for topic in ("/a", "/b", "/c", "/d", "/robot_1/robot_description", "/rosout"):
    infos = (node.get_publishers_info_by_topic(topic), node.get_subscriptions_info_by_topic(topic))
    for info in [*infos[0][:1], *infos[1]]:
        of = info.qos_profile
        spans = (of.lifespan, of.deadline, of.liveliness_lease_duration)
        words = (of.history.name, of.depth, of.reliability.name, of.durability.name, of.liveliness.name)
        print(topic, *words, *(span.nanoseconds for span in spans))
"""
    with running(script(tmp_path, "asks.py", HEAD + text)) as twin:
        twin.advance_to(0.2)
    endless = 2**63 - 1
    both = "RELIABLE VOLATILE AUTOMATIC", f"{endless} {endless} {endless}"
    assert lines(capsys) == [
        f"/a KEEP_LAST 5 {both[0]} {both[1]}",
        f"/a KEEP_LAST 7 {both[0]} {both[1]}",
        "/b KEEP_LAST 3 BEST_EFFORT TRANSIENT_LOCAL MANUAL_BY_TOPIC 2000000000 1000000000 4000000000",
        f"/b KEEP_LAST 5 BEST_EFFORT VOLATILE AUTOMATIC {both[1]}",
        f"/c KEEP_ALL 0 {both[0]} {both[1]}",
        f"/d KEEP_LAST 1 {both[0]} {both[1]}",
        f"/robot_1/robot_description KEEP_LAST 1 RELIABLE TRANSIENT_LOCAL AUTOMATIC {both[1]}",
        f"/rosout KEEP_LAST 1000 RELIABLE TRANSIENT_LOCAL AUTOMATIC 10000000000 {endless} {endless}",
    ]
