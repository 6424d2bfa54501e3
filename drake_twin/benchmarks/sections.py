"""The sections of the benchmarks: one function each, which returns tables."""

import sys
from collections.abc import Callable, Mapping
from functools import partial
from importlib.util import find_spec
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from drake_twin.benchmarks.engine import Engine, Setting, drive
from drake_twin.benchmarks.engines.twin import TwinEngine
from drake_twin.benchmarks.measure import by_turns, ratio, whole
from drake_twin.benchmarks.report import Table
from drake_twin.benchmarks.sensors import sensors
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.startup import startup
from drake_twin.benchmarks.sweeps import sweep
from drake_twin.benchmarks.workloads import HOLDING_ARMS, LONGEST_GRID, LOOK_AT, SAME_ERROR, WORKLOADS, Workload
from drake_twin.program import say
from drake_twin.twin.twin import Twin

ROVERS, ARMS = WORKLOADS["cruising rovers"], WORKLOADS["arms whose commands change"]
EVENT = 0.01  # s; the period of the stops in the runs with events
_SOLVERS = ("twin", "twin, similar", "twin, sap")  # the discrete engine with each of Drake's contact solvers
# The settings that are tried for work and precision.
_STEPS = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002)  # s
_ACCURACIES = (1e-2, 1e-3, 1e-4, 3e-5, 1e-5, 5e-6, 3e-6, 2e-6, 1e-6, 3e-7, 1e-7)
_STEPS_OF_MUJOCO = (5e-3, 2e-3, 1e-3, 7e-4, 5e-4, 4e-4, 3e-4, 2.5e-4, 2e-4, 1.5e-4, 1e-4, 5e-5, 2.5e-5)  # s


def overhead(size: Size) -> list[Table]:
    """Measure the twin beside the bare plant, without subscribers and with everything delivered at 50 Hz."""
    rows = [
        _overhead(size, workload, count, step)
        for workload in (ROVERS, HOLDING_ARMS, ARMS)
        for count in size.counts
        for step in (0.001, 0.01)
    ]
    columns = (
        "robots",
        "step (ms)",
        "twin ÷ bare plant",
        "twin ÷ bare plant with Drake's sampled ports",
        "joint_states, tf and clock at 50 Hz ÷ no subscriber",
        "the same: µs for each robot and tick",
        "Python's part of these µs",
        "µs for each robot and step: twin",
        "bare plant",
    )
    return [Table("overhead", "The twin beside the bare Drake plant, wall time", columns, tuple(rows))]


def _overhead(size: Size, workload: Workload, count: int, step: float) -> tuple[Any, ...]:
    names = ("twin", "bare plant", "bare plant, sampled ports")
    engines = {name: Setting(name, step).make(workload, count, size.folder) for name in names}
    listening = Setting("twin", step).make(workload, count, size.folder)
    assert isinstance(listening, TwinEngine)
    for topic in listening.twin.graph.topics():
        if topic in ("/tf", "/clock") or topic.endswith("/joint_states"):
            listening.twin.subscribe(topic, lambda message: None, 50)
    engines["listening"] = listening
    span = whole(12.0 * size.scale / count * (step / 0.001) ** 0.8, 0.1)  # some 0.4 s of wall time
    cases = {name: _turn(engine, workload, count, span) for name, engine in engines.items()}
    for case in cases.values():
        case()  # from rest; the timed turns continue from there
    times = by_turns(cases, size.repeats)
    extra = [a - b for a, b in zip(times["listening"], times["twin"], strict=True)]
    quiet = engines["twin"]
    assert isinstance(quiet, TwinEngine)
    python = [listening.python_time(cases["listening"]) - quiet.python_time(cases["twin"]) for _ in range(size.repeats)]
    return (
        f"{count} {workload.name}",
        step * 1e3,
        ratio(times, "twin", "bare plant"),
        ratio(times, "twin", "bare plant, sampled ports"),
        ratio(times, "listening", "twin"),
        median(extra) / (count * 50 * span) * 1e6,
        median(python) / (count * 50 * span) * 1e6,
        median(times["twin"]) * step / (span * count) * 1e6,
        median(times["bare plant"]) * step / (span * count) * 1e6,
    )


