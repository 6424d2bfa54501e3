"""Nodes with threads, locks and executors of their own."""

import os
import sys
import threading

from conftest import rovers
from node_runs import HEAD, lines, running, script

from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario.node_program import NodeProgram


def test_a_thread_that_spins(tmp_path, capsys):
    file = script(
        tmp_path,
        "threads.py",
        HEAD
        + """
import threading

rclpy.init()
node = rclpy.create_node("threads")
heard = threading.Event()
publisher = node.create_publisher(String, "chatter", 10)
node.create_subscription(String, "chatter", lambda message: heard.set(), 10)
thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
thread.start()
publisher.publish(String(data="x"))
heard.wait()
print("heard", node.get_clock().now().nanoseconds)
print(heard.wait(timeout=1.0), threading.Event().wait(timeout=0.1), node.get_clock().now().nanoseconds)
rclpy.shutdown()
thread.join()
print("joined")
""",
    )
    with running(file) as twin:
        twin.advance_to(0.2)
    assert lines(capsys) == ["heard 1000000", "True False 101000000", "joined"]


def test_threads_go_on_after_the_main_one_unless_they_are_daemons(tmp_path, capsys):
    file = script(
        tmp_path,
        "threads.py",
        """
import threading
import time


def late(name, delay):
    time.sleep(delay)
    print(name, threading.current_thread().daemon, round(time.time(), 3))
    threading.Timer(0.1, print, ("timer of", name)).start()


threading.Timer(0.1, late, ("timer", 0.05)).start()
threading.Thread(target=late, args=("thread", 0.2)).start()
threading.Thread(target=late, args=("daemon", 0.4), daemon=True).start()
print(threading.current_thread().daemon)
""",
    )
    main = sys.modules["__main__"]
    with running(file) as twin:
        twin.advance_to(0.5)
        assert twin.findings == ()
    assert sys.modules["__main__"] is main
    assert lines(capsys) == ["False", "timer False 0.15", "thread False 0.2", "timer of timer", "timer of thread"]


def test_a_node_spins_on_after_the_main_thread(tmp_path, capsys):
    """It stays on the graph until its last thread ends, and then does what it has registered."""
    file = script(
        tmp_path,
        "spins.py",
        HEAD
        + """
import atexit
import threading

rclpy.init()
node = rclpy.create_node("spins")
node.create_subscription(String, "chatter", lambda message: print(message.data), 10)
publisher = node.create_publisher(String, "chatter", 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="x")))
node.create_timer(0.35, rclpy.shutdown)
atexit.register(print, "exits")
threading.Thread(target=rclpy.spin, args=(node,)).start()
print("main ends")
""",
    )
    with running(file) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
        assert lines(capsys) == ["main ends", "x", "x", "x", "exits"]


def test_locks_and_queues_are_waited_for_without_the_baton(tmp_path, capsys):
    file = script(
        tmp_path,
        "locks.py",
        """
import queue
import threading
import time
from concurrent.futures import ThreadPoolExecutor

lock, items = threading.Lock(), queue.Queue()


def hold():
    with lock:
        time.sleep(0.2)
        items.put(time.time())


threads = [threading.Thread(target=hold) for _ in range(2)]
for thread in threads:
    thread.start()
print([round(items.get(), 3) for _ in threads])
with ThreadPoolExecutor(2) as pool:
    print([round(value, 3) for value in pool.map(lambda s: time.sleep(s) or time.time(), [0.3, 0.1])])
""",
    )
    with running(file) as twin:
        twin.advance_to(1.0)
    assert lines(capsys) == ["[0.2, 0.4]", "[0.7, 0.5]"]


def test_the_end_of_a_run_is_no_error_of_a_pool(tmp_path, capsys, caplog):
    """Its workers wait for work when the run ends; an error of work is the one that asks for it."""
    file = script(
        tmp_path,
        "pool.py",
        """
import rclpy
from concurrent.futures import ThreadPoolExecutor

rclpy.init()
node = rclpy.create_node("pool")
pool = ThreadPoolExecutor(2)
node.create_timer(0.1, lambda: pool.submit(print, "worked"))
rclpy.spin(node)
""",
    )
    with running(file) as twin:
        twin.advance_to(0.15)
    assert lines(capsys) == ["worked"]
    assert caplog.messages == []


