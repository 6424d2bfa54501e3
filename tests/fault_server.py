"""Runs programs of the package in forks of one process that has imported them: ``python fault_server.py``.

Each line on standard input is a run as JSON: ``program``, ``words``, ``environment``, and the files ``out`` and ``err``
for its output. Its exit code is the line that comes back; minus a signal's number if that has ended it.
"""

import importlib
import json
import os
import sys
import traceback

from drake_twin.program import leave

PROGRAMS = ("run", "sweep", "calibrate", "check")
for _name in PROGRAMS:
    importlib.import_module(f"drake_twin.{_name}")
for _name in ("builder.twin_builder", "twin.twin", "cli.target", "cli.plot", "cli.html_file", "calibration", "sweeps"):
    importlib.import_module(f"drake_twin.{_name}")


def _child(run):
    for number, name in ((1, run["out"]), (2, run["err"])):
        file = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        os.dup2(file, number)
        os.close(file)
    os.environ.update(run["environment"])  # from now on, calls fail
    try:
        code = importlib.import_module(f"drake_twin.{run['program']}").main(run["words"])
    except SystemExit as end:
        code = end.code
    except BaseException:  # as the interpreter does
        traceback.print_exc()
        code = 1
    leave(code or 0)


def _serve():
    for line in sys.stdin:
        if (pid := os.fork()) == 0:
            os.setpgid(0, 0)
            _child(json.loads(line))
        _, status = os.waitpid(pid, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)


if __name__ == "__main__":  # a worker of a sweep imports this file
    _serve()
