"""Processes that run episodes: the same rows whoever runs them, and none lost with a process."""

import os
import signal
import subprocess
import sys
from math import nan

import pytest
from sweep_files import hinge_scenario, runs, write_sweep

from drake_twin import Twin
from drake_twin.sweeps.engine import Engine
from drake_twin.sweeps.episode import Runner, Sweep
from drake_twin.sweeps.metrics import Condition, Metric
from drake_twin.sweeps.processes import Processes
from drake_twin.sweeps.variation import Design, Variation


def sweep(folder, *vary, metrics=("max_effort",), duration=0.1, until=None, **design):
    return Sweep.of(
        hinge_scenario(folder),
        Design(tuple(map(Variation.parse, vary)), **design),
        duration,
        metrics=tuple(map(Metric.parse, metrics)),
        until=None if until is None else Condition(until),
    )


def rows_of(sweep, workers, *, timeout=100.0, episodes=None, meanwhile=lambda engine, count: None):
    """Episode → its row, but for its wall time."""
    found = []
    with Engine(sweep, workers, timeout) as engine:
        for row in engine.rows(iter(episodes or sweep.design.episodes())):
            found.append(row)
            meanwhile(engine, len(found))
        processes = engine.processes
    assert len({row["id"] for row in found}) == len(found), "an episode has two rows"
    assert not any(os.path.exists(f"/proc/{process}") for process in processes), "a process is left over"
    return {row["episode"]: {key: value for key, value in row.items() if key != "wall_time"} for row in found}


def test_an_episode_is_a_run_of_its_scenario(tmp_path):
    one = sweep(tmp_path, "hinge.arm.mass=1,4", "hinge.hinge.position=0,0.3")
    runner = Runner(one)
    for episode in one.design.episodes():
        row = runner.run(episode)
        with Twin(episode.scenario(one.base)) as twin:
            twin.advance_to(0.1)
            assert row["state_sha256"] == twin.state_sha256()
        assert (row["outcome"], row["simulated"], row["episode"]) == ("done", 0.1, episode.number)
        assert {path: row[path] for path in episode.values} == episode.values
    runner.close()


def test_the_rows_do_not_depend_on_the_number_of_workers_or_the_order(tmp_path):
    one = sweep(tmp_path, "hinge.arm.mass=1:9:9", "hinge.hinge.position=0,0.5", seeds=(0, 1))
    known = rows_of(one, 1)
    assert sorted(known) == list(range(36))
    assert len({row["state_sha256"] for row in known.values()}) == 18  # it has no sensors, so that seeds do not matter
    assert rows_of(one, 2) == known
    assert rows_of(one, 3, episodes=reversed(list(one.design.episodes()))) == known


def test_a_worker_that_is_killed_loses_no_episode(tmp_path):
    one = sweep(tmp_path, "hinge.arm.mass=1:9:60", metrics=(), duration=0.001)

    def kill(engine, count):
        if count in (5, 25, 45):
            os.kill(engine.processes[count % 2], signal.SIGKILL)

    assert rows_of(one, 2, meanwhile=kill) == rows_of(one, 1)


def test_processes_that_were_started_ahead_are_the_workers_and_those_that_are_too_many_are_ended(tmp_path):
    one = sweep(tmp_path, "hinge.arm.mass=1,2,3,4", metrics=())
    with Processes(3) as processes:
        ahead = [item.process.pid for item in processes._waiting]
        with Engine(one, 2, 100.0, processes) as engine:
            assert engine.processes == ahead[:2]
            assert not runs(ahead[2])
            assert len(list(engine.rows(one.design.episodes()))) == 4
    with Processes(2) as processes:
        unused = [item.process.pid for item in processes._waiting]
    assert not any(map(runs, [*ahead, *unused]))


