"""How processes start: what they print is put into tables."""

import subprocess
import sys
from types import SimpleNamespace

import pytest

from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.startup import startup


def test_processes_phases_and_memory_are_tables(monkeypatch, tmp_path):
    asked = []

    def run(command, **options):
        assert command[0] == sys.executable
        assert options["check"]
        assert options["capture_output"]
        assert options["text"]
        asked.append(command[1:])
        text = " ".join(command)
        return SimpleNamespace(stdout='{"one": 0.002, "two": 0.5}' if "perf_counter" in text else "12.5\n")

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr("drake_twin.benchmarks.startup._processor_time", lambda: 2.0 * len(asked))
    whole, phases, memory = startup(Size(tmp_path, repeats=3, scale=0.1))
    assert len(asked) == (1 + 3 + 3) * len(whole.rows) + 3 + 1
    assert all(seconds > 0 and relative > 0 for _, seconds, relative, _, _ in whole.rows)
    assert all((used, relative) == (2.0, 1.0) for *_, used, relative in whole.rows)
    assert phases.rows == (("one", pytest.approx(2.0)), ("two", pytest.approx(500.0)))  # ms
    assert memory.rows == ((12.5,),)
    assert asked[-1][-1] == "4"
    assert "4 rovers" in memory.title
