"""Records become a bag, which keeps each topic's quality of service, as ``ros2 bag play`` offers it again."""

import io
import json
import subprocess
import sys

import pytest
from rosbags.highlevel import AnyReader

from drake_twin.wires.bag_writer import HEAD, MESSAGE, TOPIC, _quality, write_bag

QUALITY = {
    "latched": False,
    "depth": 10,
    "is_best_effort": False,
    "lifespan": None,
    "deadline": None,
    "is_manual": False,
    "lease": None,
}


@pytest.mark.parametrize(("latched", "depth", "durability"), [(False, 10, "VOLATILE"), (True, 1, "TRANSIENT_LOCAL")])
def test_a_topic_keeps_its_last_messages_as_deep_as_it_says(latched, depth, durability):
    """As a publisher of rclpy with the profile of this depth, and of ``robot_description``; times without an end."""
    quality = _quality(**QUALITY | {"latched": latched, "depth": depth})
    assert (quality.history.name, quality.depth, quality.durability.name) == ("KEEP_LAST", depth, durability)
    assert (quality.reliability.name, quality.liveliness.name) == ("RELIABLE", "AUTOMATIC")
    forever = {
        (time.sec, time.nsec) for time in (quality.deadline, quality.lifespan, quality.liveliness_lease_duration)
    }
    assert forever == {(2**31 - 1, 2**32 - 1)}  # DDS's Duration_t of infinity
    assert not quality.avoid_ros_namespace_conventions


@pytest.mark.parametrize(
    ("given", "name", "expected"),
    [
        ({"lifespan": 2.5}, "lifespan", (2, 500_000_000)),
        ({"deadline": 0.25}, "deadline", (0, 250_000_000)),
        ({"lease": 3.0}, "liveliness_lease_duration", (3, 0)),
        ({"is_best_effort": True}, "reliability", "BEST_EFFORT"),
        ({"is_manual": True}, "liveliness", "MANUAL_BY_TOPIC"),
        ({"depth": 0}, "history", "KEEP_ALL"),
    ],
)
def test_a_topic_keeps_what_its_publisher_offers(given, name, expected):
    found = getattr(_quality(**QUALITY | given), name)
    assert (found.name if isinstance(expected, str) else (found.sec, found.nsec)) == expected


CHATTER = {
    "name": "/chatter",
    "type": "std_msgs/msg/String",
    "definition": "string data\n",
    "quality": QUALITY,
    "hash": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",  # of rosidl
}


def record(kind, number, time, content):
    return HEAD.pack(kind, number, time, len(content)) + content


def test_records_are_a_bag_and_one_that_is_cut_off_is_left_out(tmp_path):
    said = [b"\x00\x01\x00\x00\x02\x00\x00\x00a\x00", b"\x00\x01\x00\x00\x02\x00\x00\x00b\x00"]
    stream = record(TOPIC, 7, 0, json.dumps(CHATTER).encode())
    stream += b"".join(record(MESSAGE, 7, time, data) for time, data in zip((10, 20), said, strict=True))
    for name, rest in (("whole", b""), ("in_head", b"M"), ("in_content", record(MESSAGE, 7, 30, said[0])[:-1])):
        write_bag(str(tmp_path / name), io.BytesIO(stream + rest))
        assert (tmp_path / name / "metadata.yaml").is_file()
        with AnyReader([tmp_path / name]) as reader:
            found = [(item.topic, item.msgtype, time, bytes(data)) for item, time, data in reader.messages()]
        assert found == [
            ("/chatter", "std_msgs/msg/String", time, data) for time, data in zip((10, 20), said, strict=True)
        ]


def test_a_folder_that_exists_is_refused_and_stays(tmp_path):
    with pytest.raises(FileExistsError, match="exists"):
        write_bag(str(tmp_path), io.BytesIO())
    assert list(tmp_path.iterdir()) == []


def test_its_process_writes_a_bag_of_the_distribution_whose_messages_it_has(tmp_path):
    stream = record(TOPIC, 1, 0, json.dumps(CHATTER).encode())
    words = [sys.executable, "-m", "drake_twin.wires.bag_writer", str(tmp_path / "bag")]
    assert subprocess.run(words, input=stream, timeout=60).returncode == 0
    assert "ros_distro: jazzy\n" in (tmp_path / "bag" / "metadata.yaml").read_text()
    again = subprocess.run(words, input=stream, timeout=60, stdout=subprocess.PIPE, text=False)
    assert (again.returncode, again.stdout.decode()) == (1, f"{words[-1]} exists\n")


def test_a_twin_that_ends_before_it_is_built_leaves_no_bag(tmp_path):
    program = [sys.executable, "-m", "drake_twin.wires.bag_writer", str(tmp_path / "bag")]
    assert subprocess.run(program, input=b"", check=False).returncode == 0
    assert list(tmp_path.iterdir()) == []
