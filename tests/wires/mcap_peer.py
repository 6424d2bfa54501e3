"""Read bags with the packages mcap and mcap-ros2-support, which nobody here wrote."""

from collections.abc import Iterator
from pathlib import Path

from mcap.reader import DecodedMessageTuple, make_reader
from mcap_ros2.decoder import DecoderFactory


def decoded_messages(file: Path) -> Iterator[DecodedMessageTuple]:
    """Decode each message of a file: its ``schema``, ``channel``, ``message`` and ``decoded_message``."""
    with file.open("rb") as stream:
        yield from make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages()
