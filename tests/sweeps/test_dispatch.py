"""Episodes are handed out to workers that answer, die, hang or never start: each has one row in the end."""

from collections import deque

import pytest
from sweep_files import hinge_scenario

from drake_twin.errors import RunError
from drake_twin.sweeps.dispatch import Dispatcher, Worker, WorkerEndedError
from drake_twin.sweeps.episode import Sweep
from drake_twin.sweeps.variation import Design


class Played(Worker):
    """Starts at the first look, and does with an episode what a function of its number and try says."""

    def __init__(self, play):
        super().__init__()
        self.play, self.sent, self.has_ended = play, deque(), False

    @property
    def process(self):
        return None if self.has_ended else id(self)

    def send(self, episode):
        self.sent.append(episode)

    def receive(self):
        if not self.is_ready:
            if self.play is None:
                raise WorkerEndedError("it ended")
            return None
        episode = self.sent.popleft()
        outcome = self.play(episode.number)
        if outcome == "dies":
            raise WorkerEndedError("it died")
        return {"episode": episode.number, "outcome": outcome}

    def end(self):
        self.has_ended = True


class PlayedDispatcher(Dispatcher):
    """Workers in this process; with a timeout below zero they send nothing."""

    def __init__(self, sweep, workers, play, timeout=1000.0):
        self.play, self.started = play, []
        super().__init__(sweep, workers, timeout)

    def _start(self):
        self.started.append(Played(self.play))
        assert len(self.started) < 200, "it never ends"
        return self.started[-1]

    def _heard(self, timeout):
        return [item for item in self._workers if not item.is_ready or (item.sent and self._timeout > 0.0)]


@pytest.fixture
def sweep(tmp_path):
    return Sweep.of(hinge_scenario(tmp_path), Design((), seeds=tuple(range(7))), 0.1)


def rows_of(dispatcher, sweep, stopped=()):
    with dispatcher:
        found = list(dispatcher.rows(sweep.design.episodes(), stopped))
    assert all(worker.has_ended for worker in dispatcher.started), "a worker is left over"
    assert dispatcher.processes == []
    return found


class Outcomes:
    """The outcome of each try of an episode, ``done`` where nothing is said."""

    def __init__(self, said=()):
        self.said = {number: deque(outcomes) for number, outcomes in dict(said).items()}
        self.tries = []

    def __call__(self, number):
        self.tries.append(number)
        outcomes = self.said.get(number)
        return outcomes.popleft() if outcomes else "done"


@pytest.mark.parametrize("workers", [1, 2, 10])
def test_each_episode_is_run_once(sweep, workers):
    play = Outcomes()
    rows = rows_of(PlayedDispatcher(sweep, workers, play), sweep)
    assert sorted(row["episode"] for row in rows) == sorted(play.tries) == list(range(7))
    assert {row["outcome"] for row in rows} == {"done"}


@pytest.mark.parametrize("first", ["error", "dies"])
def test_an_episode_that_fails_is_run_once_more(sweep, first):
    play = Outcomes({2: [first], 5: [first, first]})
    rows = {row["episode"]: row for row in rows_of(PlayedDispatcher(sweep, 2, play), sweep)}
    assert len(rows) == 7
    assert {number: row["outcome"] for number, row in rows.items() if row["outcome"] != "done"} == {5: "error"}
    assert [play.tries.count(number) for number in range(7)] == [1, 1, 2, 1, 1, 2, 1]
    if first == "dies":
        assert rows[5]["reason"] == "it died (in 2 tries)"


def test_another_outcome_than_an_error_is_a_row_at_once(sweep):
    play = Outcomes({1: ["fell"], 3: ["timeout"]})
    rows = {row["episode"]: row["outcome"] for row in rows_of(PlayedDispatcher(sweep, 1, play), sweep)}
    assert (rows[1], rows[3]) == ("fell", "timeout")
    assert len(play.tries) == 7


def test_a_worker_that_dies_is_ended_and_replaced(sweep):
    dispatcher = PlayedDispatcher(sweep, 2, Outcomes({0: ["dies"], 4: ["dies"]}))
    rows_of(dispatcher, sweep)
    assert len(dispatcher.started) == 4


def test_a_worker_that_hangs_is_ended_and_its_episode_is_a_row(sweep):
    dispatcher = PlayedDispatcher(sweep, 2, Outcomes(), timeout=-1.0)
    rows = rows_of(dispatcher, sweep)
    assert sorted(row["episode"] for row in rows) == list(range(7))
    assert {(row["outcome"], row["reason"]) for row in rows} == {("error", "no result within -1 s (in 2 tries)")}
    assert len(dispatcher.started) == 2 + 2 * 7


def test_workers_that_never_start_end_the_sweep(sweep):
    dispatcher = PlayedDispatcher(sweep, 2, None)
    with pytest.raises(RunError, match="the processes of the sweep cannot start: it ended"):
        rows_of(dispatcher, sweep)
    assert len(dispatcher.started) == 2 + 20
    assert all(worker.has_ended for worker in dispatcher.started)


def test_workers_that_die_after_they_have_started_do_not_end_it(sweep):
    long = Sweep.of(sweep.base, Design((), seeds=tuple(range(40))), 0.1)
    play = Outcomes({number: ["dies", "dies"] for number in range(40)})
    assert len(rows_of(PlayedDispatcher(long, 1, play), long)) == 40


def test_a_stopped_sweep_drops_what_runs(sweep):
    stopped = []
    dispatcher = PlayedDispatcher(sweep, 1, Outcomes())
    with dispatcher:
        rows = dispatcher.rows(sweep.design.episodes(), stopped)
        first = [next(rows), next(rows)]
        stopped.append("Ctrl-C")
        assert list(rows) == []
    assert [row["episode"] for row in first] == [0, 1]
