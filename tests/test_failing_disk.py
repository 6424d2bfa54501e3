"""What is written is whole or as before, and a loss is an exit code, at whatever call the disk fails."""

import errno

import pytest
from faults import JOBS, KILLED, FaultyRuns, compiled, error_name, moments, prepare, problems

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
