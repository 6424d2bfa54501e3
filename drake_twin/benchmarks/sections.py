"""The sections of the benchmarks: one function each, which returns tables."""

import sys
from collections.abc import Callable, Mapping
from functools import partial
from statistics import median
from typing import Any

from drake_twin.benchmarks.comparison import engines
from drake_twin.benchmarks.engine import OPTIONAL_MODULES, Setting, is_present, turn
from drake_twin.benchmarks.engines.twin import TwinEngine
from drake_twin.benchmarks.measure import by_turns, ratio, whole
from drake_twin.benchmarks.precision import equal_error, precision
from drake_twin.benchmarks.report import Table
from drake_twin.benchmarks.sensors import sensors
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.startup import startup
from drake_twin.benchmarks.sweeps import sweep
from drake_twin.benchmarks.workloads import HOLDING_ARMS, LONGEST_GRID, WORKLOADS, Workload
from drake_twin.program import say
from drake_twin.twin.twin import Twin

ROVERS, ARMS = WORKLOADS["cruising rovers"], WORKLOADS["arms whose commands change"]


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
    cases = {name: turn(engine, workload, count, span) for name, engine in engines.items()}
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
        *(Setting(name, 0.001) for name in OPTIONAL_MODULES if is_present(name)),
    )
    tables = []
    for workload in WORKLOADS.values():
        rows = []
        for count in size.many:
            say(f"  {count} {workload.name}", sys.stderr)
            span = whole(1.2 * size.scale, 0.1)
            engines = {str(setting): setting.make(workload, count, size.folder) for setting in settings}
            cases = {name: turn(engine, workload, count, span) for name, engine in engines.items()}
            times = by_turns(cases, max(1, size.repeats // 2))
            rows.append((count, *(span / median(values) for values in times.values())))
        columns = ("robots", *map(str, settings))
        tables.append(Table("robots", f"Real-time factor: {workload.name}", columns, tuple(rows)))
    return tables


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
        times = by_turns({"run": turn(engine, ROVERS, count, span)}, size.repeats)["run"]
        rows.append((count, span / median(times), span / max(times), received[0]))
    columns = ("rovers", "real-time factor", "slowest turn", "messages received")
    title = "Rovers with CENIC at accuracy 1e-2, joint_states delivered at 50 Hz"
    return [Table("real time", title, columns, tuple(rows))]


SECTIONS: Mapping[str, Callable[[Size], list[Table]]] = {
    "engines": engines,
    "equal-error": equal_error,
    "overhead": overhead,
    "features": features,
    "precision": precision,
    "robots": robots,
    "real-time": real_time,
    "startup": startup,
    "sensors": sensors,
    "sweep": sweep,
}