def features(size: Size) -> list[Table]:
    """Measure the cost of each feature, relative to a twin that does not use it."""
    count = size.counts[-1] if len(size.counts) < 2 else size.counts[1]
    twins = {"nothing": _twin(size, count)}
    for name, topics, rate in (
        ("/clock at 50 Hz", ("/clock",), 50),
        ("all joint_states at 50 Hz", ("/joint_states",), 50),
        ("all dynamic_joint_states at 50 Hz", ("/dynamic_joint_states",), 50),
        ("/tf at 50 Hz", ("/tf",), 50),
        ("all ground_truth/odom at 50 Hz", ("/ground_truth/odom",), 50),
        ("/link_states at 50 Hz", ("/link_states",), 50),
    ):
        twins[name] = _twin(size, count)
        for topic in twins[name].graph.topics():
            if any(topic.endswith(end) for end in topics):
                twins[name].subscribe(topic, lambda message: None, rate)
    twins["a recording"] = _twin(size, count)
    twins["a recording"].recorder.begin()
    from drake_twin.cockpit.scene import Scene

    scene, drawn = Scene(), _twin(size, count)
    drawn.subscribe("/clock", lambda message: scene.draw(drawn), 30)
    twins["a scene drawn at 30 Hz"] = drawn
    span = whole(0.5 * size.scale, 0.1)
    turn = dict.fromkeys(twins, 0)

    def go(name: str) -> None:
        turn[name] += 1
        twins[name].advance_to(0.1 + turn[name] * span)

    times = by_turns({name: partial(go, name) for name in twins}, size.repeats)
    rows = tuple((name, ratio(times, name, "nothing")) for name in twins if name != "nothing")
    return [Table("features", f"What features cost: {count} rovers, 1 ms steps", ("feature", "÷ none"), rows)]


def _twin(size: Size, count: int) -> Twin:
    scenario = ROVERS.scheduled(ROVERS.scenario(count, size.folder, time_step=0.001), 0.0)
    twin = Twin(scenario)
    twin.advance_to(0.1)
    return twin


