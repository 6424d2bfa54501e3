"""What publishers and subscriptions are told of their quality of service, as recorded of rclpy 7.1 with CycloneDDS."""

import pytest
from node_runs import lines, running, script

TEXT = """
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("alive")
spans = {{"liveliness_lease_duration": Duration(seconds=0.4), "deadline": Duration(seconds=0.3)}}
profile = QoSProfile(depth=10, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, **spans)


def say(*words):
    print(round(node.get_clock().now().nanoseconds * 1e-9, 1), *words)


def changed(event):
    counts = event.alive_count, event.not_alive_count, event.alive_count_change, event.not_alive_count_change
    say("changed", *counts)


def join():
    callbacks = SubscriptionEventCallbacks(liveliness=changed, deadline=lambda event: say("late"))
    node.create_subscription(String, "t", lambda message: say("heard"), profile, event_callbacks=callbacks)


def once(time, act):
    timer = node.create_timer(time, lambda: (timer.cancel(), act()))


callbacks = PublisherEventCallbacks(liveliness=lambda event: say("lost", event.total_count))
publisher = node.create_publisher(String, "t", profile, event_callbacks=callbacks)
join() if {joins} == 0 else once({joins}, join) if {joins} else None
once({publishes}, lambda: publisher.publish(String())) if {publishes} else None
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("joins", "publishes", "told"),
    [
        (None, None, ["0.4 lost 1"]),
        (0, None, ["0.0 changed 1 0 1 0", "0.4 lost 1", "0.4 changed 0 1 -1 1"]),
        (1.0, None, ["0.4 lost 1", "1.0 changed 0 1 0 1"]),
        (
            0,
            0.6,
            [
                *("0.0 changed 1 0 1 0", "0.4 lost 1", "0.4 changed 0 1 -1 1", "0.6 changed 1 0 1 -1", "0.6 heard"),
                *("0.9 late", "1.0 lost 2", "1.0 changed 0 1 -1 1", "1.2 late"),
            ],
        ),
    ],
)
def test_the_lease_of_one_that_asserts_itself_begins_with_the_publisher(joins, publishes, told, tmp_path, capsys):
    file = script(tmp_path, "alive.py", TEXT.format(joins=joins, publishes=publishes))
    with running(file) as twin:
        twin.advance_to(1.3)
    assert sorted(lines(capsys)) == sorted(told)


def test_the_warning_of_settings_that_do_not_fit_is_a_spin(tmp_path, capfd):
    """As talker_qos of demo_nodes_py: of four spins one warns, so that three messages are published."""
    text = """
import rclpy
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import String

rclpy.init()
node, other = rclpy.create_node("talker"), rclpy.create_node("listener")
publisher = node.create_publisher(String, "t", QoSProfile(depth=1, reliability=QoSReliabilityPolicy.BEST_EFFORT))
node.create_timer(0.1, lambda: print("published"))
print(len(publisher.event_handlers))
count = len(list(node.waitables))
subscription = other.create_subscription(String, "t", print, 10)
for _ in range(4):
    rclpy.spin_once(node)
print(len(publisher.event_handlers))
node.destroy_publisher(publisher)
print(len(list(node.waitables)) - count)
"""
    with running(script(tmp_path, "talker.py", text)) as twin:
        twin.advance_to(1.0)
    said = capfd.readouterr()
    assert said.out.split() == ["0", "published", "published", "published", "1", "0"]
    assert "[talker]: New subscription discovered on topic 't', requesting incompatible QoS" in said.err
    assert "[listener]" not in said.err  # it does not spin
