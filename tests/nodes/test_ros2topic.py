"""``ros2topic.api`` in nodes: topics of the graph by name, profiles by words."""

from node_scripts import run_script

PROGRAM = """
import threading
import rclpy
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from ros2cli.node.strategy import NodeStrategy
from ros2topic.api import get_msg_class, get_topic_names, get_topic_names_and_types, qos_profile_from_short_keys
from std_msgs.msg import Bool, String

rclpy.init()
node = rclpy.create_node("looks", namespace="arm")
own = [node.create_publisher(String, "words", 1), node.create_publisher(Bool, "_hidden", 1)]
names = get_topic_names(node=node)
print("/arm/words" in names, "/arm/_hidden" in names)
print("/arm/_hidden" in get_topic_names(node=node, include_hidden_topics=True))
print(dict(get_topic_names_and_types(node=node))["/arm/words"])
print(get_msg_class(node, "words") is String, get_msg_class(node, "/nowhere"))
threading.Timer(0.25, lambda: own.append(node.create_publisher(Bool, "late", 1))).start()
print(get_msg_class(node, "late", blocking=True) is Bool)
own.append(node.create_publisher(Bool, "words", 1))
for wrong in ("words", "?"):
    try:
        get_msg_class(node, wrong)
    except RuntimeError:
        print("error")
profile = qos_profile_from_short_keys("sensor_data", reliability="reliable", depth=7)
print(profile.reliability == ReliabilityPolicy.RELIABLE, profile.depth, profile.durability == DurabilityPolicy.VOLATILE)
with NodeStrategy(None) as other:
    print(other.get_name(), "/arm/words" in get_topic_names(node=other))
print("_ros2cli" in node.get_node_names())
print(qos_profile_from_short_keys("system_default", durability="transient_local").depth)
"""


def test_topics_and_profiles(tmp_path, capsys):
    assert run_script(tmp_path, PROGRAM, until=2.0) == ""
    said = [line for line in capsys.readouterr().out.splitlines() if not line.startswith("WARNING: topic [")]
    assert said == [
        "True False",
        "True",
        "['std_msgs/msg/String']",
        "True None",
        "True",
        *("error", "error"),
        "True 7 True",
        "_ros2cli True",
        "False",
        "1",
    ]
