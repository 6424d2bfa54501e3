"""Runs that repeat: from a snapshot, and from a recording."""

from pathlib import Path

from drake_twin import Twin
from drake_twin.recording import Recording, replay


def goes_on_to_the_same_bits(twin: Twin, folder: Path, snapshot_at: float = 0.5) -> None:
    """Checks that a twin whose recorder has begun ends alike at 1 s after its snapshot is restored, and as a replay."""
    twin.advance_to(snapshot_at)
    snapshot = twin.snapshot()
    twin.advance_to(1.0)
    end = twin.state_sha256()
    twin.recorder.recording().save(folder / "run.json")
    twin.restore(snapshot)
    twin.advance_to(1.0)
    assert twin.state_sha256() == end
    assert replay(Recording.load(folder / "run.json")).state_sha256() == end
