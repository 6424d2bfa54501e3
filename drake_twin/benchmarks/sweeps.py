"""A sweep over friction beside MuJoCo: episodes a second of one process, at equal step and at equal accuracy."""

from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np

from drake_twin.benchmarks.engine import Setting, drive
from drake_twin.benchmarks.measure import by_turns, ratio, whole
from drake_twin.benchmarks.report import Table
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.workloads import LONGEST_GRID, LOOK_AT, SAME_ERROR, WORKLOADS
from drake_twin.scenario import CENIC, DISCRETE
from drake_twin.sweeps.episode import DONE, Runner, Sweep
from drake_twin.sweeps.variation import Design, Variation

_ROVERS, _COUNT = WORKLOADS["cruising rovers"], 2
_EQUAL_STEP = (Setting("twin", 0.001), Setting("MuJoCo", 0.001))
_FINEST = (Setting("twin", 0.00005), Setting("twin, cenic", LONGEST_GRID, 1e-8), Setting("MuJoCo", 0.00001))
_TRIED = (
    *(Setting("twin", step) for step in (0.01, 0.001, 0.0005, 0.0002)),
    *(Setting("twin, cenic", LONGEST_GRID, accuracy) for accuracy in (1e-4, 1e-5, 1e-6, 3e-7, 1e-7)),
    *(Setting("MuJoCo", step) for step in (0.002, 0.001, 0.0005, 0.0002, 0.0001, 0.00005)),
)


def sweep(size: Size) -> list[Table]:
    """Measure episodes a second: a twin that is reset, and a model of MuJoCo that is reset, with the same values."""
    pairs = {"equal step": _EQUAL_STEP, "equal accuracy": _equally_accurate(size)}
    episodes = max(2, round(8 * size.scale))
    duration = whole(LOOK_AT * min(1.0, size.scale), LONGEST_GRID)
    cases = {
        str(setting): (_in_mujoco if setting.engine == "MuJoCo" else _in_twin)(setting, size, episodes, duration)
        for setting in dict.fromkeys(setting for pair in pairs.values() for setting in pair)
    }
    for case in cases.values():
        case()  # the first episode builds
    times = by_turns(cases, size.repeats)
    rows = []
    for name, (ours, theirs) in pairs.items():
        rates = [episodes / median(times[str(setting)]) for setting in (ours, theirs)]
        quotient = ratio(times, str(theirs), str(ours))
        rows.append((name, str(ours), rates[0], str(theirs), rates[1], quotient))
    columns = ("at", "twin's setting", "episodes/s", "MuJoCo's setting", "episodes/s", "twin ÷ MuJoCo")
    title = f"A sweep over friction: {_COUNT} cruising rovers, episodes of {duration:g} s, one process"
    return [Table("sweep", title, columns, tuple(rows))]


def _equally_accurate(size: Size) -> tuple[Setting, Setting]:
    """Return the fastest settings of both whose joints are as near to the engine's own finest run as asked for.

    Where none is, the nearest.
    """
    finest, tried = _FINEST, _TRIED
    if size.scale < 0.5:
        finest = (Setting("twin", 0.001), Setting("twin, cenic", LONGEST_GRID, 1e-3), Setting("MuJoCo", 0.001))
        tried = (Setting("twin", 0.01), Setting("twin, cenic", LONGEST_GRID, 1e-2), Setting("MuJoCo", 0.002))
    truths = {setting.engine: _positions(setting, size) for setting in finest}
    errors: dict[Setting, float] = {}
    times: dict[str, list[float]] = {}
    for setting in tried:
        case = partial(_positions, setting, size)
        errors[setting] = float(np.abs(case() - truths[setting.engine]).max())
        times |= by_turns({str(setting): case}, 1)
    chosen = []
    for is_mujoco in (False, True):
        own = [setting for setting in tried if (setting.engine == "MuJoCo") == is_mujoco]
        good = [setting for setting in own if errors[setting] <= SAME_ERROR]
        best = min(good, key=lambda setting: times[str(setting)][0], default=min(own, key=errors.__getitem__))
        chosen.append(best)
    return chosen[0], chosen[1]


def _positions(setting: Setting, size: Size) -> np.ndarray:
    engine = setting.make(_ROVERS, _COUNT, size.folder)
    drive(engine, _ROVERS, _COUNT, 0.0, LOOK_AT)
    return engine.positions()


def _in_twin(setting: Setting, size: Size, count: int, duration: float) -> Callable[[], None]:
    engine, accuracy = (DISCRETE, 1e-3) if setting.accuracy is None else (CENIC, setting.accuracy)
    scenario = _ROVERS.scenario(_COUNT, size.folder, time_step=setting.step, engine=engine, accuracy=accuracy)
    design = Design((Variation.parse(f"friction=0.5:0.9:{count}"),))
    one = Sweep.of(_ROVERS.scheduled(scenario, 0.0), design, duration)
    runner = Runner(one)

    def run() -> None:
        outcomes = {runner.run(episode)["outcome"] for episode in design.episodes()}
        assert outcomes == {DONE}

    return run


def _in_mujoco(setting: Setting, size: Size, count: int, duration: float) -> Callable[[], None]:
    from drake_twin.benchmarks.engines.mujoco import MujocoEngine  # needs the extra, which --help and --version do not

    engine = setting.make(_ROVERS, _COUNT, size.folder)
    assert isinstance(engine, MujocoEngine)

    def run() -> None:
        for friction in np.linspace(0.5, 0.9, count):
            engine.reset(float(friction))
            drive(engine, _ROVERS, _COUNT, 0.0, duration)

    return run
