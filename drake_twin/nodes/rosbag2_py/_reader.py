"""Stand-in for ``rosbag2_py._reader``."""

import re
from collections.abc import Iterator
from typing import Any

from drake_twin.nodes.rosbag2_py._info import metadata_of, open_bag, topic_of
from drake_twin.nodes.rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    ReadOrder,
    ReadOrderSortBy,
    StorageFilter,
    StorageOptions,
    TopicMetadata,
)

_CLOSED = "Bag is not open. Call open() before reading."


def get_registered_readers() -> set[str]:
    """Return the formats of bags."""
    return {"mcap", "sqlite3"}


class SequentialReader:
    """Reads the messages of a bag, one after the other."""

    def __init__(self) -> None:
        self._reader: Any = None
        self._uri = ""
        self._messages: Iterator[tuple[Any, int, bytes]] = iter(())
        self._next: tuple[str, bytes, int] | None = None
        self._filter, self._order, self._start = StorageFilter(), ReadOrder(), 0

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Open a bag.

        Raises:
            RuntimeError: If the bag does not exist, or its messages are to be converted.
        """
        for name in (converter_options.input_serialization_format, converter_options.output_serialization_format):
            if name not in ("", "cdr"):
                raise RuntimeError(f"No converter for serialization format {name!r} could be loaded.")
        self._reader, self._uri = open_bag(storage_options.uri), storage_options.uri
        self._reader.open()
        self._start = max(storage_options.start_time_ns, 0)
        self._restart()

    def open_uri(self, uri: str) -> None:
        """Open a bag by its folder or file."""
        self.open(StorageOptions(uri), ConverterOptions())

    def has_next(self) -> bool:
        """Return whether there is a further message."""
        self._opened()
        return self._next is not None

    def read_next(self) -> tuple[str, bytes, int]:
        """Return the next message: its topic, its bytes in CDR, and the time at which it was received (ns).

        Raises:
            RuntimeError: If all have been read.
        """
        self._opened()
        if self._next is None:
            raise RuntimeError("Bag is at end. No next message.")
        found = self._next
        self._start = found[2] - 1 if self._order.reverse else found[2] + 1
        self._step()
        return found

    def get_metadata(self) -> BagMetadata:
        """Return what is known of the bag."""
        return metadata_of(self._opened(), self._uri)

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """Return the bag's topics."""
        return [topic_of(item) for item in self._opened().connections]

    def set_filter(self, storage_filter: StorageFilter) -> None:
        """Read some topics only, from the present place."""
        self._opened()
        self._filter = storage_filter
        self._restart()

    def reset_filter(self) -> None:
        """Read all topics, from the present place."""
        self.set_filter(StorageFilter())

    def set_read_order(self, order: ReadOrder) -> bool:
        """Read in another order, from the present place; return whether it can be done."""
        self._opened()
        if order.sort_by is not ReadOrderSortBy.ReceivedTimestamp:
            return False
        self._order = order
        self._restart()
        return True

    def seek(self, timestamp: int) -> None:
        """Go on with the first message that was received at a time (ns) or later; in reverse, or earlier."""
        self._opened()
        self._start = timestamp
        self._restart()

    def close(self) -> None:
        """Close the bag."""
        if self._reader is not None:
            self._reader.close()
        self._reader, self._next, self._messages = None, None, iter(())

    def _opened(self) -> Any:
        if self._reader is None:
            raise RuntimeError(_CLOSED)
        return self._reader

    def _restart(self) -> None:
        wanted = [item for item in self._reader.connections if self._is_wanted(item.topic)]
        if not wanted:
            self._messages = iter(())
        elif self._order.reverse:
            end = self._start + 1 if self._start else None
            self._messages = reversed([*self._reader.messages(wanted, stop=end)])
        else:
            self._messages = self._reader.messages(wanted, start=self._start)
        self._step()

    def _is_wanted(self, topic: str) -> bool:
        given = self._filter
        is_named = topic in given.topics or (given.regex and re.fullmatch(given.regex, topic))
        is_left_out = topic in given.exclude_topics or (
            given.regex_to_exclude and re.fullmatch(given.regex_to_exclude, topic)
        )
        return bool(is_named or not (given.topics or given.regex)) and not is_left_out

    def _step(self) -> None:
        found = next(self._messages, None)
        self._next = None if found is None else (found[0].topic, bytes(found[2]), found[1])


class SequentialCompressionReader(SequentialReader):
    """Reads a bag that is compressed, as `SequentialReader` does, too."""
