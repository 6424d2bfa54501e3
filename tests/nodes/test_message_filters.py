"""Messages of the same time, or about the same, are handed on together, as upstream's tests assert it.

Files cited are those of ros2/message_filters (branch jazzy).
"""

import random
from types import SimpleNamespace

import pytest
from node_scripts import run_script

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.message_filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, TimeSynchronizer
from drake_twin.nodes.rclpy.time import Time

TimeMessage = message_class("builtin_interfaces/msg/Time")


def message(stamp, data=0.0):
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), data=data)


def synchronized(kind, *arguments):
    """Two filters, and what their synchronizer hands on."""
    first, second, found = SimpleFilter(), SimpleFilter(), []
    kind([first, second], *arguments).registerCallback(lambda *both: found.append(both))
    return first, second, found


def test_pairs_are_put_together_at_once():  # test/test_approxsync.py:66-81
    first, second, found = synchronized(ApproximateTimeSynchronizer, 1, 0.1)
    for seconds in range(10):
        one, other = message(Time(seconds=seconds)), message(Time(seconds=seconds))
        first.signalMessage(one)
        assert len(found) == seconds
        second.signalMessage(other)
        assert found[seconds] == (one, other)


@pytest.mark.parametrize("count", range(1, 10))
@pytest.mark.parametrize("kind", [TimeSynchronizer, ApproximateTimeSynchronizer])
def test_shuffled_messages(kind, count):  # test/test_approxsync.py:83-102, test/directed.py:58-75
    slop = (0.1,) if kind is ApproximateTimeSynchronizer else ()
    first, second, found = synchronized(kind, count, *slop)
    shuffle = random.Random(count)
    sequences = [[message(TimeMessage(sec=seconds)) for seconds in range(count)] for _ in range(2)]
    for each in shuffle.sample(sequences[0], count):
        first.signalMessage(each)
    assert found == []
    for each in shuffle.sample(sequences[1], count):
        second.signalMessage(each)
    assert sorted(found, key=lambda both: both[0].header.stamp.sec) == list(zip(*sequences, strict=True))


def test_the_closest_one_is_taken():
    """Of those within the slop (src/message_filters/__init__.py, ApproximateTimeSynchronizer.add)."""
    first, second, found = synchronized(ApproximateTimeSynchronizer, 10, 0.1)
    for seconds in (0.92, 0.97, 1.04):
        first.signalMessage(message(Time(seconds=seconds), seconds))
    second.signalMessage(message(Time(seconds=1.2)))
    assert found == []
    second.signalMessage(message(Time(seconds=1.0), 1.0))
    assert [both[0].data for both in found] == [0.97]
    second.signalMessage(message(Time(seconds=1.02), 1.02))
    assert [both[0].data for both in found] == [0.97, 1.04]


def test_a_queue_forgets_the_oldest():
    first, second, found = synchronized(TimeSynchronizer, 2)
    for seconds in range(3):
        first.signalMessage(message(TimeMessage(sec=seconds)))
    second.signalMessage(message(TimeMessage(sec=0)))
    assert found == []
    second.signalMessage(message(TimeMessage(sec=1)))
    assert len(found) == 1


def test_cache():  # test/test_message_filters_cache.py:70-131
    cache = Cache(SimpleFilter(), 5)
    for seconds in range(5):
        cache.add(message(Time(seconds=seconds)))
    assert len(cache.getInterval(Time(seconds=2.5), Time(seconds=3.5))) == 1
    assert len(cache.getInterval(Time(seconds=2), Time(seconds=3))) == 2
    assert len(cache.getInterval(Time(), Time(seconds=4))) == 5
    assert cache.getElemAfterTime(Time()).header.stamp == Time()
    assert cache.getElemBeforeTime(Time(seconds=3.5)).header.stamp == Time(seconds=3)
    assert cache.getLastestTime() == Time(seconds=4) == cache.getLast().header.stamp
    assert cache.getOldestTime() == Time()
    cache.add(message(Time(seconds=5)))
    assert cache.getOldestTime() == Time(seconds=1)
    assert cache.getElemAfterTime(Time(seconds=9)) is None
    assert Cache(SimpleFilter()).getLast() is None


def test_headerless_messages_are_refused(capsys):  # test/test_message_filters_cache.py:133-141
    cache = Cache(SimpleFilter(), 5)
    cache.add(message_class("std_msgs/msg/String")())
    assert cache.getOldestTime() is None
    assert "without timestamp" in "".join(capsys.readouterr())


def test_in_a_node(tmp_path, capsys):
    """Two topics of the twin by `Subscriber`; headerless messages get the present time (test_approxsync.py:106-125)."""
    text = """
import rclpy
from message_filters import ApproximateTimeSynchronizer, Cache, Subscriber
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import String
rclpy.init()
node = Node("both")
states = Subscriber(node, JointState, "/robot_1/joint_states")
own = Subscriber(node, String, "/own", qos_profile=3)
assert (states.getTopic(), states.topic_name) == ("/robot_1/joint_states", "/robot_1/joint_states")
cache = Cache(own, 2, allow_headerless=True)
both = ApproximateTimeSynchronizer([states, own], 10, 0.05, allow_headerless=True)

def together(state, text):
    print("together", text.data, abs(state.header.stamp.sec + 1e-9 * state.header.stamp.nanosec - text_time) < 0.05)

both.registerCallback(together)
publisher = node.create_publisher(String, "/own", 3)

def tick():
    global text_time
    text_time = node.get_clock().now().nanoseconds * 1e-9
    publisher.publish(String(data="x"))

node.create_timer(0.1, tick)
rclpy.spin(node)
"""
    assert run_script(tmp_path, text) == ""
    assert capsys.readouterr().out.splitlines().count("together x True") >= 3
