"""Stand-in for ``rosbag2_py._writer``."""

import atexit
import contextlib
import weakref
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drake_twin.messages.interface_types import definition, type_hash
from drake_twin.nodes.rosbag2_py._storage import ConverterOptions, StorageOptions, TopicMetadata


def get_registered_writers() -> set[str]:
    """Return the formats of bags."""
    return {"mcap", "sqlite3"}


def get_registered_serializers() -> set[str]:
    """Return the formats of messages."""
    return {"cdr"}


class SequentialWriter:
    """Writes a bag, which is whole when it is closed, when the writer is deleted, or at the program's end."""

    def __init__(self) -> None:
        self._writer: Any = None
        self._folder = Path()
        self._connections: dict[str, Any] = {}

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Begin a bag.

        Raises:
            RuntimeError: If its folder is there already, or cannot be made.
        """
        import sqlite3

        from rosbags.rosbag2 import StoragePlugin, Writer, WriterError

        kind = storage_options.storage_id or "mcap"
        if kind not in get_registered_writers():
            raise RuntimeError(f"No storage could be initialized. Abort (storage {kind!r}; valid: mcap, sqlite3)")
        if converter_options.output_serialization_format not in ("", "cdr"):
            what = converter_options.output_serialization_format
            raise RuntimeError(f"No converter for serialization format {what!r} could be loaded.")
        if storage_options.max_bagfile_size or storage_options.max_bagfile_duration or storage_options.snapshot_mode:
            raise NotImplementedError("bags are not split, and there are no snapshots: leave these options out")
        self._folder = Path(storage_options.uri)
        if self._folder.exists():
            raise RuntimeError(f"Bag directory already exists ({self._folder}), can't overwrite existing bag")
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        try:
            self._writer = Writer(self._folder, version=9, storage_plugin=plugin)
            for key, value in storage_options.custom_data.items():
                self._writer.set_custom_data(key, value)
            self._writer.open()
        except (OSError, WriterError, sqlite3.Error) as error:
            self._writer = None
            raise RuntimeError(f"Failed to create bag directory ({self._folder}). {error}") from None
        atexit.register(_close, weakref.ref(self))

    def create_topic(self, topic: TopicMetadata) -> None:
        """Add a topic; nothing happens if it is there already.

        Raises:
            RuntimeError: If the bag is not open or cannot be written, or its type is unknown.
        """
        if self._writer is None:
            raise RuntimeError("Bag is not open. Call open() before writing.")
        if topic.name in self._connections:
            return
        try:
            text, digest = definition(topic.type), type_hash(topic.type)
        except ValueError as error:
            raise RuntimeError(f"topic {topic.name}: {error}") from None
        profiles = topic.offered_qos_profiles or []
        if isinstance(profiles, str):
            raise NotImplementedError("profiles as text are not taken: leave them out, or give a reader's")
        with self._failing():
            added = self._writer.add_connection(
                topic.name, topic.type, msgdef=text, rihs01=digest, offered_qos_profiles=profiles
            )
        self._connections[topic.name] = added

    def remove_topic(self, topic: TopicMetadata) -> None:
        """Take a topic back: messages on it are refused from now on."""
        self._connections.pop(topic.name, None)

    def write(self, topic_name: str, message: bytes, time_stamp: int, send_time_stamp: int | None = None) -> None:
        """Write a message.

        Args:
            topic_name: Its topic.
            message: Its bytes in CDR.
            time_stamp: The time at which it was received (ns).
            send_time_stamp: The time at which it was sent (ns), which a bag of ``rosbags`` does not keep.

        Raises:
            RuntimeError: If the bag is not open or cannot be written, or the topic is not there.
        """
        if self._writer is None:
            raise RuntimeError("Bag is not open. Call open() before writing.")
        connection = self._connections.get(topic_name)
        if connection is None:
            raise RuntimeError(f"Failed to write on topic '{topic_name}'. Call create_topic() before first write.")
        with self._failing():
            self._writer.write(connection, time_stamp, message)

    def close(self) -> None:
        """Finish the bag.

        Raises:
            RuntimeError: If it cannot be written.
        """
        writer, self._writer = self._writer, None
        if writer is not None:
            with self._failing():
                writer.close()

    @contextlib.contextmanager
    def _failing(self) -> Iterator[None]:
        """Raise what rosbag2 raises where a bag cannot be written."""
        import sqlite3

        try:
            yield
        except (OSError, sqlite3.Error) as error:
            raise RuntimeError(f"Failed to write bag ({self._folder}): {error}") from None

    def __del__(self) -> None:
        self.close()


def _close(writer: "weakref.ref[SequentialWriter]") -> None:
    """Close a writer that is still there."""
    if (found := writer()) is not None:
        found.close()
