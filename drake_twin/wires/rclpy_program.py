"""The program of the process of the machine's ROS 2, which the twin feeds on standard input.

It runs with the Python that this ROS is made for: it and what it imports of drake_twin are without the twin's
requirements, and for Python 3.10, too. When the twin ends, in whatever way, it reads the end of the pipe and takes its
nodes off the graph.
"""

import json
import os
import sys
import threading

from drake_twin.python_process import ignore_stops
from drake_twin.wires.rclpy_graph import RclpyGraph
from drake_twin.wires.rclpy_records import FAILED, STARTED, Pipe


def main() -> int:
    """Run with the options that the command line ends with, as JSON; return the exit code."""
    ignore_stops()  # the pipe's end ends it
    pipe = Pipe(os.fdopen(os.dup(1), "wb", buffering=0))
    os.dup2(2, 1)  # libraries must not print between records
    options = json.loads(sys.argv[-1])
    try:
        graph = RclpyGraph(pipe, options["arguments"], options["domain"])
        pipe.tell(STARTED, graph.started())
    except Exception as error:
        pipe.write(FAILED, content=f"{type(error).__name__}: {error}".encode())
        return 1
    threading.Thread(target=graph.read, args=(sys.stdin.buffer,), daemon=True).start()
    graph.run()
    return 0


if __name__ == "__main__":
    sys.exit(main())
