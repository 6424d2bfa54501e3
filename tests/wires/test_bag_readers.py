"""One bag, three readers that nobody here wrote: rosbags, mcap-ros2-support and, in JavaScript, @mcap/core."""

import json
import os
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from conftest import rovers
from rosbags.highlevel import AnyReader
from wires.foxglove_peer import npm_modules
from wires.mcap_peer import decoded_messages

from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.seam import Seam

STATES = "/robot_2/joint_states"
PACKAGES = ("@mcap/core", "fzstd", "@foxglove/rosmsg", "@foxglove/rosmsg2-serialization")
SCRIPT = Path(__file__).with_name("read_bag.cjs")


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """A bag of two driven rovers, and the positions that the twin published."""
    folder, positions = tmp_path_factory.mktemp("bags") / "bag", []
    with rovers(2).build() as twin:
        twin.publish("/robot_2/forward_velocity_controller/commands", [2.0, 3.0, 2.0, 3.0])
        twin.subscribe(STATES, lambda message: positions.append(list(message.position)))
        seam = Seam(twin, [BagWire(folder)])
        twin.advance_to(2.0)
        seam.close()
    return folder, positions


@pytest.fixture(scope="module")
def by_rosbags(bag):
    counts, times, positions = Counter(), [], []
    with AnyReader([bag[0]]) as reader:
        for connection, time, data in reader.messages():
            counts[connection.topic] += 1
            if connection.topic == STATES:
                times.append(time)
                positions.append(list(reader.deserialize(data, connection.msgtype).position))
    return {"counts": counts, "times": times, "positions": positions}


def test_rosbags_reads_what_the_twin_published(bag, by_rosbags):
    assert by_rosbags["positions"] == bag[1]
    assert by_rosbags["times"] == [10_000_000 * index for index in range(200)]


def test_mcap_ros2_support_reads_the_same(bag, by_rosbags):
    found = list(decoded_messages(bag[0] / "bag.mcap"))
    states = [item for item in found if item.channel.topic == STATES]
    assert Counter(item.channel.topic for item in found) == by_rosbags["counts"]
    assert [item.message.log_time for item in states] == by_rosbags["times"]
    assert [list(item.decoded_message.position) for item in states] == by_rosbags["positions"]


def test_mcap_core_reads_the_same(bag, by_rosbags):
    environment = os.environ | {"NODE_PATH": str(npm_modules(*PACKAGES))}
    command = ["node", str(SCRIPT), str(bag[0] / "bag.mcap"), STATES]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=100, check=False)
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout) == {"profile": "ros2", **by_rosbags}
