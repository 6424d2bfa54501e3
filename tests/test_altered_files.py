"""Saved states and recordings that somebody has altered: each is refused in words, or can be used."""

import copy
import json
import random

import pytest
from conftest import ARM, rovers

from drake_twin.errors import TwinError
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay
from drake_twin.twin.snapshot import Snapshot

VALUES = [
    *(None, True, -1, 0, 1e308, -1e-320, "x", "", [], {}, [1, 2], {"a": 1}, "0" * 50, 10**400),
    {"!": "tuple", "items": []},
    {"!": "float", "value": "nan"},
    {"!": "Sample@1"},
    {"!": "array", "type": "<f8", "shape": [99], "data": [1.0]},
    {"!": "array", "type": "O", "shape": [1], "data": [1]},
]


def scene():
    return rovers(2).robot("arm", ARM, xyz=(5, 0, 0)).build()


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder, twin = tmp_path_factory.mktemp("saved"), scene()
    twin.recorder.begin()
    twin.publish("/robot_1/forward_velocity_controller/commands", [1, 2, 3, 4])
    twin.advance_to(0.2)
    twin.snapshot().save(folder / "state.json")
    twin.recorder.recording().save(folder / "run.json")
    return [json.loads((folder / name).read_text()) for name in ("state.json", "run.json")]


def places(data, above=()):
    """The path of each value in plain data."""
    for key, item in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield (*above, key)
        yield from places(item, (*above, key))


def alter(data, chance):
    """Alters one value, takes it away or puts one beside it."""
    changed = copy.deepcopy(data)
    *above, last = chance.choice(list(places(data)))
    item = changed
    for key in above:
        item = item[key]
    match chance.randrange(5):
        case 0:
            del item[last]
        case 1 if isinstance(item, list):
            item.insert(last, chance.choice(VALUES))
        case 1:
            item[chance.choice(["x", "!", "topic", "state"])] = chance.choice(VALUES)
        case _:
            item[last] = chance.choice(VALUES)
    return changed


@pytest.mark.parametrize("seed", range(4))
def test_an_altered_file_is_refused_in_words_or_used(saved, tmp_path, seed):
    chance, file, twin = random.Random(seed), tmp_path / "altered.json", scene()
    state, recording = saved
    refused = 0
    for _ in range(25):
        file.write_text(json.dumps(alter(state, chance)))
        try:
            twin.restore(Snapshot.load(file))
            twin.step(3)
        except TwinError:
            refused += 1
    for _ in range(5):
        file.write_text(json.dumps(alter(recording, chance)))
        try:
            replay(Recording.load(file)).step(3)
        except TwinError:
            refused += 1
    assert 0 < refused < 30
    twin.reset()
    twin.step(3)  # and the twin goes on
