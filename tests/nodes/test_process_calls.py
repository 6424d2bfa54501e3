"""What a node does to its process is done to the node only: exits, signals, forks, the working folder."""

import os
import signal
import sys

import pytest
from node_runs import HEAD, lines, running, script

WITNESS = "import os, time\nwhile True:\n    time.sleep(0.1)\n    print('here', os.path.basename(os.getcwd()))\n"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("import os\nos._exit(3)", "it has ended with exit code 3 ({file}:2)"),
        ("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)", "it has ended with exit code 143 ({file}:2)"),
        ("import signal\nsignal.alarm(1)", "OSError: a node cannot set an alarm, which would be the twin's ({file}:2)"),
        (
            "import os, threading\nthreading.Thread(target=lambda: os._exit(4)).start()\nthreading.Event().wait()",
            "it has ended with exit code 4 ({file}:2)",
        ),
    ],
)
def test_an_end_of_the_process_is_one_of_the_node(tmp_path, capsys, text, why):
    file = script(tmp_path, "f.py", text)
    with running(file, script(tmp_path, "witness.py", WITNESS)) as twin:
        twin.advance_to(0.25)
        assert [item.what for item in twin.findings] == [f"node f.py: {why.format(file=file)}"]
    assert len(lines(capsys)) == 2


def test_an_exit_at_once_does_nothing_more(tmp_path, capsys):
    text = "import atexit, os\natexit.register(print, 'a')\ntry:\n    os._exit(0)\nexcept Exception:\n    print('b')\n"
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
    assert lines(capsys) == []


def test_what_is_registered_is_done_at_the_nodes_end(tmp_path, capsys):
    text = (
        "import atexit\natexit.register(print, 'first', end='!\\n')\natexit.register(print, 'never')\n"
        "atexit.unregister(print)\natexit.register(print, 'a')\natexit.register(lambda: 1 / 0)\n"
    )
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        assert lines(capsys) == ["a"]
        (finding,) = twin.findings
        assert "ZeroDivisionError" in finding.what


def test_a_handler_of_ctrl_c_is_called_at_the_end(tmp_path, capsys):
    """It may end a loop, or the program; a program that does neither is interrupted nevertheless."""
    text = """
import signal
import sys
import time

running = True


def stop(number, frame):
    global running
    running = {running}
    print("stopped by", number)
    {more}


assert signal.signal(signal.SIGINT, stop) is signal.default_int_handler
assert signal.getsignal(signal.SIGINT) is stop
try:
    while running:
        time.sleep(0.1)
    print("cleaned up")
finally:
    print("ended")
"""
    cases = (
        {"running": False, "more": ""},
        {"running": True, "more": "raise SystemExit"},
        {"running": True, "more": ""},
    )
    files = [script(tmp_path, f"f{index}.py", text.format(**case)) for index, case in enumerate(cases)]
    before = signal.getsignal(signal.SIGINT)
    with running(*files) as twin:
        twin.advance_to(0.15)
        assert twin.findings == ()
    said = "stopped by 2"
    assert lines(capsys) == [said, "cleaned up", "ended", said, "ended", said, "ended"]
    assert signal.getsignal(signal.SIGINT) is before


def test_a_node_interrupts_itself(tmp_path, capsys):
    text = (
        "import os, signal, threading\n"
        "signal.signal(signal.SIGUSR1, lambda number, frame: print('handled', number))\n"
        "signal.raise_signal(signal.SIGUSR1)\n"
        "signal.raise_signal(signal.SIGWINCH)\n"
        "threading.Thread(target=os.kill, args=(os.getpid(), signal.SIGINT)).start()\n"
        "try:\n    threading.Event().wait()\nexcept KeyboardInterrupt:\n    print('interrupted')\n"
    )
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
        assert lines(capsys) == [f"handled {signal.SIGUSR1}", "interrupted"]


def test_the_working_folder_is_the_nodes_own(tmp_path, capsys):
    here = os.getcwd()
    mover = f"import os, time\nos.chdir({str(tmp_path)!r})\ntime.sleep(0.15)\nprint('moved', os.getcwd())\n"
    with running(script(tmp_path, "f.py", mover), script(tmp_path, "witness.py", WITNESS)) as twin:
        twin.advance_to(0.25)
        assert os.getcwd() == here
    home = os.path.basename(here)
    assert lines(capsys) == [f"here {home}", f"moved {tmp_path}", f"here {home}"]


