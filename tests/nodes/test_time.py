"""Time as nodes see it: simulated, one step boundary at a time."""

import pytest
from node_runs import HEAD, lines, running, script


def test_timers_keep_to_their_grid(tmp_path, capsys):
    file = script(
        tmp_path,
        "timers.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("timers")
        self.create_timer(0.1, lambda: print("slow", self.get_clock().now().nanoseconds))
        self.create_timer(0.05, lambda: print("fast", self.get_clock().now().nanoseconds))
""",
    )
    with running(file) as twin:
        twin.advance_to(0.16)
    assert lines(capsys) == ["fast 50000000", "slow 100000000", "fast 100000000", "fast 150000000"]


def test_a_timer_that_is_reset_counts_a_whole_period_from_there(tmp_path, capsys):
    """Also one that was canceled. As rcl_timer_reset: the next call is a period after the reset."""
    file = script(
        tmp_path,
        "timers.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("timers")
        self.slow = self.create_timer(0.1, lambda: print("slow", self.get_clock().now().nanoseconds))
        self.quick = self.create_timer(0.06, self.tick)

    def tick(self):
        print(self.slow.is_canceled(), self.slow.time_until_next_call())
        if self.get_clock().now().nanoseconds == 60_000_000:
            self.slow.reset()
        elif self.get_clock().now().nanoseconds == 180_000_000:
            self.slow.cancel()
        elif self.get_clock().now().nanoseconds == 240_000_000:
            self.slow.reset()
            self.quick.cancel()
""",
    )
    with running(file) as twin:
        twin.advance_to(0.45)
    assert lines(capsys) == [
        "False 40000000",
        "False 40000000",
        *("slow 160000000", "False 80000000"),
        "True None",
        *("slow 340000000", "slow 440000000"),
    ]


def test_a_period_that_is_no_multiple_of_the_step_keeps_its_mean(tmp_path, capsys):
    file = script(
        tmp_path,
        "timer.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("timer")
        self.count = 0
        self.create_timer(1 / 300, self.tick)

    def tick(self):
        self.count += 1
        if self.count == 300:
            print(self.get_clock().now().nanoseconds)
""",
    )
    with running(file) as twin:
        twin.advance_to(1.1)
    (time,) = map(int, lines(capsys))
    assert time == pytest.approx(1e9, abs=1.1e6)  # the first step that is not before it


def test_a_period_below_the_step_fires_once_a_step(tmp_path, capsys):
    file = script(
        tmp_path,
        "timer.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("timer")
        self.create_timer(0.0, lambda: print(self.get_clock().now().nanoseconds))
""",
    )
    with running(file) as twin:
        twin.advance_to(0.004)
    assert lines(capsys) == ["1000000", "2000000", "3000000"]


def test_sleep_and_clocks_are_simulated(tmp_path, capsys):
    file = script(
        tmp_path,
        "sleeper.py",
        HEAD
        + """
import datetime
import threading
import time
from datetime import datetime as DateTime
from time import sleep

rclpy.init()
node = rclpy.create_node("sleeper")
sleep(1.5)
print(time.time(), time.monotonic(), time.time_ns(), node.get_clock().now().nanoseconds)
print(DateTime.now().timestamp(), datetime.datetime.now().timestamp(), isinstance(DateTime.now(), DateTime))
node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.25))
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
rate = node.create_rate(10)
rate.sleep()
print(round(time.time(), 6))
""",
    )
    with running(file) as twin:
        twin.advance_to(2.0)
    assert lines(capsys) == ["1.5 1.5 1500000000 1500000000", "1.5 1.5 True", "1.85"]


