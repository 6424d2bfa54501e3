"""When a publisher that asserts itself is lost: as recorded of rclpy 7.1 with rmw_cyclonedds_cpp, to 0.1 s."""

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
def test_the_lease_begins_with_the_publisher(joins, publishes, told, tmp_path, capsys):
    file = script(tmp_path, "alive.py", TEXT.format(joins=joins, publishes=publishes))
    with running(file) as twin:
        twin.advance_to(1.3)
    assert sorted(lines(capsys)) == sorted(told)
