"""Random sessions: replayed in another process, and gone on with from a moment in their middle, to the last bit."""

import contextlib
import json
import subprocess
import sys

import numpy as np
import pytest
from random_use import RandomUse, build, write_files

from drake_twin.errors import TwinError
from drake_twin.scenario import Robot

WORKER = """
import json, sys
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay
for file in json.load(sys.stdin):
    print(replay(Recording.load(file)).state_sha256(), flush=True)
"""


class RandomSession(RandomUse):
    """Calls of the whole twin, too."""

    def __init__(self, twin, generator, robot):
        super().__init__(twin, generator)
        self._robot, self._count = robot, 0

    def call(self):
        if self.random.random() < 0.75:
            return super().call()
        name = str(self.random.choice(["spawn", "delete", "step_length", "push", "put", "burst"]))
        getattr(self, name)()
        return name

    def spawn(self):
        self._count += 1
        self.twin.entities.spawn(Robot(f"new_{self._count}", str(self._robot), xyz=(-5.0 * self._count, 0.0, 2.0)))

    def delete(self):
        self.twin.entities.delete(f"new_{int(self.random.integers(1, 4))}")

    def step_length(self):
        self.twin.clock.set_time_step(float(self.random.choice([0.001, 0.002, 0.004])))

    def push(self):
        force = self.random.normal(0.0, 5.0, 3)
        self.twin.entities.apply_wrench("used::link_elbow", force=force, duration=float(self.random.uniform(0.0, 0.3)))

    def put(self):
        self.twin.entities.set_state("new_1", position=np.add(self.random.normal(0.0, 1.0, 3), (-5.0, 0.0, 2.0)))

    def burst(self):
        """Messages to controllers that listen: several of them wait for the next step."""
        active = self.manager.active
        topics = [topic for topic, item in self.twin.built.commanded.items() if item.robot == "used"]
        for topic in (topic for topic in topics if self.twin.built.commanded[topic].controller in active):
            self.twin.publish(topic, self.message(topic))


def session(files, seed, middle, folder):
    """Two recordings of the same session, one from the start and one from its middle on, and its end's hash."""
    recorded = []
    for start in (0, middle):
        twin = build(files)
        use = RandomSession(twin, np.random.default_rng(seed), files[0])
        for count in range(20):
            if count == start == 0:
                twin.recorder.begin()
            for _ in range(use.random.integers(1, 4)):
                with contextlib.suppress(TwinError):
                    use.call()
            with contextlib.suppress(TwinError):
                use.burst()
            if count == start > 0:  # while commands wait
                twin.recorder.begin()
            twin.play()
            twin.advance_to(twin.time + float(use.random.exponential(0.06)))
        file = folder / f"{seed}_from_{start}.json"
        twin.recorder.recording().save(file)
        recorded.append((str(file), twin.state_sha256()))
    assert recorded[0][1] == recorded[1][1], "recording changes the run"
    return recorded


def check(files, seeds, folder):
    recorded = [
        item
        for seed in seeds
        for item in session(files, seed, int(np.random.default_rng(1000 + seed).integers(1, 19)), folder)
    ]
    again = subprocess.run(
        [sys.executable, "-c", WORKER],
        input=json.dumps([file for file, _ in recorded]),
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    wrong = [file for (file, before), after in zip(recorded, again, strict=True) if before != after]
    assert not wrong
    assert len({before for _, before in recorded}) == len(list(seeds)), "the sessions are not different ones"


def test_random_sessions_are_replayed_in_another_process_from_the_start_and_from_a_moment_in_the_middle(tmp_path):
    check(write_files(tmp_path), range(6), tmp_path)


@pytest.mark.slow
def test_a_hundred_random_sessions_are_replayed(tmp_path):
    check(write_files(tmp_path), range(100), tmp_path)
