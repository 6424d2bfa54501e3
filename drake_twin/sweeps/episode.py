"""One episode: a scenario with values and a seed, run once, and the row of the table that it amounts to."""

import hashlib
import json
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from math import ceil
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError, TwinError, described
from drake_twin.findings import Finding
from drake_twin.plugin_watch import plugins_watched
from drake_twin.scenario import Scenario
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.sweeps.known_paths import check_paths
from drake_twin.sweeps.launched import LaunchFile
from drake_twin.sweeps.metrics import Condition, Metric, has_fallen
from drake_twin.sweeps.state_log import StateLog
from drake_twin.sweeps.variation import Design, Episode, Value
from drake_twin.twin.twin import Twin
from drake_twin.versions import SWEEP, stamp

_TRIALS = 20  # values of a path
_CHECKS = 20.0  # Hz at which a condition is asked

# What became of an episode: it ran to its end, its base lies on its side, its condition never held, or it failed.
DONE, FELL, TIMEOUT, ERROR = "done", "fell", "timeout", "error"

COLUMNS = ("episode", "id", "seed", "outcome", "reason", "simulated", "wall_time", "state_sha256", "version")

Row = dict[str, Any]


@dataclass(frozen=True)
class Sweep:
    """What a sweep runs: all that its rows depend on.

    Attributes:
        yaml: The scenario without the varied values.
        design: The values.
        duration: The simulated time of an episode (s).
        metrics: What the episodes are judged by.
        until: The condition that ends an episode early.
        version: What wrote it, as `stamp` says.
        launch: The launch file whose arguments are varied; None if none are.
    """

    yaml: str
    design: Design
    duration: float
    metrics: tuple[Metric, ...] = ()
    until: Condition | None = None
    version: str = ""
    launch: LaunchFile | None = None

    @classmethod
    def of(cls, scenario: Scenario, design: Design, duration: float, **more: Any) -> "Sweep":
        """Return the sweep of a scenario, of this version.

        Raises:
            InputError: If a metric has the name of another column.
        """
        _check_names([item.name for item in more.get("metrics", ())], design.paths)
        return cls(scenario_to_yaml(scenario), design, duration, version=stamp(), **more)

    @cached_property
    def base(self) -> Scenario:
        """The scenario without the varied values."""
        return ScenarioFile(self.yaml, "sweep").scenario

    def __len__(self) -> int:
        return len(self.design)

    def scenario(self, episode: Episode) -> Scenario:
        """Return the scenario of an episode.

        Raises:
            InputError: If a path or a value cannot be used.
        """
        return episode_scenario(self.base, self.launch, episode)

    @cached_property
    def definition(self) -> dict[str, Any]:
        """All that the rows depend on, as plain data."""
        return {
            "format": SWEEP.version,
            "version": self.version,
            "scenario": self.yaml,
            "duration": self.duration,
            "metrics": [[item.name, item.file, item.function, item.sha256] for item in self.metrics],
            "until": None if self.until is None else [self.until.text, self.until.sha256],
            **({} if self.launch is None else {"launch": self.launch.as_plain()}),
            **self.design.as_plain(),
        }

    @cached_property
    def _common(self) -> str:
        own = ("format", "vary", "samples", "seeds")
        same = {key: value for key, value in self.definition.items() if key not in own}
        return json.dumps(same, sort_keys=True)

    def id_of(self, episode: Episode) -> str:
        """Return the episode's name among all episodes of all sweeps: a hash of all that its row depends on."""
        own = json.dumps([[*episode.values.items()], episode.seed])
        return hashlib.sha256(f"{self._common}\n{own}".encode()).hexdigest()[:20]

    def __reduce__(self) -> Any:
        return Sweep, (self.yaml, self.design, self.duration, self.metrics, self.until, self.version, self.launch)


def _check_names(metrics: Sequence[str], paths: Sequence[str]) -> None:
    """Check that each column of the table has a name of its own."""
    for index, name in enumerate(metrics):
        if name in metrics[:index]:
            raise InputError(f"--metric {name} is given twice: name one of them, NAME=FILE.py:FUNCTION")
        if name in COLUMNS or any(path == name or path.startswith(f"{name}.") for path in paths):
            raise InputError(f"--metric {name}: the table has a column of this name already: name it otherwise")


