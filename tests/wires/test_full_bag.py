"""A bag on a full disk: whole with what fits, said, and an exit code."""

import io
import json
import os
import resource
import subprocess
import sys
from collections import Counter
from errno import EIO
from pathlib import Path

import numpy as np
import pytest
from conftest import rovers
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from wires.test_bag_writer import CHATTER, record

from drake_twin.errors import InputError, RunError
from drake_twin.wires import whole_bag
from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.bag_writer import MESSAGE, TOPIC, write_bag
from drake_twin.wires.seam import Seam

ANOTHER = {**CHATTER, "name": "/another"}
TOPICS = {1: "/chatter", 2: "/another"}


def noise(number, time):
    """Return what zstd does not make smaller."""
    return np.random.default_rng([number, time]).bytes(50_000)


def run_limited(words, size, **more):
    """Run a program that can write no file of more bytes; nor modules, which Python 3.11 would cut off."""
    return subprocess.run(
        words,
        capture_output=True,
        timeout=60,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        **more,
    )


def stream():
    """100 messages of each topic, 10 MB."""
    yield record(TOPIC, 1, 0, json.dumps(CHATTER).encode())
    yield record(TOPIC, 2, 0, json.dumps(ANOTHER).encode())
    for time in range(100):
        for number in TOPICS:
            yield record(MESSAGE, number, time, noise(number, time))


@pytest.mark.parametrize("size", [5_000, 1_100_000, 5_000_000, 9_437_000])
def test_a_bag_that_does_not_fit_is_whole_up_to_a_moment(tmp_path, size):
    folder = tmp_path / "bag"
    words = [sys.executable, "-m", "drake_twin.wires.bag_writer", str(folder)]
    result = run_limited(words, size, input=b"".join(stream()))
    assert result.returncode == 1
    with AnyReader([folder]) as reader:
        found = [(item.topic, time, bytes(data)) for item, time, data in reader.messages()]
        told = {topic: info.msgcount for topic, info in reader.topics.items()}
        end = reader.end_time
    sent = [(topic, time, noise(number, time)) for time in range(100) for number, topic in TOPICS.items()]
    assert sorted(found) == sorted(sent[: len(found)])
    assert told == {name: Counter(topic for topic, *_ in found)[name] for name in TOPICS.values()}
    with (folder / "bag.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_summary().statistics.message_count == len(found)
        assert sum(1 for _ in reader.iter_messages()) == len(found)
    assert (folder / "bag.mcap").stat().st_size <= size
    kept = f"{len(found)} messages are kept, the last of" if found else "no message is kept"
    assert result.stdout.decode().startswith(f"File too large; {kept}")
    assert len(found) > (size - 2_200_000) / 50_000
    assert not found or found[-1][1] in (end, end - 1)


def test_a_bag_whose_disk_fails_is_whole_up_to_there(tmp_path, monkeypatch):
    write, calls = whole_bag._File.write, []

    def fail(file, data):
        calls.append(len(data))
        if sum(calls) > 3_000_000:
            calls.append(-(10**9))  # once
            raise OSError(EIO, os.strerror(EIO))
        return write(file, data)

    monkeypatch.setattr(whole_bag._File, "write", fail)
    with pytest.raises(RunError, match=r"^Input/output error; \d+ messages are kept"):
        write_bag(str(tmp_path / "bag"), io.BytesIO(b"".join(stream())))
    with AnyReader([tmp_path / "bag"]) as reader:
        assert 30 < sum(1 for _ in reader.messages()) < 60


def test_a_run_whose_bag_is_not_complete_says_so_and_ends_with_1(tmp_path):
    words = ["--robots", "1", "--headless", "--duration", "1", "--bag", str(tmp_path / "bag")]
    program = [sys.executable, "-m", "drake_twin.run", *words, "--summary", str(tmp_path / "summary.json")]
    result = run_limited(program, 30_000)
    assert result.returncode == 1, result.stderr
    last = result.stderr.decode().splitlines()[-1]
    assert last == f"error: the bag {tmp_path / 'bag'} is not complete: File too large; no message is kept"
    assert (tmp_path / "summary.json").is_file()


def test_a_folder_that_is_removed_while_it_runs_is_a_loss(tmp_path):
    twin = rovers(1).build()
    seam = Seam(twin, [BagWire(tmp_path / "bag")])
    twin.advance_to(0.1)
    seam.flush()
    while not (tmp_path / "bag" / "bag.mcap").exists():
        os.sched_yield()
    (tmp_path / "bag" / "bag.mcap").unlink()
    (tmp_path / "bag").rmdir()
    with pytest.raises(RunError, match="is not complete: No such file or directory"):
        seam.close()


def test_a_place_where_no_folder_can_be_is_refused_before_anything_runs():
    with pytest.raises(InputError, match="the folder cannot be created"):
        BagWire(Path("/proc/bag"))


def test_the_loss_of_one_wire_ends_the_others_too():
    from drake_twin.wires.wire import Nothing, close_all

    class Lost(Nothing):
        def close(self):
            raise RunError("lost")

    class Ended(Nothing):
        is_ended = False

        def close(self):
            self.is_ended = True

    others = Ended(), Ended()
    with pytest.raises(RunError, match="lost"):
        close_all([others[0], Lost(), others[1]])
    assert all(other.is_ended for other in others)
