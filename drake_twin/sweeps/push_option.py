"""The option ``--push`` of a sweep: forces that push robots."""

import re
from collections.abc import Iterable
from dataclasses import replace

from drake_twin.errors import InputError
from drake_twin.scenario import PUSH_DURATION, Push, Scenario, ScenarioError

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_PUSH = re.compile(
    rf"(?P<entity>[^=]+)=(?P<force>{_NUMBER}(?:,{_NUMBER},{_NUMBER})?)N"
    rf"@(?P<time>{_NUMBER})s(?:\+(?P<duration>{_NUMBER})s)?"
)


def read_push(text: str) -> Push:
    """Read ``ROBOT[.LINK]=20N@1s``, ``=20,0,5N@1s``, each with ``+0.2s`` for another duration than the default.

    Raises:
        InputError: If the text is not one of these.
    """
    found = _PUSH.fullmatch(text.replace(" ", ""))
    if found is None:
        example = "robot_1=20N@1s, robot_1.base_link=20,0,5N@1s+0.2s"
        raise InputError(f"--push {text}: it must read ROBOT[.LINK]=FORCE@TIME[+DURATION], for example {example}")
    force = [float(number) for number in found["force"].split(",")]
    return Push(
        entity=found["entity"].replace(".", "::", 1),
        time=float(found["time"]),
        force=(force[0], force[1], force[2]) if len(force) == 3 else None,
        strength=force[0] if len(force) == 1 else None,
        duration=PUSH_DURATION if found["duration"] is None else float(found["duration"]),
    )


def with_pushes(scenario: Scenario, texts: Iterable[str], duration: float) -> Scenario:
    """Return a scenario with further pushes.

    Args:
        scenario: The scenario.
        texts: The values of ``--push``.
        duration: The simulated time of an episode (s).

    Raises:
        InputError: If a push cannot be used, or begins after the end of the episode.
    """
    for text in texts:
        push = read_push(text)
        try:
            scenario = replace(scenario, pushes=(*scenario.pushes, push))
        except ScenarioError as error:
            raise InputError(f"--push {text}: {error.reason}", **error.more) from None
        if push.time >= duration:
            raise InputError(f"--push {text}: it begins at {push.time:g} s, but an episode ends at {duration:g} s")
    return scenario
