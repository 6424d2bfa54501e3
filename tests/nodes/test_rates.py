"""Rates: the expected lines are what rclpy 7.1 prints for the same program."""

from node_runs import HEAD, lines, running, script

RATES = """
import threading
import time

from rclpy.exceptions import ROSInterruptException
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
node = Node("my")
executor = SingleThreadedExecutor()
executor.add_node(node)
slept = []


def sleep(rate, name):
    try:
        rate.sleep()
        slept.append(name)
    except (RuntimeError, ROSInterruptException) as error:
        slept.append(type(error).__name__)


def started(rate, name):
    thread = threading.Thread(target=sleep, args=(rate, name))
    thread.start()
    time.sleep(0.1)
    return thread


rate = node.create_rate(20)
thread = started(rate, "spun")
print(slept, len(list(node.timers)))
while not slept:
    executor.spin_once()
print(slept)
slow = node.create_rate(0.01)
thread = started(slow, "destroyed")
print(node.destroy_rate(slow))
thread.join()
print(slept, len(list(node.timers)))
sleep(slow, "again")
print(slept)
rest = node.create_rate(0.01)
thread = started(rest, "shut down")
rclpy.shutdown()
thread.join()
print(slept)
sleep(rest, "after")
print(slept)
"""


def test_a_rate_sleeps_while_a_thread_spins(tmp_path, capsys):
    with running(script(tmp_path, "my.py", HEAD + RATES)) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == [
        "[] 1",
        "['spun']",
        "True",
        "['spun', 'destroyed'] 1",
        "['spun', 'destroyed', 'RuntimeError']",
        "['spun', 'destroyed', 'RuntimeError', 'ROSInterruptException']",
        "['spun', 'destroyed', 'RuntimeError', 'ROSInterruptException', 'ROSInterruptException']",
    ]
