"""What is written is whole or as before, and a loss is an exit code, at whatever call the disk or the machine fails."""

import errno
from pathlib import Path

import pytest
from faults import JOBS, KILLED, FaultyRuns, compiled, error_name, moments, port_jobs, prepare, problems
from program_runs import ROVER
from wires.zenoh_peer import free_port

MOMENTS = {  # job: number of the call, error, whether it lasts, whether files are replaced
    "summary": [(1, errno.ENOSPC, True, True), (2, errno.EIO, False, False), (4, KILLED, False, True)],
    "state": [(1, errno.EPERM, False, True), (3, errno.EROFS, True, False)],
    "scenario": [(1, errno.ENOSPC, True, False), (1, errno.EIO, True, False)],  # on standard output
}


@pytest.fixture
def runs(tmp_path):
    with FaultyRuns(tmp_path, compiled()) as found:
        prepare(found.inputs)
        yield found


def looked_at(runs, healthy, name, number, error, lasts, replaces):
    """Returns what does not hold at a moment, in words."""
    outcome = runs.run(JOBS[name], number=number, error=error, lasts=lasts, replaces=replaces)
    assert outcome.failed or outcome.counted < number, "the library lets no call fail"
    found = problems(JOBS[name], outcome, healthy[name], killed=error == KILLED)
    return [f"{name}, call {number}, {error_name(error)}: {what}: {outcome.said}" for what in found]


def all_whole(runs, names):
    """Runs jobs without a fault: their outcomes, in which every file is whole."""
    healthy = {name: runs.run(JOBS[name]) for name in names}
    for name, outcome in healthy.items():
        assert outcome.code == 0, (name, outcome.said)
        assert set(outcome.kept.values()) <= {"whole"}
        assert outcome.counted > 0
    return healthy


def test_files_are_whole_or_as_before_at_chosen_faults(runs):
    healthy = all_whole(runs, MOMENTS)
    chosen = [(name, *moment) for name, each in MOMENTS.items() for moment in each]
    assert [text for moment in chosen for text in looked_at(runs, healthy, *moment)] == []


@pytest.mark.slow
def test_files_are_whole_or_as_before_at_500_faults(runs):
    healthy = all_whole(runs, JOBS)
    drawn = moments({name: outcome.counted for name, outcome in healthy.items()}, 500, seed=37)
    assert [text for moment in drawn for text in looked_at(runs, healthy, *moment)] == []


def held(runs, job, call, numbers, **fault):
    """Asserts that a program holds where its calls of a kind fail from one of these numbers on, and for it alone."""
    healthy = runs.run(job, call=call, **fault)
    assert healthy.code == 0, healthy.said
    found = []
    for number in numbers(healthy.counted):
        for lasts in (False, True):
            outcome = runs.run(job, call=call, number=number, lasts=lasts, **fault)
            assert outcome.failed
            found += [(number, lasts, what, outcome.said) for what in problems(job, outcome, healthy, killed=False)]
    assert found == []


def some(of):
    """Numbers of so many calls: at the start, the end and in between."""
    return sorted({1, of // 3, of // 2, of * 4 // 5, of} - {0})


def read_under(runs, job):
    return runs.inputs if "IN/" in job.words else Path(ROVER).parents[1]


@pytest.mark.parametrize("name", ["calibration", "bag"])
def test_a_clock_that_is_set_back_changes_nothing(runs, name):
    held(runs, JOBS[name], "clock", some)


def test_what_cannot_be_read_is_said(runs):
    held(runs, JOBS["all"], "read", some, error=errno.EIO, under=read_under(runs, JOBS["all"]))


@pytest.mark.parametrize("name", port_jobs(0))
def test_ports_that_are_taken_are_said_or_others_are_used(runs, name):
    if name in ("zenoh", "foxglove", "dds"):
        pytest.importorskip({"dds": "cyclonedds"}.get(name, name))
    held(runs, port_jobs(free_port())[name], "bind", lambda of: range(1, of + 1), error=errno.EADDRINUSE)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in JOBS if name != "scenario"])  # which asks no clock
def test_every_program_with_a_clock_that_is_set_back(runs, name):
    held(runs, JOBS[name], "clock", some)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in JOBS if "of a node" not in name])  # whose file says where to write
def test_what_no_program_can_read_is_said(runs, name):
    held(runs, JOBS[name], "read", some, error=errno.EIO, under=read_under(runs, JOBS[name]))
