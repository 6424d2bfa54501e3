"""The longest physics step with which a scenario moves as with a short one, by trial runs."""

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from pydrake.multibody.tree import ModelInstanceIndex

from drake_twin.dataclass import dataclass
from drake_twin.errors import TwinError
from drake_twin.progress import tell
from drake_twin.scenario import DISCRETE, Scenario, ScenarioError
from drake_twin.twin.twin import Twin

SHORT = 0.001  # s; what the others are compared with, unless the scenario's own step is shorter
LONGER = (0.01, 0.005, 0.004, 0.002)  # s
ERROR = 0.01  # m or rad
TIME = 1.0  # s of simulation time of a trial
_LOOKS = 10  # in a trial
_GRID = 0.02  # s, of the times at which trials are compared: a multiple of each step


@dataclass(frozen=True)
class Trial:
    """A step that was tried.

    Attributes:
        time_step: The step (s).
        error: The largest difference from the short step's run (m or rad), up to where it exceeded what is allowed;
            None where the scenario does not run with this step.
        where: What differs by that, or why it does not run.
        gain: The processor time of the short step's run ÷ that of this one; None where it did not run to its end.
    """

    time_step: float
    error: float | None
    where: str
    gain: float | None


@dataclass(frozen=True)
class LongestStep:
    """What `longest_step` has found.

    Attributes:
        time_step: The step (s).
        short: The step that the others were compared with (s).
        error: The allowed difference (m or rad).
        time: The simulation time of the trials (s).
        trials: The longer steps that were tried, the longest first; the last one may be the one that was chosen.
    """

    time_step: float
    short: float
    error: float
    time: float
    trials: tuple[Trial, ...]

    def __str__(self) -> str:
        limit = f"{self.error:g} m or rad of {self.short:g} s in the first {self.time:g} s"
        refused = [each for each in self.trials if each.gain is None]
        more = ""
        if refused:
            nearest = refused[-1]
            differs = "" if nearest.error is None else f" differs by {nearest.error:.2g}"
            more = f" (with {nearest.time_step:g} s: {nearest.where}{differs})"
        if self.time_step == self.short:
            return f"time step {self.time_step:g} s: no longer one stays within {limit}{more}"
        chosen = self.trials[-1]
        return (
            f"time step {self.time_step:g} s: within {limit}, at most {chosen.error:.2g} at {chosen.where};"
            f" 1/{chosen.gain:.1f} of the processor time{more}"
        )


def longest_step(scenario: Scenario, *, error: float = ERROR, duration: float = TIME) -> LongestStep:
    """Return the longest step with which a scenario moves as with 1 ms.

    It runs with 1 ms (or its own step, if that is shorter), and with longer steps, the longest first, until one stays
    near: all coordinates of joints, and the places and directions of what is free, are compared ten times. What is
    chosen depends on the scenario alone, and is the same in each process. Node programs are not started: what they
    would command is not in it.

    Args:
        scenario: The scenario, with the engine ``discrete``.
        error: The largest difference that is allowed (m or rad).
        duration: The simulation time of a trial (s).

    Raises:
        ScenarioError: If the engine has an error control of its own, or the scenario cannot be built.
    """
    if scenario.engine != DISCRETE:
        raise ScenarioError(("time_step",), f"the engine {scenario.engine} finds its steps itself, by its accuracy")
    scenario = replace(scenario, nodes=())
    short = min(SHORT, scenario.time_step)
    tell(f"tries a step of {short:g} s")
    with Twin(replace(scenario, time_step=short)) as twin:
        names, looks = _names(twin), _looks(twin, duration)
        reference = [(_coordinates(twin), spent) for spent in looks]
    trials: list[Trial] = []
    for step in LONGER:
        tell(f"tries a step of {step:g} s")
        trials.append(_trial(scenario, step, (names, reference), error, duration))
        if trials[-1].gain is not None:
            return LongestStep(step, short, error, duration, tuple(trials))
    return LongestStep(short, short, error, duration, tuple(trials))


def _trial(
    scenario: Scenario,
    step: float,
    short: tuple[list[str], list[tuple[np.ndarray, float]]],
    error: float,
    duration: float,
) -> Trial:
    names, reference = short
    largest, where, gain = 0.0, "nothing that moves", 1.0
    try:
        with Twin(replace(scenario, time_step=step)) as twin:
            for spent, (expected, needed) in zip(_looks(twin, duration), reference, strict=True):
                differences = _differences(twin, _coordinates(twin), expected)
                gain = needed / max(spent, 1e-9)
                if (now := float(differences.max(initial=0.0))) > largest:
                    largest, where = now, names[int(np.argmax(differences))]
                if largest > error:
                    return Trial(step, largest, where, None)
    except TwinError as refused:
        return Trial(step, None, str(refused), None)
    return Trial(step, largest, where, gain)


def _looks(twin: Twin, duration: float) -> Iterator[float]:
    """Run a twin, and yield the processor time (s) of its steps at each look."""
    spent = 0.0
    for count in sorted({max(1, round(duration * look / _LOOKS / _GRID)) for look in range(1, _LOOKS + 1)}):
        start = time.process_time()
        twin.advance_to(count * _GRID)
        spent += time.process_time() - start
        yield spent


def _coordinates(twin: Twin) -> np.ndarray:
    return np.array(twin.plant.GetPositions(twin.plant.GetMyContextFromRoot(twin.context)))


def _names(twin: Twin) -> list[str]:
    """Return the names of the coordinates, each with its model's."""
    plant = twin.plant
    names = plant.GetPositionNames(add_model_instance_prefix=True, always_add_suffix=False)
    models = [plant.GetModelInstanceName(ModelInstanceIndex(index)) for index in range(plant.num_model_instances())]
    doubled = {f"{model}_{model}_": f"{model}_" for model in models}  # joints have their robot's name already
    return [
        next((name.replace(*each, 1) for each in doubled.items() if name.startswith(each[0])), name) for name in names
    ]


def _differences(twin: Twin, found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the differences of coordinates (rad or m); those of a quaternion are the angle between the two."""
    differences = np.abs(found - expected)
    plant = twin.plant
    for body in map(plant.get_body, plant.GetFloatingBaseBodies()):
        if body.has_quaternion_dofs():
            turn = slice(body.floating_positions_start(), body.floating_positions_start() + 4)
            cosine = abs(float(np.dot(found[turn], expected[turn])))
            differences[turn] = 2 * np.arccos(min(cosine, 1.0))
    return np.asarray(np.nan_to_num(differences, nan=np.inf))
