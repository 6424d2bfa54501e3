"""Nodes with states: their publishers are silent while they are not active."""

from node_runs import lines, running, script

TEXT = """
import rclpy
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher
from std_msgs.msg import String
rclpy.init()
node = LifecycleNode("my")
heard = []
node.create_subscription(String, "/chatter", lambda message: heard.append(message.data), 10)
publisher = node.create_lifecycle_publisher(String, "/chatter", 10)
print(isinstance(publisher, LifecyclePublisher), publisher.is_activated)

def say(text):
    publisher.publish(String(data=text))
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.01)

say("unconfigured")
print(node.trigger_configure().name)
say("inactive")
print(node.trigger_activate().name)
say("active")
print(node.trigger_deactivate().name)
say("inactive again")
try:
    node.trigger_deactivate()
except RuntimeError as error:
    print(error)
print(heard)
print(node.destroy_publisher(publisher), node.destroy_publisher(publisher))
timer = node.create_timer(1.0, print)
print(node.destroy_timer(timer), node.destroy_timer(timer))
"""


def test_a_publisher_is_heard_while_its_node_is_active(tmp_path, capsys):
    with running(script(tmp_path, "my.py", TEXT)) as twin:
        twin.advance_to(0.5)
        assert twin.findings == ()
    assert lines(capsys) == [
        "True False",
        *["SUCCESS"] * 3,
        "no transition matching deactivate found for current state inactive",
        "['active']",
        "True False",
        "True False",
    ]
