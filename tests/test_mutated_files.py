"""Ten thousand altered files of every kind end in a twin that steps or in one readable error; see ``mutations.py``."""

import subprocess
import sys
from pathlib import Path

import pytest

WORKER = Path(__file__).with_name("mutations.py")


def faults(seed, count):
    """What ends in anything else, and what ends the worker."""
    found, first, runs = [], 0, 0
    while first < count:
        worker = subprocess.run(
            [sys.executable, str(WORKER), str(seed), str(first), str(count - first)],
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        lines = worker.stdout.splitlines()
        runs += lines.count("runs")
        found += [line for line in lines if line.startswith("fault ")]
        tried = [line for line in lines if line[:1].isdigit()]
        assert tried, worker.stderr
        if worker.returncode:
            found.append(f"input {tried[-1]} ended the worker with {worker.returncode}: {worker.stderr[-500:]}")
        first = int(tried[-1].split()[0]) + 1
    return found, runs


def test_a_thousand_altered_files():
    found, runs = faults(seed=1, count=1000)
    assert not found
    assert 100 < runs < 900


@pytest.mark.slow
def test_ten_thousand_altered_files():
    found, _ = faults(seed=1, count=10_000)
    assert not found
