"""tf2_ros in node programs beside a twin, in simulated time."""

from node_runs import HEAD, lines, running, script
from node_scripts import run_script

START = """
import rclpy
from geometry_msgs.msg import PointStamped, PoseStamped, Quaternion, TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener
import tf2_ros

def stamped(parent, child, stamp, x=2.0):
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id = parent
    made.header.stamp = stamp
    made.transform.translation.x = x
    return made

rclpy.init()
node = Node("frames")
"""


def test_lookups_to_wait_for(tmp_path, capsys):
    """tf2_ros_py/test/test_buffer.py:68-132 (geometry2, jazzy)."""
    text = """
buffer = Buffer()
now = Time(seconds=3)
made = stamped("foo", "bar", now.to_msg())

def end(coroutine):
    try:
        coroutine.send(None)
    except StopIteration as stop:
        assert stop.value == made
        return
    raise AssertionError("it still waits")

for delayed in (False, True):
    for start in (
        lambda: buffer.lookup_transform_async("foo", "bar", now),
        lambda: buffer.lookup_transform_full_async("foo", now, "bar", now, "foo"),
    ):
        buffer.clear()
        if not delayed:
            buffer.set_transform(made, "test")
        coroutine = start()
        if delayed:
            coroutine.send(None)
            buffer.set_transform(made, "test")
        end(coroutine)
assert buffer._new_data_callbacks == []
future = buffer.wait_for_transform_async("foo", "bar", Time(seconds=4))
assert not future.done()
buffer.set_transform(stamped("foo", "bar", Time(seconds=5).to_msg()), "test")
assert future.done() and future.result().header.stamp.sec == 4
print("all is well")
"""
    assert run_script(tmp_path, START + text, 0.1) == ""
    assert "all is well" in capsys.readouterr().out


def test_what_is_broadcast_is_heard(tmp_path, capsys):
    """A lookup in a callback waits in simulated time: for ever less than its time-out, as the listener has a thread."""
    text = """
buffer = Buffer(node=node)
# A node is in one executor only, the last one: with this node, the thread would have nothing to spin any more.
listener = TransformListener(buffer, Node("listener"), spin_thread=True)
broadcaster, static = TransformBroadcaster(node), StaticTransformBroadcaster(node)
static.sendTransform(stamped("tool", "tip", Time().to_msg(), 1.0))

def tick():
    begin = node.get_clock().now()
    broadcaster.sendTransform([stamped("made_up", "tool", begin.to_msg(), 3.0)])
    found = buffer.lookup_transform("made_up", "tip", begin, timeout=Duration(seconds=0.5))
    assert found.transform.translation.x == 4.0
    assert Time.from_msg(found.header.stamp) == begin
    waited = node.get_clock().now() - begin
    assert waited < Duration(seconds=0.02), waited
    assert buffer.can_transform("robot_1_base_link", "robot_1_front_left_wheel", Time())  # the twin's own
    print("found after", waited.nanoseconds)
    timer.cancel()

timer = node.create_timer(0.1, tick)
rclpy.spin(node)
"""
    assert run_script(tmp_path, START + text) == ""
    assert "found after" in capsys.readouterr().out


def test_a_time_out_is_of_simulated_time(tmp_path, capsys):
    text = """
buffer = Buffer()
for timeout in (0.25, 0.0):
    begin = node.get_clock().now()
    try:
        buffer.lookup_transform("made_up", "tool", Time(), timeout=Duration(seconds=timeout))
    except tf2_ros.LookupException as error:
        print((node.get_clock().now() - begin).nanoseconds, error)
can, why = buffer.can_transform("made_up", "tool", Time(), Duration(seconds=0.1), return_debug_tuple=True)
print(can, why)
"""
    assert run_script(tmp_path, START + text) == ""
    lines = capsys.readouterr().out.splitlines()
    absent = '"made_up" passed to lookupTransform argument target_frame does not exist. '
    assert f"250000000 {absent}" in lines
    assert f"0 {absent}" in lines
    assert '0 Invalid frame ID "made_up" passed to canTransform argument target_frame - frame does not exist' in lines


def test_data_is_transformed(tmp_path, capsys):
    """tf2_geometry_msgs/test/test_tf2_geometry_msgs.py:40-82 (geometry2, jazzy), and a type that nobody transforms."""
    text = """
buffer = Buffer()
made = stamped("a", "b", Time(seconds=2).to_msg(), 1.0)
made.transform.rotation = Quaternion(x=1.0, w=0.0)
buffer.set_transform(made, "test")
point = PointStamped()
point.header.stamp, point.header.frame_id = Time(seconds=2).to_msg(), "a"
point.point.x, point.point.y, point.point.z = 1.0, 2.0, 3.0
try:
    buffer.transform(made, "b")
except tf2_ros.TypeException as error:
    assert "is not loaded or supported" in str(error)
else:
    raise AssertionError("nobody transforms transforms")
import tf2_geometry_msgs
out = buffer.transform(point, "b", new_type=PointStamped)
assert (out.point.x, out.point.y, out.point.z) == (0.0, -2.0, -3.0)
assert (out.header.frame_id, out.header.stamp.sec) == ("b", 2)
pose = PoseStamped()
pose.header = point.header
pose.pose.position = point.point
pose.pose.orientation = Quaternion(x=1.0, w=0.0)
out = buffer.transform(pose, "b")
assert (out.pose.position.x, out.pose.position.y, out.pose.position.z) == (0.0, -2.0, -3.0)
assert abs(out.pose.orientation.w) == 1.0
out = buffer.transform_full(point, "b", Time(seconds=2), "a")
assert out.point.y == -2.0
print("all is well")
"""
    assert run_script(tmp_path, START + text, 0.1) == ""
    assert "all is well" in capsys.readouterr().out


