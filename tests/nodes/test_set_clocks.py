"""Clocks that programs set: the expected lines are what rclpy 7.1 prints for the same programs."""

from node_runs import HEAD, lines, running, script

CLOCK = """
from rclpy.clock import ClockChange, JumpThreshold, ROSClock
from rclpy.duration import Duration
from rclpy.time import Time

rclpy.init()
clock = ROSClock()
jumps = []
threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None, on_clock_change=True)
handle = clock.create_jump_callback(
    threshold,
    pre_callback=lambda: jumps.append("before"),
    post_callback=lambda jump: jumps.append((ClockChange(int(jump.clock_change)).name, jump.delta.nanoseconds)),
)
clock.set_ros_time_override(Time(seconds=5))
print(clock.ros_time_is_active, clock.now().nanoseconds == 5 * 10**9, jumps)
clock._set_ros_time_is_active(True)
print(clock.ros_time_is_active, clock.now(), len(jumps), jumps[1][0])
jumps.clear()
for seconds in (5.5, 6.0, 7.5, 1.0, 1.5):
    clock.set_ros_time_override(Time(seconds=seconds))
print(jumps)
handle.unregister()
for bad in ((None, None), (1, None), (None, 1)):
    try:
        clock.create_jump_callback(threshold, pre_callback=bad[0], post_callback=bad[1])
    except ValueError as error:
        print(error)
try:
    clock.set_ros_time_override(5)
except TypeError as error:
    print(error)
"""

SOURCE = """
import threading
import time

from rclpy.clock import ROSClock
from rclpy.duration import Duration
from rclpy.time import Time
from rclpy.time_source import TimeSource
from rosgraph_msgs.msg import Clock

rclpy.init()
node = Node("my")
clock, source = ROSClock(), TimeSource()
source.attach_clock(clock)
source.ros_time_is_active = True
print(clock.now().nanoseconds)
message = Clock()
message.clock.sec = 12
source.clock_callback(message)
print(clock.now())
slept = []
thread = threading.Thread(target=lambda: slept.append(clock.sleep_for(Duration(seconds=3))))
thread.start()
time.sleep(0.1)
print(slept)
message.clock.sec = 15
source.clock_callback(message)
thread.join()
print(slept)
thread = threading.Thread(target=lambda: slept.append(clock.sleep_for(Duration(seconds=3))))
thread.start()
time.sleep(0.1)
source.ros_time_is_active = False
thread.join()
print(slept, clock.ros_time_is_active)
"""


def printed(folder, capsys, text):
    with running(script(folder, "my.py", HEAD + text)) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    return lines(capsys)


def test_jumps_of_a_clock_that_is_set(tmp_path, capsys):
    assert printed(tmp_path, capsys, CLOCK) == [
        "False False []",
        "True Time(nanoseconds=5000000000, clock_type=ROS_TIME) 2 ROS_TIME_ACTIVATED",
        "['before', ('ROS_TIME_NO_CHANGE', 1500000000)]",
        "One of pre_callback or post_callback must be callable",
        "pre_callback must be callable if given",
        "One of pre_callback or post_callback must be callable",
        "Time must be specified as rclpy.time.Time. Received type: <class 'int'>",
    ]


def test_a_source_sets_the_clocks_that_are_attached(tmp_path, capsys):
    assert printed(tmp_path, capsys, SOURCE) == [
        "0",
        "Time(nanoseconds=12000000000, clock_type=ROS_TIME)",
        "[]",
        "[True]",
        "[True, False] False",
    ]
