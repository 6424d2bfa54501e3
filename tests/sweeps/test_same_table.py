"""Two hundred episodes of two rovers: the same table but for the wall time, however they are run."""

import hashlib
import os
import random
import signal
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from network import network_of_its_own
from sweep_files import finished, program

from drake_twin import run
from drake_twin.builder.demo import demo_scenario
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.sweeps.engine import Engine
from drake_twin.sweeps.episode import Sweep
from drake_twin.sweeps.metrics import Metric
from drake_twin.sweeps.results import Results
from drake_twin.sweeps.variation import Design, Variation

VARY = ("friction=0.1:1.0:10", "robot_1.payload=0:4:5", "robot_1.x=0,0.5")
DURATION = 0.2
COMMAND = ("two.yaml", *(item for vary in VARY for item in ("--vary", vary)), "--seeds", "2")
COMMAND += ("--duration", str(DURATION), "--metric", "distance", "--metric", "energy")

pytestmark = pytest.mark.slow


def digest(file):
    """A hash of a table but for its wall time."""
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(file)
    assert table.num_rows == 200
    said = repr(table.schema.metadata) + repr(table.drop_columns("wall_time").to_pydict())
    return hashlib.sha256(said.encode()).hexdigest()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("same")
    (folder / "two.yaml").write_text(scenario_to_yaml(demo_scenario("rover", 2)))
    one = finished(folder, *COMMAND, "--workers", "1", "--out", "one.parquet", timeout=1000)
    assert one.returncode == 0, one.stderr
    return folder


@pytest.mark.parametrize("workers", [2, 3])
def test_with_more_workers(folder, workers):
    more = finished(folder, *COMMAND, "--workers", str(workers), "--out", f"{workers}.parquet", timeout=1000)
    assert more.returncode == 0, more.stderr
    assert digest(folder / f"{workers}.parquet") == digest(folder / "one.parquet")


def test_in_another_order_and_in_pieces(folder):
    metrics = (Metric("distance"), Metric("energy"))
    design = Design(tuple(map(Variation.parse, VARY)), seeds=(0, 1))
    sweep = Sweep.of(demo_scenario("rover", 2), design, DURATION, metrics=metrics)
    results = Results(folder / "pieces.parquet", sweep)
    episodes = list(design.episodes())
    random.Random(1).shuffle(episodes)
    with Engine(sweep, 2, 100.0) as engine:
        while episodes:
            piece, episodes = episodes[:37], episodes[37:]
            for row in engine.rows(iter(piece)):
                results.add(row)
    results.close()
    assert digest(folder / "pieces.parquet") == digest(folder / "one.parquet")


def test_interrupted_killed_and_resumed(folder):
    journal = folder / "stopped.parquet.journal"
    for number, least, code in ((signal.SIGINT, 40, 130), (signal.SIGKILL, 110, -9)):
        stopped = program(folder, *COMMAND, "--workers", "2", "--out", "stopped.parquet")
        while stopped.poll() is None and (not journal.exists() or journal.read_bytes().count(b"\n") <= least % 70):
            pass
        stopped.send_signal(number)
        stopped.communicate()
        assert stopped.returncode == code
    last = finished(folder, *COMMAND, "--workers", "3", "--out", "stopped.parquet", timeout=1000)
    assert last.returncode == 0, last.stderr
    assert digest(folder / "stopped.parquet") == digest(folder / "one.parquet")


@pytest.mark.skipif(find_spec("ray") is None, reason="needs Ray: pip install '.[ray]'")
def test_with_ray(folder):
    root = str(Path(__file__).resolve().parents[2])
    command = (*COMMAND, "--workers", "2", "--engine", "ray", "--out", "ray.parquet")
    with network_of_its_own() as network:
        network.run(
            *(sys.executable, "-m", "drake_twin.sweep", *command),
            cwd=folder,
            env={**os.environ, "PYTHONPATH": root},
        )
    assert digest(folder / "ray.parquet") == digest(folder / "one.parquet")


def test_twenty_rows_are_run_again_alone(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    for number in random.Random(2).sample(range(200), 20):
        assert run.main(["--headless", "--episode", f"one.parquet:{number}"]) == 0
        assert f"row {number}: the same state as in the table, to the last bit" in "".join(capsys.readouterr())
