"""``rosbag2_py`` for nodes: bags that they write, and read."""

from pathlib import Path

import pytest
from node_runs import lines, running, script
from rosbags.rosbag2 import Reader

WRITE = """
import rclpy, rosbag2_py
from rclpy.serialization import serialize_message
from std_msgs.msg import Int32, String

writer = rosbag2_py.SequentialWriter()
writer.open(rosbag2_py.StorageOptions(uri={folder!r}, storage_id={kind!r}), rosbag2_py.ConverterOptions("", ""))
for index, (name, kind) in enumerate([("/words", "std_msgs/msg/String"), ("/numbers", "std_msgs/msg/Int32")]):
    writer.create_topic(rosbag2_py.TopicMetadata({index} name=name, type=kind, serialization_format="cdr"))
for index in range(3):
    writer.write("/words", serialize_message(String(data=f"word {{index}}")), 1000 + 100 * index)
    writer.write("/numbers", serialize_message(Int32(data=index)), 1050 + 100 * index)
"""
READ = """
import rosbag2_py
from rclpy.serialization import deserialize_message
from rosidl_runtime_py.utilities import get_message

reader = rosbag2_py.SequentialReader()
reader.open(rosbag2_py.StorageOptions(uri={folder!r}), rosbag2_py.ConverterOptions("cdr", "cdr"))
kinds = {{topic.name: topic.type for topic in reader.get_all_topics_and_types()}}

def rest():
    while reader.has_next():
        topic, data, time = reader.read_next()
        print(topic, deserialize_message(data, get_message(kinds[topic])).data, time)

{what}
"""
WRITE_UNKNOWN = """
writer = rosbag2_py.SequentialWriter()
writer.open(rosbag2_py.StorageOptions({folder!r} + "2"), rosbag2_py.ConverterOptions())
writer.write("/a", b"", 0)
"""
FULL = """
class Full:
    def __getattr__(self, name):
        def fail(*_):
            import sqlite3
            raise sqlite3.OperationalError("full") if name == "write" else OSError(28, "No space left on device")
        return fail
writer._writer = Full()
try:
    writer.write("/words", b"", 0)
except RuntimeError as error:
    print(type(error).__name__)
writer.close()
"""
MESSAGES = [
    f"{topic} {time}"
    for index in range(3)
    for topic, time in [(f"/words word {index}", 1000 + 100 * index), (f"/numbers {index}", 1050 + 100 * index)]
]


@pytest.fixture
def run(tmp_path, capsys):
    def run_(text):
        with running(script(tmp_path, "a.py", text)) as twin:
            twin.advance_to(0.1)
            found = [item.what for item in twin.more_findings]
        return lines(capsys), found

    return run_


@pytest.fixture
def bag(tmp_path, run):
    folder = str(tmp_path / "below" / "bag")
    assert run(WRITE.format(folder=folder, kind="mcap", index="id=index,")) == ([], [])
    return folder


def test_a_bag_is_whole_at_the_programs_end(bag):
    with Reader(bag) as reader:
        assert [(item.topic, item.msgcount) for item in reader.connections] == [("/words", 3), ("/numbers", 3)]
    assert [file.suffix for file in Path(bag).iterdir() if file.name != "metadata.yaml"] == [".mcap"]


def test_what_was_written_is_read(bag, run):
    assert run(READ.format(folder=bag, what="rest()")) == (MESSAGES, [])


def test_sqlite_and_topics_as_in_humble(tmp_path, run):
    """Humble's TopicMetadata has no id."""
    folder = str(tmp_path / "bag")
    assert run(WRITE.format(folder=folder, kind="sqlite3", index="")) == ([], [])
    assert (tmp_path / "bag" / "bag.db3").is_file()
    assert run(READ.format(folder=folder, what="rest()")) == (MESSAGES, [])


def test_topics_are_chosen_and_times_sought(bag, run):
    what = """
reader.set_filter(rosbag2_py.StorageFilter(topics=["/words"]))
print(reader.read_next()[2])
reader.reset_filter()
print(reader.read_next()[0])
reader.seek(1200)
rest()
reader.set_read_order(rosbag2_py.ReadOrder(reverse=True))
reader.seek(1060)
rest()
"""
    found = ["1000", "/numbers", *MESSAGES[4:], *reversed(MESSAGES[:2])]
    assert run(READ.format(folder=bag, what=what)) == (found, [])


def test_metadata(bag, run):
    what = """
found = reader.get_metadata()
print(found.message_count, found.duration.nanoseconds, found.starting_time.nanoseconds, found.storage_identifier)
print([(item.topic_metadata.name, item.message_count) for item in found.topics_with_message_count])
print(rosbag2_py.Info().read_metadata({folder!r}, "mcap").message_count)
"""
    found, failed = run(READ.format(folder=bag, what=what.format(folder=bag)))
    assert (found, failed) == (["6 250 1000 mcap", "[('/words', 3), ('/numbers', 3)]", "6"], [])


@pytest.mark.parametrize("kind", ["mcap", "sqlite3"])
def test_a_bag_that_cannot_be_written_is_rosbag2s_error_with_its_folder(tmp_path, run, kind):
    text = WRITE.format(folder=str(tmp_path / "bag"), kind=kind, index="") + FULL
    (found, (failed,)) = run(text)
    assert found == ["RuntimeError"]
    assert f"RuntimeError: Failed to write bag ({tmp_path / 'bag'}): " in failed


@pytest.mark.parametrize(
    ("what", "why"),
    [
        ("rosbag2_py.SequentialReader().has_next()", "Bag is not open. Call open() before reading."),
        ("rest()\nreader.read_next()", "Bag is at end. No next message."),
        ("rosbag2_py.SequentialReader().open_uri('/nowhere')", "No storage could be initialized from the inputs."),
        ("rosbag2_py.SequentialWriter().write('/a', b'', 0)", "Bag is not open. Call open() before writing."),
        (
            "rosbag2_py.SequentialWriter().open(rosbag2_py.StorageOptions({folder!r}), rosbag2_py.ConverterOptions())",
            "Bag directory already exists ({folder}), can't overwrite existing bag",
        ),
        (
            WRITE_UNKNOWN,
            "Failed to write on topic '/a'. Call create_topic() before first write.",
        ),
    ],
)
def test_errors_are_those_of_rosbag2(bag, run, what, why):
    """Texts of sequential_reader.cpp and sequential_writer.cpp."""
    _, (failed,) = run(READ.format(folder=bag, what=what.format(folder=bag)))
    assert f"RuntimeError: {why.format(folder=bag)}" in failed
