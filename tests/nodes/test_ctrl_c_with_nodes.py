"""Ctrl-C ends a run, whatever its nodes are at."""

import signal
import subprocess
import sys

import pytest
from node_runs import script

NODES = {
    "spins": "import rclpy\nrclpy.init()\nnode = rclpy.create_node('n')\n{ready}\nrclpy.spin(node)\n",
    "computes for ever": "{ready}\nwhile True:\n    try:\n        while True:\n            pass\n"
    "    except Exception:\n        pass\n",
    "waits for a pipe": "import os\n{ready}\nos.read(os.pipe()[0], 1)\n",
    "waits for standard input": "{ready}\ninput()\n",
    "catches everything": "import time\n{ready}\nwhile True:\n    try:\n        time.sleep(1)\n"
    "    except BaseException:\n        pass\n",
    "waits for a lock": "import threading\nlock = threading.Lock()\nlock.acquire()\n{ready}\nlock.acquire()\n",
    "has threads": "import threading, time\n"
    "threading.Thread(target=time.sleep, args=(1e6,)).start()\n{ready}\nthreading.Event().wait()\n",
    "has a handler of its own": "import signal, time\n"
    "signal.signal(signal.SIGINT, lambda *of: None)\n{ready}\nwhile True:\n    time.sleep(1)\n",
}


KEEPING = "computes for ever", "waits for a pipe"  # their turn, which has no end but Ctrl-C


@pytest.mark.parametrize("what", NODES)
def test_ctrl_c(tmp_path, what):
    file = script(tmp_path, "n.py", NODES[what].format(ready="print('ready', flush=True)"))
    command = [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--headless", "--real-time-rate", "1"]
    options = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen([*command, "--node", str(file)], **options) as run:
        said = next(line for line in run.stdout if line == "ready\n" or line.startswith("error"))
        assert said == "ready\n"
        run.send_signal(signal.SIGINT)
        assert run.wait(timeout=60) == (what in KEEPING)  # it is named as failed
        *_, line = (each for each in run.stdout.read().splitlines() if not each.startswith("error: failed: node n.py"))
        assert line.startswith("1 robot, ")