def test_compiled_modules_get_the_real_class_of_dates(tmp_path, capsys):
    """What is compiled against Python's own class, as pandas is, derives from it in C: a subclass ends the process."""
    file = script(
        tmp_path,
        "dates.py",
        """
import datetime
import importlib._bootstrap
import pickle

get = importlib._bootstrap._call_with_frames_removed  # whose frame a compiled module sees at its import
real = get(getattr, datetime, "datetime")
made = datetime.datetime(2020, 1, 2, hour=3)
print(real is not datetime.datetime, real.__basicsize__ == datetime.datetime.__basicsize__)
print(isinstance(made, real), type(made) is type(datetime.datetime.now()) is datetime.datetime)
print(pickle.loads(pickle.dumps(datetime.datetime.now())), repr(made), hasattr(datetime, "unknown"))
""",
    )
    with running(file) as twin:
        twin.advance_to(0.01)
    assert lines(capsys) == [
        "True True",
        "True True",
        "1970-01-01 00:00:00 datetime.datetime(2020, 1, 2, 3, 0) False",
    ]


def test_other_threads_see_the_real_time(tmp_path):
    import datetime
    import time

    file = script(tmp_path, "sleeper.py", "import time\ntime.sleep(5.0)\n")
    real = time.time.__name__, datetime.datetime
    with running(file) as twin:
        twin.advance_to(0.1)
        assert time.time() > 1e9
        assert datetime.datetime is real[1]
        time.sleep(0.0)
    assert time.time.__module__ == "time"


@pytest.mark.parametrize(
    "loop",
    [
        "while time.time() < 0.5:\n    pass",
        "start = node.get_clock().now()\nwhile node.get_clock().now() - start < Duration(seconds=0.5):\n    pass",
        "while rclpy.ok() and time.time() < 0.5:\n    rclpy.spin_once(node, timeout_sec=0)",
    ],
)
def test_a_loop_until_a_time_ends(tmp_path, capsys, loop):
    text = f"{HEAD}\nimport time\nfrom rclpy.duration import Duration\nrclpy.init()\nnode = rclpy.create_node('busy')\n"
    with running(script(tmp_path, "busy.py", f"{text}{loop}\nprint('done', time.time())\n")) as twin:
        twin.advance_to(0.6)
    assert lines(capsys) == ["done 0.5"]


def test_nodes_have_their_turns_in_the_order_of_their_start(tmp_path, capsys):
    text = """
import sys


class My(Node):
    def __init__(self):
        super().__init__("node_" + sys.argv[1])
        self.create_timer(0.1, lambda: print(sys.argv[1]))
"""
    file = script(tmp_path, "named.py", text)
    from conftest import rovers

    builder = rovers(1)
    for name in ("b", "a", "c"):
        builder.node(file, name)
    with builder.build() as twin:
        twin.advance_to(0.25)
    assert lines(capsys) == ["b", "a", "c"] * 2


def test_a_reset_lets_time_jump_back(tmp_path, capsys):
    file = script(
        tmp_path,
        "timer.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("timer")
        self.create_timer(0.2, lambda: print(self.get_clock().now().nanoseconds))
""",
    )
    sleeper = script(tmp_path, "sleeper.py", "import time\ntime.sleep(0.5)\nprint('awake', time.time())\n")
    with running(file, sleeper) as twin:
        twin.advance_to(0.3)
        twin.reset()
        twin.advance_to(0.45)
    # The timer counts from the reset on; the sleeper has 0.2 s left.
    assert lines(capsys) == ["200000000", "200000000", "awake 0.2", "400000000"]


def test_a_node_can_start_later(tmp_path, capsys):
    file = script(tmp_path, "late.py", "import time\nprint(time.time())\n")
    with running((file, {"time": 0.25})) as twin:
        twin.advance_to(0.2)
        assert lines(capsys) == []
        twin.advance_to(0.3)
    assert lines(capsys) == ["0.25"]


def test_random_numbers_are_the_same_in_each_run(tmp_path, capsys):
    file = script(tmp_path, "dice.py", "import random\nprint(random.random())\n")
    for _ in range(2):
        with running(file, file) as twin:
            twin.advance_to(0.01)
    first, second, *again = lines(capsys)
    assert first != second
    assert again == [first, second]
