"""One engine with one workload in a process of its own, so that engines share neither memory nor caches within a turn.

The process takes ENGINE WORK COUNT, reads lines with a number of seconds, simulates them, and prints their processor
time (s).
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time
from types import TracebackType

from drake_twin.benchmarks.engine import Setting, drive
from drake_twin.benchmarks.piles import PILES
from drake_twin.benchmarks.workloads import HOLDING_ARMS, WORKLOADS, Workload

WORK = {HOLDING_ARMS.name: HOLDING_ARMS, **WORKLOADS, **PILES}


class Worker:
    """A process with an engine, which waits while it is not asked: `with Worker("DART", workload, 8) as worker`."""

    def __init__(self, engine: str, workload: Workload, count: int):
        self._name = f"{engine} with {count} {workload.name}"
        command = [sys.executable, "-m", __name__, engine, workload.name, str(count)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self) -> "Worker":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._process.communicate()

    def run(self, span: float) -> float:
        """Simulate a span (s), a multiple of 0.1; return its processor time (s).

        Raises:
            RuntimeError: If the process has ended.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(span, file=self._process.stdin, flush=True)
        for line in self._process.stdout:
            if line.startswith("cost "):  # an engine may print lines of its own
                return float(line.split()[1])
        raise RuntimeError(f"the process of {self._name} has ended")


def _main() -> None:
    engine_name, name, text = sys.argv[1:]
    workload, count, now = WORK[name], int(text), 0.0
    with tempfile.TemporaryDirectory() as folder:
        engine = Setting(engine_name).make(workload, count, Path(folder))
    for line in sys.stdin:
        begin, end = process_time(), now + float(line)
        drive(engine, workload, count, now, end)
        print("cost", process_time() - begin, flush=True)
        now = end


if __name__ == "__main__":
    _main()
