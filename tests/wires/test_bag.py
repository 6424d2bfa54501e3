"""Bags, read by readers that nobody here wrote."""

import contextlib
import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from conftest import rovers
from mcap.exceptions import EndOfFile
from mcap.records import Message
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader
from wires.mcap_peer import decoded_messages

from drake_twin import InputError, Robot, Twin
from drake_twin.cli.options import parser
from drake_twin.errors import RunError
from drake_twin.run import main
from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.kinds.bag import BagKind
from drake_twin.wires.seam import Seam

STATES = "/robot_1/joint_states"
ROVER = "package://rover_description/urdf/rover.urdf.xacro"


def written(folder, topics=(), until=1.0, meanwhile=lambda twin, wire: None):
    twin = rovers(1).build()
    twin.publish("/robot_1/forward_velocity_controller/commands", [2.0] * 4)
    positions = []
    twin.subscribe(STATES, lambda message: positions.append(list(message.position)))
    wire = BagWire(folder, topics)
    seam = Seam(twin, [wire])
    twin.advance_to(until / 2)
    meanwhile(twin, wire)
    twin.advance_to(until)
    seam.close()
    return positions


def test_two_readers_find_the_same_messages(tmp_path):
    positions = written(tmp_path / "bag")
    with AnyReader([tmp_path / "bag"]) as reader:
        counts = {topic: info.msgcount for topic, info in reader.topics.items()}
        offered = {item.topic: item.ext.offered_qos_profiles[0] for item in reader.connections}
        stamps, values = [], []
        for connection, time, data in reader.messages():
            if connection.topic == STATES:
                stamps.append(time)
                values.append(list(reader.deserialize(data, connection.msgtype).position))
    assert stamps == [10_000_000 * index for index in range(100)]
    assert values == positions
    kept = {topic: (offered[topic].depth, offered[topic].durability.name) for topic in ("/tf", "/tf_static")}
    assert kept == {"/tf": (10, "VOLATILE"), "/tf_static": (1, "TRANSIENT_LOCAL")}  # what ros2 bag play offers again
    assert counts["/clock"] == 1001  # each step, the last one too
    assert counts["/tf"] == 20
    assert counts["/robot_1/robot_description"] == 1
    assert "/model_states" not in counts
    assert "ros_distro: jazzy\n" in (tmp_path / "bag" / "metadata.yaml").read_text()
    other = [item for item in decoded_messages(tmp_path / "bag" / "bag.mcap") if item.channel.topic == STATES]
    assert [list(item.decoded_message.position) for item in other] == positions
    assert sum(1 for _ in decoded_messages(tmp_path / "bag" / "bag.mcap")) == sum(counts.values())


def test_only_the_topics_that_are_asked_for(tmp_path):
    written(tmp_path / "bag", [STATES])
    with AnyReader([tmp_path / "bag"]) as reader:
        assert list(reader.topics) == [STATES]


def test_a_robot_that_comes_later_is_in_the_bag(tmp_path):
    written(
        tmp_path / "bag",
        meanwhile=lambda twin, wire: twin.entities.spawn(Robot("late", ROVER, xyz=(0.0, 4.0, 0.13))),
    )
    with AnyReader([tmp_path / "bag"]) as reader:
        assert reader.topics["/late/joint_states"].msgcount == 50


def test_a_robot_that_comes_again_goes_on_in_the_bag(tmp_path):
    def again(twin, wire):
        late = Robot("late", ROVER, xyz=(0.0, 4.0, 0.13))
        for change in (lambda: twin.entities.spawn(late), lambda: twin.entities.delete("late")) * 2:
            change()
            twin.advance_to(twin.time + 0.1)

    written(tmp_path / "bag", meanwhile=again)
    with AnyReader([tmp_path / "bag"]) as reader:
        assert reader.topics["/late/joint_states"].msgcount == 20
        assert len(reader.topics["/late/joint_states"].connections) == 1


