"""Bags of robots that a mirror hears, written by rosbags as a robot's own recorder writes them."""

from collections.abc import Iterable
from pathlib import Path

from rosbags.rosbag2 import StoragePlugin, Writer

from drake_twin.messages import type_store
from drake_twin.messages.interface_types import serialize
from drake_twin.mirror.heard import Heard

START = 1_700_000_000_000_000_000  # ns


def write_bag(folder: Path, messages: Iterable[Heard]) -> Path:
    """Write messages at the times at which they were heard."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}
        for item in messages:
            if item.topic not in connections:
                connections[item.topic] = writer.add_connection(item.topic, item.type, typestore=type_store())
            time = START + round(item.received * 1e9)
            writer.write(connections[item.topic], time, bytes(serialize(item.message)))
    return folder