class Runner:
    """Runs episodes of one sweep one after the other, in one twin that is reset, and built again where it must be.

    Args:
        sweep: The sweep.
    """

    def __init__(self, sweep: Sweep):
        self._sweep = sweep
        self._twin: Twin | None = None
        self._log: StateLog | None = None
        self._messages: dict[str, list[Any]] = {}

    def run(self, episode: Episode) -> Row:
        """Run an episode; return its row.

        An error of the episode is its outcome, and the next one gets a new twin.
        """
        sweep, started = self._sweep, time.perf_counter()
        row = first_columns(sweep, episode)
        try:
            with plugins_watched(()):
                twin = self._started(sweep.scenario(episode))
                outcome = self._advance(twin)
            if self._log is not None:
                history = self._log.history(twin)
                for metric in sweep.metrics:
                    row |= metric.columns(history, self._messages_of(metric, twin))
            row |= {"outcome": outcome, "reason": "", "simulated": twin.time, "state_sha256": twin.state_sha256()}
        except (Exception, SystemExit) as error:
            reason = str(error) if isinstance(error, TwinError) else described(error)
            row |= {"outcome": ERROR, "reason": reason, "simulated": self._twin.time if self._twin else 0.0}
            self.close()
        row["wall_time"] = time.perf_counter() - started
        return row

    def close(self) -> None:
        """Free the twin."""
        twin, self._twin = self._twin, None
        if twin is not None:
            twin.close()

    def _started(self, scenario: Scenario) -> Twin:
        """Return the twin at the start of a scenario."""
        if self._twin is None:
            metrics = self._sweep.metrics
            self._log = StateLog(with_efforts=any(item.needs_efforts for item in metrics)) if metrics else None
            self._twin = Twin(scenario, extensions=[] if self._log is None else [self._log])
            self._messages = {topic: [] for metric in metrics for topic in metric.topics(self._twin)}
            for topic, received in self._messages.items():
                self._twin.subscribe(topic, received.append)
        else:
            self._twin.reset(scenario)
        if self._log is not None:
            self._log.restart(self._twin)
        for received in self._messages.values():
            received.clear()
        return self._twin

    def _messages_of(self, metric: Metric, twin: Twin) -> dict[str, list[Any]]:
        return {topic: self._messages[topic] for topic in metric.topics(twin)}

    def _advance(self, twin: Twin) -> str:
        """Run to the end, or until the condition holds; return the outcome."""
        duration, until = self._sweep.duration, self._sweep.until
        if until is None:
            twin.advance_to(duration)
            return FELL if has_fallen(twin) else DONE
        for check in range(1, ceil(duration * _CHECKS) + 1):
            twin.advance_to(min(check / _CHECKS, duration))
            if until.call(twin):
                return FELL if until.text == FELL or has_fallen(twin) else DONE
        return FELL if has_fallen(twin) else TIMEOUT


def episode_scenario(base: Scenario, launch: LaunchFile | None, episode: Episode) -> Scenario:
    """Return the scenario of an episode.

    Args:
        base: The scenario without the varied values.
        launch: The launch file whose arguments are varied.
        episode: The episode.

    Raises:
        InputError: If a path or a value cannot be used.
    """
    if launch is None:
        return episode.scenario(base)
    launched = replace(launch.scenario(episode.values), pushes=base.pushes, retune=base.retune)
    return episode.scenario(launched, launched=True)


def first_columns(sweep: Sweep, episode: Episode) -> Row:
    """Return the columns of a row that are known before its episode has run."""
    values: dict[str, Value] = dict(episode.values)
    return {
        "episode": episode.number,
        "id": sweep.id_of(episode),
        **values,
        "seed": episode.seed,
        "outcome": ERROR,
        "reason": "",
        "simulated": 0.0,
        "wall_time": 0.0,
        "state_sha256": "",
        "version": sweep.version,
    }


def failed(sweep: Sweep, episode: Episode, reason: str) -> Row:
    """Return the row of an episode whose process ended or was ended."""
    return {**first_columns(sweep, episode), "reason": reason}


def trial(sweep: Sweep) -> tuple[Finding, ...]:
    """Start every varied value once, so that what is wrong with a sweep is found before it begins.

    Of the values that need a build only the first one of each path is built; of many values some are tried, with the
    least and the largest.

    Returns:
        What became of the files.

    Raises:
        InputError: If a path, a value or a metric's topic cannot be used.
    """
    first = next(sweep.design.episodes())
    start = sweep.scenario(first)
    check_paths(start, sweep.base, sweep.design.paths)
    with Twin(start) as twin:
        for path, values in sweep.design.values().items():
            for index, value in enumerate(_some(values)):
                scenario = sweep.scenario(replace(first, values={**first.values, path: value}))
                if index == 0 or replace(scenario, values=start.values) == start:
                    twin.reset(scenario)
        for metric in sweep.metrics:
            for topic in metric.topics(twin):
                twin.subscribe(topic, lambda message: None)
        return twin.findings


def _some(values: Sequence[Value]) -> Sequence[Value]:
    """Return a few of many values, in any order: the least and the largest of numbers among them."""
    if len(values) <= _TRIALS:
        return values
    numbers = [value for value in values if not isinstance(value, str)]
    ends = [min(numbers), max(numbers)] if numbers else []
    return [*ends, *values[:: len(values) // _TRIALS]]