def robots(size: Size) -> list[Table]:
    """Measure real-time factors over the number of robots."""
    settings = (
        Setting("twin", 0.001),
        Setting("twin", 0.01),
        Setting("twin, cenic", LONGEST_GRID, 1e-3),
        Setting("bare plant", 0.001),
        Setting("MuJoCo", 0.001),
        Setting("MuJoCo", 0.0002),
        *([Setting("PyBullet", 0.001)] if find_spec("pybullet") else ()),
    )
    tables = []
    for workload in WORKLOADS.values():
        rows = []
        for count in size.many:
            say(f"  {count} {workload.name}", sys.stderr)
            span = whole(1.2 * size.scale, 0.1)
            engines = {str(setting): setting.make(workload, count, size.folder) for setting in settings}
            cases = {name: _turn(engine, workload, count, span) for name, engine in engines.items()}
            times = by_turns(cases, max(1, size.repeats // 2))
            rows.append((count, *(span / median(values) for values in times.values())))
        columns = ("robots", *map(str, settings))
        tables.append(Table("robots", f"Real-time factor: {workload.name}", columns, tuple(rows)))
    return tables


def _turn(engine: Engine, workload: Workload, count: int, span: float) -> Callable[[], object]:
    """Return a function that runs an engine for a span (s) each time it is called, from time zero on."""
    turns = [0]

    def run() -> None:
        begin = turns[0] * span
        turns[0] += 1
        drive(engine, workload, count, begin, begin + span)

    return run


def precision(size: Size) -> list[Table]:
    """Measure real-time factors at equal error, relative to each engine's finest run, or the nearer of MuJoCo's two."""
    tables, best = [], []
    for workload in WORKLOADS.values():
        for count in size.counts if workload is ROVERS else size.counts[:2]:
            for event in (None, EVENT) if workload is ROVERS else (None,):
                say(f"  {count} {workload.name}", sys.stderr)
                table, summary = _precision(size, workload, count, event)
                tables.append(table)
                best.append(summary)
    columns = (
        "work",
        "robots",
        "event",
        "error (rad)",
        "twin's setting",
        "its factor",
        "MuJoCo's step",
        "its factor",
        "twin ÷ MuJoCo",
    )
    errors = f"{SAME_ERROR:g} rad, or the least that MuJoCo reaches"
    title = f"The fastest runs with the same error after {LOOK_AT:g} s: {errors}"
    return [Table("precision", title, columns, tuple(best)), *tables]


def _precision(size: Size, workload: Workload, count: int, event: float | None) -> tuple[Table, tuple[Any, ...]]:
    finest, settings = _settings(count, event, coarse=size.scale < 0.5)
    truths = {
        name: [_run(size, setting, workload, count, event)[0] for setting in of_engine]
        for name, of_engine in finest.items()
    }
    rows: list[tuple[Setting, float, float]] = []
    for setting in settings:
        positions, factor = _run(size, setting, workload, count, event)
        error = min(float(np.abs(positions - truth).max()) for truth in truths[setting.engine])
        rows.append((setting, error, factor))
    least = min(error for setting, error, _ in rows if setting.engine == "MuJoCo")
    bound = max(SAME_ERROR, least)
    ours, theirs = (
        max(
            (row for row in rows if (row[0].engine == "MuJoCo") == is_mujoco and row[1] <= bound),
            key=lambda row: row[2],
            default=None,
        )
        for is_mujoco in (False, True)
    )
    assert theirs is not None
    where = "no events" if event is None else f"every {event * 1e3:g} ms"
    table = Table(
        "precision",
        f"Work and precision: {count} {workload.name}, {where}",
        ("setting", "error (rad)", "real-time factor"),
        tuple((str(setting), f"{error:.1e}", factor) for setting, error, factor in rows),
    )
    if ours is None:
        return table, (workload.name, count, where, f"{bound:.1e}", "none", None, str(theirs[0]), theirs[2], None)
    both = _factor(size, [ours[0], theirs[0]], workload, count, event)
    summary = (
        workload.name,
        count,
        where,
        f"{bound:.1e}",
        str(ours[0]),
        both[ours[0]],
        str(theirs[0]),
        both[theirs[0]],
        both[ours[0]] / both[theirs[0]],
    )
    return table, summary


def _settings(count: int, event: float | None, *, coarse: bool) -> tuple[dict[str, list[Setting]], list[Setting]]:
    """Return the finest settings of each engine, whose runs are the truth, and the settings to compare with them."""
    grid = event or LONGEST_GRID
    finest = {
        **{name: [Setting(name, 0.001 if coarse else 0.0001 if count > 8 else 0.00005)] for name in _SOLVERS},
        "twin, cenic": [Setting("twin, cenic", grid, 1e-4 if coarse else 1e-8)],
        # Its finer runs do not always converge: the smaller error relative to either of two runs counts.
        "MuJoCo": [Setting("MuJoCo", step) for step in ((0.0005,) if coarse else (0.00002, 0.000005))],
    }
    settings = [
        *(Setting(name, step) for name in _SOLVERS for step in _STEPS),
        *(Setting("twin, cenic", grid, accuracy) for accuracy in _ACCURACIES),
        *(Setting("MuJoCo", step) for step in _STEPS_OF_MUJOCO),
    ]
    if coarse:
        settings = [Setting("twin", 0.01), Setting("twin, cenic", grid, 1e-2), Setting("MuJoCo", 0.002)]
    return finest, settings


def _run(size: Size, setting: Setting, workload: Workload, count: int, event: float | None) -> tuple[np.ndarray, float]:
    """Return the joint positions when errors are measured, and the real-time factor until then."""
    engine = setting.make(workload, count, size.folder)
    begin = perf_counter()
    drive(engine, workload, count, 0.0, LOOK_AT, event)
    return engine.positions(), LOOK_AT / (perf_counter() - begin)


def _factor(
    size: Size, settings: list[Setting], workload: Workload, count: int, event: float | None
) -> Mapping[Setting, float]:
    """Return real-time factors, measured by turns; cruising robots run for five seconds."""
    span = whole((5.0 if workload is ROVERS else LOOK_AT) * min(1.0, size.scale), 0.1)
    times: dict[Setting, list[float]] = {setting: [] for setting in settings}
    for _ in range(size.repeats):
        for setting in settings:
            engine = setting.make(workload, count, size.folder)
            begin = perf_counter()
            drive(engine, workload, count, 0.0, span, event)
            times[setting].append(perf_counter() - begin)
    return {setting: span / median(values) for setting, values in times.items()}


def real_time(size: Size) -> list[Table]:
    """Measure how many rovers one core runs in real time, with their joint_states delivered at 50 Hz."""
    rows = []
    for count in size.many:
        engine = Setting("twin, cenic", 0.02, 1e-2).make(ROVERS, count, size.folder)
        assert isinstance(engine, TwinEngine)
        received = [0]

        def receive(message: Any, received: list[int] = received) -> None:
            received[0] += 1

        for topic in engine.twin.graph.topics():
            if topic.endswith("/joint_states"):
                engine.twin.subscribe(topic, receive, 50)
        span = whole(2.0 * size.scale, 0.1)
        times = by_turns({"run": _turn(engine, ROVERS, count, span)}, size.repeats)["run"]
        rows.append((count, span / median(times), span / max(times), received[0]))
    columns = ("rovers", "real-time factor", "slowest turn", "messages received")
    title = "Rovers with CENIC at accuracy 1e-2, joint_states delivered at 50 Hz"
    return [Table("real time", title, columns, tuple(rows))]


SECTIONS: Mapping[str, Callable[[Size], list[Table]]] = {
    "overhead": overhead,
    "features": features,
    "precision": precision,
    "robots": robots,
    "real-time": real_time,
    "startup": startup,
    "sensors": sensors,
    "sweep": sweep,
}