def test_the_program_starts_its_processes_before_it_imports_drake():
    text = (
        "import sys, drake_twin.sweep; print([name for name in ('pydrake', 'numpy', 'pyarrow') if name in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_what_raises_hangs_or_crashes_is_a_row_with_its_reason_and_stops_nothing(tmp_path):
    one = sweep(
        tmp_path,
        "hinge.hinge.position=0,1,2,3,4,5,6",
        metrics=(f"{write_sweep(tmp_path)}/metrics.py:sick",),
        duration=0.02,
    )
    rows = rows_of(one, 2, timeout=8.0)
    assert {number: row["outcome"] for number, row in rows.items()} == {0: "done"} | {5: "done"} | dict.fromkeys(
        (1, 2, 3, 4, 6), "error"
    )
    assert rows[0]["sick"] == 0
    assert rows[5]["sick"] == 5
    assert rows[1]["reason"].startswith("ValueError: one is sick (")
    assert rows[1]["reason"].endswith("metrics.py:14)")
    assert rows[2]["reason"] == "no result within 8 s (in 2 tries)"
    assert rows[3]["reason"] == "its process ended by SIGSEGV (in 2 tries)"
    assert rows[4]["reason"] == "its process ended with exit code 7 (in 2 tries)"
    assert rows[6]["reason"] == "its process ended with exit code 0 (in 2 tries)"
    assert rows[3]["state_sha256"] == ""


def test_an_episode_that_the_twin_cannot_run_has_the_paragraph_of_the_twin(tmp_path):
    one = sweep(tmp_path, "hinge.hinge.position=0", "hinge.arm.mass=1,-1", metrics=())
    rows = rows_of(one, 1)
    assert [row["outcome"] for row in rows.values()] == ["done", "error"]
    assert "hinge.arm.mass is -1: it must be above zero" in rows[1]["reason"]


@pytest.mark.parametrize(
    ("until", "outcome", "simulated"),
    [("FOLDER/metrics.py:early", "done", 0.3), ("settled", "timeout", 1.0), (None, "done", 1.0)],
)
def test_a_condition_ends_an_episode_early_or_is_never_met(tmp_path, until, outcome, simulated):
    write_sweep(tmp_path)
    one = sweep(tmp_path, duration=1.0, until=until and until.replace("FOLDER", str(tmp_path)), metrics=())
    (episode,) = one.design.episodes()
    row = Runner(one).run(episode)
    assert (row["outcome"], row["simulated"]) == (outcome, pytest.approx(simulated))
    with Twin(one.base) as twin:  # the looks at the condition change nothing
        twin.advance_to(row["simulated"])
        assert row["state_sha256"] == twin.state_sha256()


def test_metrics_change_nothing_and_begin_again_with_each_episode(tmp_path):
    heard = f"{write_sweep(tmp_path)}/metrics.py:heard"
    one = sweep(tmp_path, "hinge.arm.mass=1,2", metrics=("max_effort", "settled", heard), duration=0.5)
    plain = sweep(tmp_path, "hinge.arm.mass=1,2", metrics=(), duration=0.5)
    runners = Runner(one), Runner(plain)
    for episode in one.design.episodes():
        measured, bare = (runner.run(episode) for runner in runners)
        assert measured["state_sha256"] == bare["state_sha256"]
        assert measured["heard"] == 50  # of 100 Hz; those of one episode
        assert measured["max_effort"] > 0
        assert measured["settled"] is not nan


def test_an_id_is_of_all_that_a_row_depends_on(tmp_path):
    file = write_sweep(tmp_path) / "metrics.py"
    base = {"duration": 0.1, "metrics": (f"{file}:start",)}
    (episode,) = sweep(tmp_path, "hinge.arm.mass=1").design.episodes()
    known = sweep(tmp_path, "hinge.arm.mass=1", **base)
    same = sweep(tmp_path, "hinge.arm.mass=1", **base)
    assert known.id_of(episode) == same.id_of(episode)
    others = [
        sweep(tmp_path, "hinge.arm.mass=1", **base | {"duration": 0.2}).id_of(episode),
        sweep(tmp_path, "hinge.arm.mass=1", **base | {"metrics": ()}).id_of(episode),
        sweep(tmp_path, "hinge.arm.mass=1", **base, until="fell").id_of(episode),
        known.id_of(type(episode)(0, {"hinge.arm.mass": 2.0}, 0)),
        known.id_of(type(episode)(0, episode.values, 1)),
    ]
    file.write_text(file.read_text() + "\n")
    others.append(sweep(tmp_path, "hinge.arm.mass=1", **base).id_of(episode))
    assert len({known.id_of(episode), *others}) == 7


@pytest.mark.parametrize(("metric", "some"), [("distance", False), ("energy", True)])
def test_efforts_are_sampled_where_a_metric_reads_them(tmp_path, metric, some):
    one = sweep(tmp_path, metrics=(metric,))
    runner = Runner(one)
    (episode,) = one.design.episodes()
    runner.run(episode)
    assert runner._log.history(runner._twin).robots["hinge"].efforts.any() == some
