"""A row of a sweep's table, run again: ``python -m drake_twin.run --episode FILE:ROW``."""

import argparse
from pathlib import Path

from drake_twin.cli.target import Target
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sweeps.episode import episode_scenario
from drake_twin.sweeps.launched import LaunchFile
from drake_twin.sweeps.results import read_table
from drake_twin.sweeps.variation import Episode
from drake_twin.twin.twin import Twin
from drake_twin.versions import stamp


@dataclass(frozen=True)
class EpisodeAgain:
    """An episode that is run again.

    Attributes:
        number: Its number in the table.
        target: What to run.
        simulated: Its simulated time (s).
        state_sha256: The hash of its last state; empty if it failed.
        version: The version that it was run with.
    """

    number: int
    target: Target
    simulated: float
    state_sha256: str
    version: str

    def verdict(self, twin: Twin) -> str:
        """Say whether a twin has reached the episode's last state; empty where there is nothing to compare."""
        if not self.state_sha256 or abs(twin.time - self.simulated) > 1e-9:
            return ""
        if twin.state_sha256() == self.state_sha256:
            return f"row {self.number}: the same state as in the table, to the last bit"
        known = "" if self.version == stamp() else f" (it was run with {self.version})"
        return f"warning: row {self.number}: the state differs from the table's{known}: files have changed since"


def episode_again(options: argparse.Namespace) -> EpisodeAgain:
    """Return the episode that ``--episode`` names.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If the option, the table or the row cannot be used.
    """
    file, _, number = options.episode.rpartition(":")
    if not file or not number.isdecimal():
        raise InputError(f"--episode {options.episode}: it must read FILE:ROW, for example results.parquet:17")
    others = (options.target, options.robot, options.world, options.pub, options.load_state, options.replay)
    how = (options.robots, options.seed, options.time_step, options.engine, options.accuracy)
    if any(others) or any(item is not None for item in how):
        raise InputError(
            "--episode defines what is run: it cannot be combined with other robots, worlds, seeds, steps or engines"
        )
    definition, rows = read_table(Path(file))
    found = [row for row in rows if row["episode"] == int(number)]
    if not found:
        raise InputError(f"--episode {options.episode}: the table's {len(rows)} rows lack this number")
    row = found[0]
    episode = Episode(int(number), {path: row[path] for path, _ in definition["vary"]}, row["seed"])
    base, launch = ScenarioFile(definition["scenario"], file).scenario, LaunchFile.from_plain(definition.get("launch"))
    scenario = episode_scenario(base, launch, episode)
    simulated = row["simulated"] or definition["duration"]
    return EpisodeAgain(int(number), Target(scenario), simulated, row["state_sha256"] or "", row["version"])