SLOW = """
import time
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor

rclpy.init()
node = rclpy.create_node("slow")


def slow():
    begin = round(time.time(), 3)
    time.sleep(0.3)
    print(begin, round(time.time(), 3))


group = {group}
timers = [node.create_timer(0.1, lambda: (timers[0].cancel(), slow()), callback_group=group)]
timers.append(node.create_timer(0.2, lambda: (timers[1].cancel(), slow()), callback_group=group))
executor = {executor}()
executor.add_node(node)
executor.spin()
"""


def test_callbacks_of_a_reentrant_group_run_side_by_side(tmp_path, capsys):
    text = SLOW.format(group="ReentrantCallbackGroup()", executor="MultiThreadedExecutor")
    with running(script(tmp_path, "slow.py", HEAD + text)) as twin:
        twin.advance_to(1.0)
    assert lines(capsys) == ["0.1 0.4", "0.2 0.5"]


def test_callbacks_of_an_exclusive_group_wait_for_each_other(tmp_path, capsys):
    text = SLOW.format(group="MutuallyExclusiveCallbackGroup()", executor="MultiThreadedExecutor")
    with running(script(tmp_path, "slow.py", HEAD + text)) as twin:
        twin.advance_to(1.0)
    assert lines(capsys) == ["0.1 0.4", "0.4 0.7"]


def test_a_single_thread_calls_back_one_after_the_other(tmp_path, capsys):
    text = SLOW.format(group="ReentrantCallbackGroup()", executor="SingleThreadedExecutor")
    with running(script(tmp_path, "slow.py", HEAD + text)) as twin:
        twin.advance_to(1.0)
    assert lines(capsys) == ["0.1 0.4", "0.4 0.7"]


def test_a_callback_that_awaits(tmp_path, capsys):
    file = script(
        tmp_path,
        "awaits.py",
        """
from rclpy.callback_groups import ReentrantCallbackGroup
from std_srvs.srv import Trigger


class My(Node):
    def __init__(self):
        super().__init__("awaits")
        self.create_service(Trigger, "answer", self.answer, callback_group=ReentrantCallbackGroup())
        self.client = self.create_client(Trigger, "answer", callback_group=ReentrantCallbackGroup())
        self.timer = self.create_timer(0.1, self.ask)

    def answer(self, request, response):
        response.message = "42"
        return response

    async def ask(self):
        self.timer.cancel()
        response = await self.client.call_async(Trigger.Request())
        print(response.message)
""",
    )
    with running(file) as twin:
        twin.advance_to(0.2)
    assert lines(capsys) == ["42"]


def test_two_twins_in_two_threads_do_not_see_each_others_programs(tmp_path, capsys):
    """Each turn reads a file with the baton, so that turns of the other twin could come in between."""
    node = """
import os, sys, time

own = sys.argv[1]
for _ in range(300):
    os.stat(__file__)
    seen = sys.argv[1], os.environ["WHO"], sys.modules["__main__"].__file__
    assert seen == (own, own, __file__), seen
    time.sleep(0.001)
print(own, "has seen itself")
"""
    before = sys.argv, sys.path, os.environ, sys.modules["__main__"]

    def run(name):
        file = script(tmp_path, f"{name}.py", node)
        item = NodeProgram(str(file), arguments=(name,), environment={"WHO": name})
        with rovers(1).build() as twin:
            nodes = Nodes(twin, [item])
            twin.advance_to(0.4)
            nodes.close()

    threads = [threading.Thread(target=run, args=(name,)) for name in ("one", "other")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(lines(capsys)) == ["one has seen itself", "other has seen itself"]
    assert (sys.argv, sys.path, os.environ, sys.modules["__main__"]) == before