def test_the_end_of_the_bags_process_does_not_end_the_run(tmp_path, caplog):
    def kill(twin, wire):
        os.kill(wire._process.pid, signal.SIGKILL)
        wire._process.wait()

    with pytest.raises(RunError, match="is not complete: its process was killed by signal 9"):  # at the end
        written(tmp_path / "bag", meanwhile=kill)
    (line,) = caplog.messages
    assert line.endswith("(the run continues, and nothing more is written into the bag)")


def test_a_twin_that_is_killed_leaves_a_whole_bag(tmp_path):
    program = textwrap.dedent(
        f"""
        import os, sys
        sys.path.insert(0, {str(Path(__file__).parent.parent)!r})
        from pathlib import Path
        from conftest import rovers
        from drake_twin.wires.bag_wire import BagWire
        from drake_twin.wires.seam import Seam
        twin = rovers(1).build()
        wire = BagWire(Path({str(tmp_path / "bag")!r}))
        seam = Seam(twin, [wire])
        twin.advance_to(1.0)
        seam.flush()
        print(wire._process.pid, flush=True)
        sys.stdin.read()
        """
    )
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", program], **pipes) as twin:
        writer = int(twin.stdout.readline())
        twin.kill()
    while Path(f"/proc/{writer}").exists() and "Z" not in Path(f"/proc/{writer}/stat").read_text().split(")")[1]:
        os.sched_yield()
    with AnyReader([tmp_path / "bag"]) as reader:
        assert reader.topics[STATES].msgcount == 100


def test_a_bag_whose_writer_is_killed_can_be_read_by_readers_that_stream(tmp_path):
    def kill(twin, wire):
        os.kill(wire._process.pid, signal.SIGKILL)
        wire._process.wait()

    with pytest.raises(RunError, match="killed"):
        written(tmp_path / "bag", until=30.0, meanwhile=kill)
    found = []
    with (tmp_path / "bag" / "bag.mcap").open("rb") as file, contextlib.suppress(EndOfFile):  # where it is cut off
        found += (1 for record in StreamReader(file).records if isinstance(record, Message))
    assert len(found) > 1000


@pytest.mark.parametrize("name", ["there", "no/where"])
def test_a_folder_that_cannot_be_used_is_refused(tmp_path, name):
    (tmp_path / "there").mkdir()
    with pytest.raises(InputError, match="exist"):
        BagWire(tmp_path / name)


def test_the_program_writes_a_bag(tmp_path, capsys):
    from drake_twin.run import main

    arguments = ["--robots", "2", "--headless", "--duration", "0.5", "--bag", str(tmp_path / "bag")]
    assert main(arguments) == 0
    with AnyReader([tmp_path / "bag"]) as reader:
        assert reader.topics["/robot_2/joint_states"].msgcount == 50
        assert not [topic for topic in reader.topics if "/_action/" in topic]
    capsys.readouterr()
    assert main(arguments) == 2
    assert "the folder exists: a bag is written into a new one" in capsys.readouterr().err
    assert main([*arguments, "--watch"]) == 2
    assert main(["--robots", "1", "--headless", "--duration", "0.1", "--bag-topic", "/tf"]) == 2
    said = capsys.readouterr().err
    assert "it needs --bag FOLDER" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(("options", "expected"), [([], True), (["--real-time-rate", "4"], False)])
def test_a_run_that_only_writes_a_bag_is_as_fast_as_possible(tmp_path, monkeypatch, options, expected):
    runs = []
    monkeypatch.setattr(Twin, "run", lambda *_, as_fast_as_possible, **__: runs.append(as_fast_as_possible))
    arguments = ["--robots", "1", "--headless", "--duration", "0.1", "--bag", str(tmp_path / "bag"), *options]
    assert main(arguments) == 0
    assert runs == [expected]


def test_a_topic_that_nobody_publishes_is_a_warning_with_those_that_are(capsys):
    options = parser().parse_args(["--bag", "b", "--bag-topic", STATES, "--bag-topic", "/robot_1/joint_state"])
    with rovers(1).build() as twin:
        BagKind().connected(options, twin)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("warning: --bag-topic: nothing is published on '/robot_1/joint_state' yet")
    assert STATES in line