def test_a_process_that_a_node_forks_is_a_plain_one(tmp_path, capfd):
    """It sees the real time, waits for no baton, and its end is not the twin's."""
    text = """
import multiprocessing
import os
import threading
import time


def work(queue):
    begin = time.time()
    thread = threading.Thread(target=time.sleep, args=(0.01,))
    thread.start()
    thread.join()
    queue.put(begin > 1e9)


queue = multiprocessing.get_context("fork").Queue()
process = multiprocessing.get_context("fork").Process(target=work, args=(queue,))
process.start()
print(queue.get(), flush=True)
process.join()
child = os.fork()
if child == 0:
    time.sleep(0.01)
else:
    os.waitpid(child, 0)
    print("parent", time.time(), flush=True)
"""
    with running(script(tmp_path, "f.py", text)) as twin:
        for _ in range(1000):
            twin.advance_to(twin.time + 0.01)
            if all(program.main.has_ended for program in twin_programs(twin)):
                break
        assert twin.findings == ()
    said = capfd.readouterr().out.split()
    assert said[:2] == ["True", "parent"]
    assert len(said) == 3


def twin_programs(twin):
    """The node programs of a twin."""
    return twin.alarm.call.__self__.programs


def test_an_event_loop_waits_in_simulated_time(tmp_path, capsys):
    text = """
import asyncio


async def tick(name, period):
    for _ in range(3):
        await asyncio.sleep(period)
        print(name, round(asyncio.get_running_loop().time(), 3))


async def main():
    await asyncio.gather(tick("a", 0.2), tick("b", 0.25))
    print(await asyncio.get_running_loop().run_in_executor(None, lambda: "done"))


asyncio.run(main())
"""
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == ["a 0.2", "b 0.25", "a 0.4", "b 0.5", "a 0.6", "b 0.75", "done"]


def test_an_exit_in_a_thread_of_an_executor_ends_only_the_callback(tmp_path, capfd):
    """As in ROS, whose pool of threads keeps the error to itself."""
    text = """
import sys
from rclpy.executors import MultiThreadedExecutor

rclpy.init()
node = rclpy.create_node("exits")
node.create_timer(0.1, lambda: sys.exit(4))
node.create_timer(0.1, lambda: print("alive"))
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""
    with running(script(tmp_path, "f.py", HEAD + text)) as twin:
        twin.advance_to(0.35)
    out, error = capfd.readouterr()
    assert out.splitlines() == ["alive"] * 3
    assert error.count("sys.exit(4) in a thread of an executor ends only the callback") == 3


@pytest.mark.filterwarnings("ignore:There is no current event loop:DeprecationWarning")  # of Python 3.12 and later
def test_asyncio_makes_a_loop_for_the_thread_that_a_node_begins_with(tmp_path, capsys):
    text = """
import asyncio
import threading
import time

assert threading.current_thread() is threading.main_thread()
loop = asyncio.new_event_loop() if {new} else asyncio.get_event_loop()
loop.run_until_complete(asyncio.sleep(0.1))
print(round(time.time(), 3))
"""
    new = sys.version_info >= (3, 14)  # which makes none
    with running(script(tmp_path, "f.py", text.replace("{new}", str(new)))) as twin:
        twin.advance_to(0.15)
        assert twin.findings == ()
    assert lines(capsys) == ["0.1"]


def test_asyncio_hears_the_signals_of_its_node(tmp_path, capsys):
    text = """
import asyncio
import os
import signal
import sys


async def main():
    ended, used = asyncio.Event(), asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGINT, ended.set)
    loop.add_signal_handler(signal.SIGUSR1, used.set)
    os.kill(os.getpid(), signal.SIGUSR1)
    await used.wait()
    print("used")
    await ended.wait()
    print("ended")


asyncio.run(main())
"""
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        assert lines(capsys) == ["used"]
    assert lines(capsys) == ["ended"]
