"""Ten thousand tiny episodes, while workers and the program are killed and the disk is full: each has one whole row."""

import contextlib
import os
import random
import shutil
import signal
import subprocess
import threading
from collections import Counter
from pathlib import Path

import pytest
from sweep_files import children, program, runs, write_sweep

from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sweeps.episode import Runner, Sweep
from drake_twin.sweeps.results import read_table
from drake_twin.sweeps.variation import Design, Variation

EPISODES = 10_000
VARY = f"hinge.arm.mass=1:9:{EPISODES // 2}"
COMMAND = ("hinge.yaml", "--vary", VARY, "--seeds", "2", "--duration", "0.001", "--workers", "3", "--out", "t.csv")
SMALL = 150 * EPISODES  # bytes: less than the journal


@pytest.fixture
def disk(tmp_path):
    """A folder with a file system of its own, which is small."""
    folder = tmp_path / "disk"
    folder.mkdir()
    made = shutil.which("mount") and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={SMALL}", "tmpfs", str(folder)], capture_output=True, check=False
    )
    if not made or made.returncode != 0:
        pytest.skip("may not mount a small file system")
    yield write_sweep(folder)
    subprocess.run(["umount", "-l", str(folder)], check=True)


class Disturbed:
    """A sweep whose oldest worker is killed each second, but for those in which a busy machine has done nothing."""

    def __init__(self, folder):
        self.killed, self.workers = 0, set()
        self._ended = threading.Event()
        self._journal = folder / "t.csv.journal"
        self.process = program(folder, *COMMAND)
        self._killer = threading.Thread(target=self._kill)
        self._killer.start()

    def _kill(self):
        last = 0
        while not self._ended.wait(1.0):
            with contextlib.suppress(OSError):
                workers = [item for item in children(self.process) if b"spawn_main" in cmdline(item)]
                self.workers |= set(workers)
                done = self._journal.stat().st_size
                if workers and done > last:
                    os.kill(min(workers), signal.SIGKILL)
                    self.killed, last = self.killed + 1, done

    def end(self):
        """Waits for the program's end; returns what it has printed."""
        texts = self.process.communicate(timeout=3000)
        self._ended.set()
        self._killer.join()
        return texts


def cmdline(process):
    return Path(f"/proc/{process}/cmdline").read_bytes()


def reaches(folder, count, process):
    """Waits until the journal has so many rows."""
    file = folder / "t.csv.journal"
    while process.poll() is None and (not file.exists() or file.read_bytes().count(b"\n") <= count):
        threading.Event().wait(0.05)
    return process.poll() is None


@pytest.mark.slow
def test_each_of_ten_thousand_episodes_has_one_whole_row(disk, capsys):
    choice = random.Random(1)
    runs_of_it = []

    run = Disturbed(disk)
    runs_of_it.append(run)
    _, err = run.end()
    assert run.process.returncode == 1, err
    assert "t.csv.journal cannot be written (No space left on device)" in err
    assert "rows are safe. To continue: " in err
    done = (disk / "t.csv.journal").read_bytes().count(b"\n") - 1
    assert 0 < done < EPISODES * 0.6
    subprocess.run(["mount", "-o", "remount,size=100m", str(disk)], check=True)

    for more in (EPISODES // 10, EPISODES * 3 // 10):
        run = Disturbed(disk)
        runs_of_it.append(run)
        assert reaches(disk, done + more, run.process)
        run.process.kill()
        run.end()

    run = Disturbed(disk)
    runs_of_it.append(run)
    out, err = run.end()
    assert run.process.returncode == 0, err
    assert f"t.csv: {EPISODES} rows" in out
    assert not (disk / "t.csv.journal").exists()
    assert not any(runs(worker) for run in runs_of_it for worker in run.workers)

    rows = read_table(disk / "t.csv")[1]
    assert [row["episode"] for row in rows] == list(range(EPISODES))
    assert len({row["id"] for row in rows}) == EPISODES
    outcomes = Counter(row["outcome"] for row in rows)
    unlucky = [row for row in rows if row["outcome"] == "error"]  # those that were killed twice
    assert all(row["reason"] == "its process ended by SIGKILL (in 2 tries)" for row in unlucky)
    assert outcomes["done"] + len(unlucky) == EPISODES
    assert len(unlucky) <= 3
    base = ScenarioFile((disk / "hinge.yaml").read_text(), "hinge.yaml").scenario
    sweep = Sweep.of(base, Design((Variation.parse(VARY),), seeds=(0, 1)), 0.001)
    runner = Runner(sweep)
    for episode in choice.sample(list(sweep.design.episodes()), 100):
        row = rows[episode.number]
        assert row["hinge.arm.mass"] == episode.values["hinge.arm.mass"]
        if row["outcome"] == "done":
            assert row["state_sha256"] == runner.run(episode)["state_sha256"]
    with capsys.disabled():
        killed = sum(run.killed for run in runs_of_it)
        print(f"\n{EPISODES} rows, {killed} workers killed, {len(unlucky)} episodes killed twice")
