"""A rosbag2 bag that stays whole where the disk is full or fails: the chunks that cannot be written are left out."""

import contextlib
import io
from collections import defaultdict
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter, PendingChunk

from drake_twin.versions import stamp


class _File(io.FileIO):
    """Writes all bytes or raises: a buffer would keep what does not fit, and fail again with each write."""

    def write(self, data: Any) -> int:
        left = memoryview(data).cast("B")
        while left:
            left = left[super().write(left) or 0 :]
        return len(data)


class _Chunk(NamedTuple):
    """A chunk in the file: where it begins, its first and last time, and channel → number of messages."""

    start: int
    first: int
    last: int
    counts: dict[int, int]


class _Storage(McapWriter):
    def __init__(self, path: Path, compression: CompressionMode):
        super().__init__(path, compression)
        position = self.bio.tell()
        self.bio.close()
        self.bio = _File(self.path, "r+")  # type: ignore[assignment]
        self.bio.seek(position)
        self.written: list[_Chunk] = []

    def close_chunk(self) -> None:
        counts = {channel: len(messages) for channel, messages in self.chunk.msgs.items()}
        chunk = _Chunk(self.bio.tell(), self.chunk.message_start_time, self.chunk.message_end_time, counts)
        self.written.append(chunk)
        super().close_chunk()

    def drop_chunk(self) -> dict[int, int]:
        """Drop the last chunk that was begun, and what follows it; return the numbers of its messages."""
        chunk = self.written.pop()
        if self.bio.closed:
            self.bio = _File(self.path, "r+")  # type: ignore[assignment]
        self.bio.truncate(chunk.start)
        self.bio.seek(chunk.start)
        del self.chunks[len(self.written) :]
        self.chunk = PendingChunk(2**63 - 1, 0, io.BytesIO(), defaultdict(list))
        for channel, count in chunk.counts.items():
            self.channel_stats[channel] -= count
        self.message_start_time = min((each.first for each in self.written), default=0)
        self.message_end_time = max((each.last for each in self.written), default=0)
        return chunk.counts


class WholeBag(Writer):
    """Writes a bag (MCAP, zstd) until no more fits, and finishes it so that readers find it whole.

    Args:
        folder: The bag's folder, which must not exist.

    Attributes:
        failure: Why messages are missing; None if none are.

    Raises:
        OSError: If it cannot be created.
    """

    STORAGE_PLUGINS = MappingProxyType({StoragePlugin.MCAP: _Storage})

    def __init__(self, folder: Path):
        if folder.exists():
            raise FileExistsError(f"{folder} exists")
        super().__init__(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        self.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self.set_custom_data("written_by", stamp())
        self.failure: OSError | None = None
        self.open()

    @property
    def is_full(self) -> bool:
        """Whether nothing more can be written into it."""
        return self.failure is not None

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write a message, unless it is the first that does not fit."""
        try:
            super().write(connection, timestamp, data)
        except OSError as error:
            self._drop_chunk(error)
            self.counts[connection.id] += 1  # which was counted with its chunk only

    def finish(self) -> None:
        """Write the index and the metadata, and leave out as many of the last chunks as that needs."""
        storage = self.storage
        while True:
            try:
                self.storage = storage
                Writer.close(self)
                return
            except OSError as error:
                self.storage = storage
                self._drop_chunk(error)

    def close(self) -> None:
        """Close the file, whole only after `finish`."""
        with contextlib.suppress(OSError):
            self.abort()

    def kept(self) -> str:
        """Say what is in it."""
        count = sum(self.counts.values())
        if not count:
            return "no message is kept"
        return f"{count} messages are kept, the last of {self.max_timestamp / 1e9:.3f} s"

    def _drop_chunk(self, error: OSError) -> None:
        storage = self.storage
        if not isinstance(storage, _Storage) or not storage.written:
            raise error
        self.failure = error
        for channel, count in storage.drop_chunk().items():
            self.counts[channel] -= count
        self.min_timestamp, self.max_timestamp = storage.message_start_time, storage.message_end_time
