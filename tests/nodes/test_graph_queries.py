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
        f"[('/a/talk', ['{kind}']), ('/kept', ['{kind}'])]",
        f"[('/a/talk', ['{kind}'])]",
        "[('/a/go', ['std_srvs/srv/Trigger'])] 1 0",
        "4 True True",
        "30 1",
    ]
