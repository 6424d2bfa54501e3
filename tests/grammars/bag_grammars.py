"""Grammars of bags (MCAP, SQLite3), of messages' bytes and texts, and of message definitions."""

import json
import shutil
import struct
import tempfile
from functools import cache
from pathlib import Path

from choices import WORDS, Choices, damaged
from text_grammars import as_yaml
from xml_grammars import urdf

BAGS = 40
TYPES = ("std_msgs/msg/String", "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage")
TYPES += ("geometry_msgs/msg/TwistStamped",)
TYPES += ("std_msgs/msg/Float64MultiArray", "trajectory_msgs/msg/JointTrajectory", "sensor_msgs/msg/Image")
TYPES += ("nav_msgs/msg/Odometry", "rcl_interfaces/msg/ParameterValue")


@cache
def _bag(plugin: str, number: int) -> dict[str, bytes]:
    """Return one of some bags, whose messages may be wrong already: to write one takes a while."""
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    from drake_twin.messages import type_store
    from drake_twin.messages.interface_types import make, serialize

    c = Choices(f"{plugin} {number}")
    c.rate = min(c.rate, 0.02)
    folder = Path(tempfile.mkdtemp(prefix="bag_")) / "bag"
    description = urdf(c)["robot.urdf"].decode("utf-8", "replace")
    writer = Writer(folder, version=c.choice((8, 9)), storage_plugin=StoragePlugin[plugin])
    if plugin == "SQLITE3" and c.maybe(0.2):
        writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with writer:
        messages = [("/robot_description", TYPES[0], serialize(make(TYPES[0], {"data": description})))]
        joints = {"name": ["j1"], "position": [0.5], "velocity": [0.1], "effort": []}
        moved = {"header": {"frame_id": c.word("odom")}, "child_frame_id": c.word("l0")}
        for _ in range(c.choice((1, 3))):
            messages.append(("/joint_states", TYPES[1], serialize(make(TYPES[1], joints))))
            messages.append(("/tf", TYPES[2], serialize(make(TYPES[2], {"transforms": [moved]}))))
        known = {}
        for number, (topic, kind, data) in enumerate(messages):
            kind = c.choice(TYPES) if c.is_wrong() else kind
            if topic not in known:
                known[topic] = writer.add_connection(topic, kind, typestore=type_store())
            time = 1_700_000_000_000_000_000 + number * 10**7
            writer.write(known[topic], c.choice((0, 1, 2**62)) if c.is_wrong() else time, _cut(data, c))
    found = {f"bag/{file.name}": file.read_bytes() for file in folder.iterdir()}
    shutil.rmtree(folder.parent)
    return found


def _cut(data: bytes, c: Choices) -> bytes:
    """Return a message whose lengths lie, or that ends early."""
    if not c.is_wrong() or len(data) < 8:
        return data
    at = c.randrange(len(data) // 4) * 4
    lie = struct.pack("<I", c.choice((0, 1, 2**16, 2**31 - 1, 2**32 - 1)))
    return c.choice((data[:at], data[:at] + lie + data[at + 4 :], lie + data[4:], b"", b"\0\1\0\0"))


def _spoiled(files: dict[str, bytes], c: Choices) -> dict[str, bytes]:
    """Return a bag's files with bytes or the metadata's values changed."""
    import yaml

    files = dict(files)
    for name, content in files.items():
        if name.endswith("metadata.yaml"):
            files[name] = as_yaml(yaml.safe_load(content), c)
        elif c.random() < 2 * c.rate:
            data = bytearray(content)
            for _ in range(c.choice((1, 1, 4))):
                at = c.randrange(max(1, len(data) - 8))
                size = c.choice((1, 4, 8))
                wrong = c.choice((0, 1, 2**31 - 1, 2**32 - 1, 2**63 - 1, 2**64 - 1, c.getrandbits(64)))
                data[at : at + size] = wrong.to_bytes(8, "little")[:size]
            files[name] = damaged(bytes(data), c)
    if c.random() < c.rate / 4:
        del files[c.choice(list(files))]
    return files


def mcap(choices: Choices) -> dict[str, bytes]:
    return _spoiled(_bag("MCAP", choices.randrange(BAGS)), choices)


def db3(choices: Choices) -> dict[str, bytes]:
    return _spoiled(_bag("SQLITE3", choices.randrange(BAGS)), choices)


def message(choices: Choices) -> dict[str, bytes]:
    """The bytes of a message in CDR, as JSON and as YAML, and a definition."""
    c = choices
    from drake_twin.messages.interface_types import default_values, fields_of, make, serialize

    kind = c.choice(TYPES)
    fields = [name for name, _ in fields_of(kind)[1]]
    data = {name: c.value() for name in fields if c.maybe(0.7)} | dict(list(default_values(kind).items())[:1])
    if c.is_wrong():
        data = c.value()
    text = json.dumps(data).encode()
    if c.is_wrong():
        text = c.choice((b"[" * 100_000, b'{"a":' * 50_000, b"\xff", b"1e999", b"9" * 10_000, b'"\\ud800"'))
    kinds = ("int32", "string", "float64[]", "string<=3[<=2]", "uint8[4]", "Header", "geometry_msgs/Pose", "Own")
    count = c.choice((0, 1, 4))
    lines = [f"{c.word(*kinds)} {c.word('a', 'b', 'a_b')}{c.word('', '', ' 1', '=3')}" for _ in range(count)]
    lines += c.some(*WORDS, most=int(c.is_wrong()))
    return {
        "type": kind.encode(),
        "message.cdr": damaged(_cut(serialize(make(kind, {})), c), c),
        "message.json": text,
        "message.yaml": as_yaml(data, c),
        "msg/Own.msg": damaged("\n".join(lines).encode("utf-8", "replace"), c),
    }
