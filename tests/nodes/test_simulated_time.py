"""Python's own time in node programs: it passes with the simulation, also while threads wait for each other."""

import io
import sys

import pytest
from node_runs import lines, running, script

START = """
import threading, time
began = time.monotonic()

def passed():
    return round(time.monotonic() - began, 6)
"""


def ran(tmp_path, capsys, text, seconds=3.0):
    with running(script(tmp_path, "my.py", START + text)) as twin:
        twin.advance_to(seconds)
    return lines(capsys)


def test_each_clock_is_the_simulations(tmp_path, capsys):
    text = "time.sleep(0.25)\nfor name in ('time', 'monotonic', 'perf_counter'):\n"
    text += "    print(round(getattr(time, name)(), 6), getattr(time, name + '_ns')())\n"
    text += "print(time.gmtime()[:6], time.strftime('%Y', time.gmtime(0)))"
    found = ran(tmp_path, capsys, text)
    assert found[:3] == ["0.25 250000000"] * 3
    assert found[3] == "(1970, 1, 1, 0, 0, 0) 1970"


def test_a_sleep_takes_simulation_time(tmp_path, capsys):
    assert ran(tmp_path, capsys, "time.sleep(0.3)\nprint(passed())\ntime.sleep(1.2)\nprint(passed())") == ["0.3", "1.5"]


def test_clocks_and_locks_may_be_attributes_of_a_class(tmp_path, capsys):
    """Python's are no functions of its own, which would become methods."""
    text = """
import threading, time

class Mine:
    now, wait, lock_class = time.monotonic, time.sleep, threading.Lock

mine = Mine()
mine.wait(0.5)
with mine.lock_class():
    print(f"{mine.now():.2f}", time.sleep.__name__)
"""
    with running(script(tmp_path, "a.py", text)) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == ["0.50 sleep"]


@pytest.mark.parametrize(
    ("timeout", "expected"), [("", ["worked 0.7", "joined 0.7 False"]), ("0.2", ["joined 0.2 True", "worked 0.7"])]
)
def test_who_joins_a_thread_waits_in_simulation_time(tmp_path, capsys, timeout, expected):
    text = f"""
def work():
    time.sleep(0.7)
    print("worked", passed())

thread = threading.Thread(target=work)
thread.start()
thread.join({timeout})
print("joined", passed(), thread.is_alive())
"""
    assert ran(tmp_path, capsys, text) == expected


def test_locks_events_and_conditions_wait_in_simulation_time(tmp_path, capsys):
    text = """
event, lock = threading.Event(), threading.Lock()
lock.acquire()

def later():
    time.sleep(0.4)
    event.set()
    time.sleep(0.4)
    lock.release()

threading.Thread(target=later).start()
print(event.wait(0.1), passed())
print(event.wait(5.0), passed())
print(lock.acquire(timeout=0.1), passed())
print(lock.acquire(timeout=5.0), passed())
"""
    assert ran(tmp_path, capsys, text) == ["False 0.1", "True 0.4", "False 0.5", "True 0.8"]


@pytest.mark.parametrize(("real", "read"), [(io.StringIO("hello\n"), "'hello\\n'"), (None, "no input")])
def test_standard_input_is_the_nodes_while_they_run_if_the_process_has_one(tmp_path, capsys, monkeypatch, real, read):
    monkeypatch.setattr(sys, "stdin", real)
    text = "import sys\nprint('no input' if sys.stdin is None else repr(sys.stdin.readline()))\n"
    text += "print(type(sys.stdin).__name__)"
    assert ran(tmp_path, capsys, text) == [read, "NoneType" if real is None else "StandardInput"]
    assert sys.stdin is real
