"""What a run that is slow is told: where its time goes, and what makes it faster."""

import contextlib
import sys
import time
from typing import TYPE_CHECKING

from drake_twin.errors import RunError
from drake_twin.program import say
from drake_twin.scenario import DISCRETE

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin

_SLOW = 0.5  # real-time factor
_AFTER = 5.0  # s of wall time
_MUCH = 0.3  # of a step's time
_NAMED = 0.1  # of all facets and points: pairs with more are named
_MOST_NAMED = 3  # sensors


class SlowNotice:
    """Tells once where the time of a run goes, if it is slower than half of real time for its first seconds.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: "Twin"):
        self._twin = twin
        self._begin = _now(twin)
        self._is_open = twin.scenario.engine == DISCRETE

    def look(self) -> None:
        """Look at the time; called between steps."""
        if not self._is_open:
            return
        wall, spent, simulated = (now - then for now, then in zip(_now(self._twin), self._begin, strict=True))
        if wall < _AFTER:
            return
        if self._twin.clock.paused or self._twin.clock.real_time_rate < 1.0 or simulated <= 0.0:
            self._begin = _now(self._twin)
            return
        self._is_open = False
        if simulated < _SLOW * wall:
            with contextlib.suppress(RunError):  # the next step fails, which says why
                why = slow_text(self._twin, spent / simulated)
                say(f"slow: {simulated / wall:.2g} times real time {why}", sys.stderr)


def _now(twin: "Twin") -> tuple[float, float, float]:
    """Return wall time, processor time and simulated time (s)."""
    return time.perf_counter(), time.process_time(), twin.clock.simulated


def slow_text(twin: "Twin", spent: float) -> str:
    """Return what makes a twin slow, and what makes it faster.

    Args:
        twin: The twin, between steps.
        spent: The processor time of a simulated second (s).
    """
    from drake_twin.twin.step_costs import step_costs

    costs = step_costs(twin)
    whole = spent * twin.clock.time_step
    physics, contact = (min(1.0, part / whole) for part in (costs.step, costs.contact))
    parts = [f"physics {physics:.0%} of it, {contact:.0%} to find where shapes touch"]
    advice = []
    if physics > _MUCH:
        total = sum(costs.pairs.values())
        most = [f"{one} and {other}: {count}" for (one, other), count in costs.pairs.items() if count > _NAMED * total]
        if total:
            parts.append(f"they touch in {total} facets and points, of {len(costs.pairs)} pairs" + _among(most))
        advice.append("--time-step auto")
        if costs.has_faces:
            advice.append("contact: point where faces do not matter")
    if physics < 1.0 - _MUCH:
        measuring = [f"{owner}/{plan.place}" for owner, plan in twin.entities.sensors if plan.rate]
        parts.append(f"messages, sensors, nodes and page {1 - physics:.0%}" + _among(measuring[:_MOST_NAMED]))
        advice.append("lower rates, smaller pictures, --headless")
    return f"({'; '.join(parts)}). Faster: {'; '.join(advice)}."


def _among(names: list[str]) -> str:
    return f" ({', '.join(names)})" if names else ""