def test_the_service_of_a_buffer(tmp_path, capsys):
    text = """
from tf2_msgs.srv import FrameGraph
buffer = Buffer(node=node)
buffer.set_transform_static(stamped("made_up", "tool", Time().to_msg()), "test")
client = node.create_client(FrameGraph, "tf2_frames")
assert client.wait_for_service(timeout_sec=0.2)
future = client.call_async(FrameGraph.Request())
rclpy.spin_until_future_complete(node, future)
print(future.result().frame_yaml.splitlines()[1])
"""
    assert run_script(tmp_path, START + text) == ""
    assert "  parent: 'made_up'" in capsys.readouterr().out.splitlines()


def test_static_transforms_reach_late_listeners(tmp_path, capsys):
    text = """
static = StaticTransformBroadcaster(node)
static.sendTransform(stamped("w1", "one", Time().to_msg()))
static.sendTransform([stamped("w1", "two", Time().to_msg()), stamped("w1", "one", Time().to_msg(), 9.0)])
buffer = Buffer()
listener = TransformListener(buffer, node)
while not buffer.can_transform("one", "two", Time()):
    rclpy.spin_once(node)
print(buffer.lookup_transform("w1", "one", Time()).transform.translation.x)
listener.unregister()
"""
    assert run_script(tmp_path, START + text) == ""
    assert "2.0" in capsys.readouterr().out.splitlines()


def test_a_listener_that_ends_hears_nothing_and_leaves_no_thread(tmp_path, capsys):
    text = """
import threading

for spin_thread in (False, True):
    before = threading.active_count()
    listener = TransformListener(Buffer(), node, spin_thread=spin_thread)
    print(len(list(node.subscriptions)), threading.active_count() - before)
    listener.__del__()
    print(len(list(node.subscriptions)), threading.active_count() - before)
"""
    assert run_script(tmp_path, START + text) == ""
    assert capsys.readouterr().out.splitlines() == ["2 0", "0 0", "2 1", "0 0"]


def test_its_modules_export_what_they_import(tmp_path, capsys):
    """tf2_ros/__init__.py has star imports of modules without __all__."""
    text = """
import geometry_msgs.msg, rclpy.duration, tf2_ros
from tf2_ros import Duration, TransformBroadcaster, TransformStamped
print(TransformStamped is geometry_msgs.msg.TransformStamped, Duration is rclpy.duration.Duration)
print(hasattr(tf2_ros, "Transforms"))
from tf2_geometry_msgs import PoseStamped
print(PoseStamped is geometry_msgs.msg.PoseStamped)
"""
    with running(script(tmp_path, "a.py", text)) as twin:
        twin.advance_to(0.1)
        assert twin.more_findings == []
    assert lines(capsys) == ["True True", "False", "True"]


SPINS = """
import threading
from geometry_msgs.msg import TransformStamped
from tf2_ros import Buffer, TransformBroadcaster, TransformListener

rclpy.init()
other, node = Node("other"), Node("my")
broadcaster, buffer = TransformBroadcaster(other), Buffer()
listener = TransformListener(buffer, node, spin_thread=True)
pause = lambda: other.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.3))


def told():
    sent = TransformStamped(child_frame_id="base")
    sent.header.frame_id, sent.transform.rotation.w = "map", 1.0
    broadcaster.sendTransform(sent)
    pause()
    return bool(buffer.can_transform("map", "base", rclpy.time.Time()))


where = []
node.create_timer(0.1, lambda: where.append(threading.current_thread() is threading.main_thread()))
print(told(), where[-1], len(listener.executor.get_nodes()))
where.clear()
rclpy.spin_once(node, timeout_sec=1.0)
print(where, node.executor is listener.executor, listener.executor.get_nodes())
buffer.clear()
print(told())
soon = Node("soon")
late = TransformListener(Buffer(), soon, spin_thread=True)
future = rclpy.Future()
soon.create_timer(0.1, lambda: future.set_result(threading.current_thread() is threading.main_thread()))
rclpy.spin_until_future_complete(soon, future)
print(future.result(), late.executor.get_nodes())
"""


def test_a_listener_that_spins_its_node_and_another_spin_of_it(tmp_path, capsys):
    """What rclpy 7.1 prints: a spin takes the node from the listener's thread, which hears nothing from then on."""
    with running(script(tmp_path, "my.py", HEAD + SPINS)) as twin:
        twin.advance_to(2.0)
    assert lines(capsys) == ["True False 1", "[True] False []", "False", "True []"]
