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
        "Failed to trigger lifecycle state machine transition 4 from inactive",
        "['active']",
        "True False",
        "True False",
    ]


SERVED = """
import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.lifecycle import LifecycleNode
rclpy.init()
asker = rclpy.create_node("asker")

def ask(service, kind, request):
    client = asker.create_client(kind, service)
    client.wait_for_service()
    future = client.call_async(request)
    while not future.done():
        rclpy.spin_once(asker, timeout_sec=0.01)
        rclpy.spin_once(node, timeout_sec=0.01)
    return future.result()

transitions = {"a": (5,), "b": (1, 6), "c": (1, 3, 7), "d": (1, 3, 4, 2), "e": ("activate", "no such")}
for name, numbers in transitions.items():
    node = LifecycleNode(name)
    done = []
    for number in numbers:
        label = number if isinstance(number, str) else ""
        request = ChangeState.Request(transition=Transition(id=0 if label else number, label=label))
        done.append(ask(f"/{name}/change_state", ChangeState, request).success)
    state = ask(f"/{name}/get_state", GetState, GetState.Request()).current_state
    print(name, done, state.id, state.label)
"""


def test_transitions_are_asked_for_by_their_numbers(tmp_path, capsys):
    """Those of lifecycle_msgs/msg/Transition: three ways to shut down; a name that none has there fails."""
    with running(script(tmp_path, "my.py", SERVED)) as twin:
        twin.advance_to(2.0)
        assert twin.findings == ()
    assert lines(capsys) == [
        "a [True] 4 finalized",
        "b [True, True] 4 finalized",
        "c [True, True, True] 4 finalized",
        "d [True, True, True, True] 1 unconfigured",
        "e [False, False] 1 unconfigured",
    ]
