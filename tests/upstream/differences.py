"""Where the twin differs from upstream's assertions on purpose, and what waits for another branch."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Difference:
    """What the twin does instead, and why."""

    twin: Any
    because: str


_IMMUTABLE_GAINS = "gains of a Pid are immutable: a new Pid is made, and bad limits raise, where upstream keeps the old"

DELIBERATE: dict[tuple[str, int], Difference] = {
    ("control_toolbox/test/pid_tests.cpp", 80): Difference(True, _IMMUTABLE_GAINS),
    ("control_toolbox/test/pid_tests.cpp", 326): Difference(True, _IMMUTABLE_GAINS),
}

# (file, line) of assertions that hold when the named branch is merged; each is a strict xfail until then.
WAITING: dict[tuple[str, int], str] = {}
