"""The log of an episode's states against the twin's own reading of the same run, sample by sample."""

import numpy as np
import pytest
from conftest import ARM, ROVER

from drake_twin import Twin, TwinBuilder
from drake_twin.cli.history import HistoryRecorder
from drake_twin.sweeps.state_log import StateLog

WHEELS = "/rover/forward_velocity_controller/commands"


def driven():
    builder = TwinBuilder().robot("rover", ROVER, xyz=(0, 2, 0)).robot("arm", ARM)
    return builder.command(WHEELS, [1.0, 2.0, 3.0, 4.0], time=0.2).scenario()


@pytest.mark.parametrize("with_efforts", [True, False])
def test_it_is_what_the_twin_reads(with_efforts):
    log = StateLog(with_efforts=with_efforts)
    twin = Twin(driven(), extensions=[log])
    for _ in range(2):
        recorder = HistoryRecorder(with_efforts=with_efforts)
        recorder.record(twin)
        twin.advance_to(1.0)
        twin.step(1)  # what is due at the end is delivered at the next advance
        found, read = log.history(twin), recorder.history()
        assert found.robots.keys() == read.robots.keys()
        for name, robot in read.robots.items():
            own = found.robots[name]
            assert (own.joints, own.units) == (robot.joints, robot.units)
            assert own.times == pytest.approx(robot.times)
            for field in ("positions", "velocities", "efforts", "base_poses"):
                assert getattr(own, field) == pytest.approx(getattr(robot, field), abs=1e-9), (name, field)
            assert robot.efforts.any() == with_efforts
        assert np.ptp(found.robots["rover"].base_poses[:, 0]) > 0.05
        twin.reset()
        log.restart(twin)


def test_a_twin_with_a_log_is_the_same_to_the_bit():
    plain, logged = Twin(driven()), Twin(driven(), extensions=[StateLog(with_efforts=True)])
    for twin in (plain, logged):
        twin.advance_to(1.0)
    assert plain.state_sha256() == logged.state_sha256()


def test_a_long_run_is_thinned_out(monkeypatch):
    monkeypatch.setattr("drake_twin.sweeps.state_log.MOST_SAMPLES", 20)
    log = StateLog(with_efforts=False)
    twin = Twin(driven(), extensions=[log])
    twin.advance_to(1.0)
    times = log.history(twin).robots["arm"].times
    assert 10 <= len(times) <= 20
    assert np.diff(times) == pytest.approx(0.08)
