"""Outcomes of an episode: what its robots and its condition come to."""

import pytest
from conftest import ROVER

from drake_twin.scenario import Robot, Scenario, World
from drake_twin.sweeps.episode import Runner, Sweep
from drake_twin.sweeps.metrics import Condition
from drake_twin.sweeps.variation import Design


@pytest.fixture
def early(tmp_path):
    """A condition that holds at the third look."""
    (tmp_path / "early.py").write_text("def early(twin):\n    return twin.time > 0.12\n")
    return f"{tmp_path}/early.py:early"


@pytest.mark.parametrize(
    ("height", "until", "outcome", "simulated"),
    [
        (0.0, None, "done", 0.2),
        (-0.95, None, "fell", 0.2),
        (0.0, "fell", "timeout", 0.2),
        (-0.95, "fell", "fell", 0.15),  # g t² / 2 is 0.05 m after a tenth of a second
        (0.0, "early", "done", 0.15),
        (-0.95, "early", "fell", 0.15),
    ],
)
def test_what_becomes_of_a_rover_that_falls_below_the_world_or_not_yet(early, height, until, outcome, simulated):
    scenario = Scenario((Robot("rover", ROVER, xyz=(0, 0, height)),), world=World(ground=False))
    condition = None if until is None else Condition(early if until == "early" else until)
    sweep = Sweep.of(scenario, Design(()), 0.2, until=condition)
    (episode,) = sweep.design.episodes()
    runner = Runner(sweep)
    row = runner.run(episode)
    runner.close()
    assert (row["outcome"], row["reason"], row["simulated"]) == (outcome, "", pytest.approx(simulated))
