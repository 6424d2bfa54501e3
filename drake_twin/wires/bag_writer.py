"""Write a rosbag2 bag in a process of its own: ``python -m drake_twin.wires.bag_writer FOLDER``, fed on standard input.

The process that simulates pays for a pipe only. When it ends, in whatever way, this one reads the end of the pipe and
finishes the file and its ``metadata.yaml``: a twin that is killed leaves a whole bag. The other way round, a bag whose
writer is killed can be read up to its last chunk of 1 MiB by readers that stream.

Each record on the pipe is a kind (`TOPIC` or `MESSAGE`), a topic's number, a time (ns) and the length of what follows:
a topic's description as JSON, or a message in CDR.

A bag that cannot be written on, because the disk is full for example, is made whole without the last of its messages.
What was lost is said on standard output, and the exit code is 1.
"""

import contextlib
import io
import json
import struct
import sys
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from drake_twin.errors import RunError
from drake_twin.python_process import ignore_stops
from drake_twin.whole_file import write_whole

if TYPE_CHECKING:
    from rosbags.interfaces import Connection, Qos

HEAD = struct.Struct("<cIqI")
TOPIC, MESSAGE = b"T", b"M"
_DISTRIBUTION = "jazzy"


def main() -> int:
    """Write what comes on standard input into the folder that the command line names; return the exit code."""
    ignore_stops()  # the pipe's end ends it
    records = cast(io.BufferedReader, sys.stdin.buffer)
    if not records.peek(1):  # the twin was stopped before it was built
        return 0
    try:
        write_bag(sys.argv[1], records)
    except (OSError, RunError) as error:
        said = f"{getattr(error, 'strerror', None) or error}"
        try:
            print(said, flush=True)
        except OSError:  # the twin was killed, and its pipe is closed
            print(f"the bag {sys.argv[1]} is not complete: {said}", file=sys.stderr)
        return 1
    return 0


def write_bag(folder: str, source: BinaryIO) -> None:
    """Write records into a bag until they end; a record that is cut off is left out.

    Args:
        folder: The bag's folder, which must not exist.
        source: The records.

    Raises:
        OSError: If the bag cannot be written.
        RunError: If it has only a part of the messages; it is whole otherwise.
    """
    from drake_twin.wires.whole_bag import WholeBag

    with contextlib.closing(WholeBag(Path(folder))) as bag:
        connections: dict[int, Connection] = {}
        while not bag.is_full and len(head := source.read(HEAD.size)) == HEAD.size:
            kind, number, time, length = HEAD.unpack(head)
            content = source.read(length)
            if len(content) < length:
                break
            if kind == MESSAGE:
                bag.write(connections[number], time, content)
            else:
                topic = json.loads(content)
                connections[number] = bag.add_connection(
                    topic["name"],
                    topic["type"],
                    msgdef=topic["definition"],
                    rihs01=topic["hash"],
                    offered_qos_profiles=[_quality(**topic["quality"])],
                )
        bag.finish()
    tell_distribution(Path(folder))
    if bag.failure is not None:
        raise RunError(f"{bag.failure.strerror}; {bag.kept()}")


def tell_distribution(folder: Path) -> None:
    """Let a bag's metadata name the distribution of ROS whose messages it has; rosbags names itself."""
    file = folder / "metadata.yaml"
    write_whole(file, file.read_text("utf-8").replace("ros_distro: rosbags", f"ros_distro: {_DISTRIBUTION}"))


def _quality(
    *,
    latched: bool,
    depth: int,
    is_best_effort: bool,
    is_manual: bool,
    **spans: float | None,
) -> "Qos":
    """Return the quality of service of one of the twin's publishers."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    forever = QosTime(2147483647, 4294967295)
    lifespan, deadline, lease = (
        forever if span is None else QosTime(*divmod(round(span * 1e9), 10**9))
        for span in map(spans.__getitem__, ("lifespan", "deadline", "lease"))
    )
    return Qos(
        history=QosHistory.KEEP_LAST if depth else QosHistory.KEEP_ALL,
        depth=depth,
        reliability=QosReliability.BEST_EFFORT if is_best_effort else QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=deadline,
        lifespan=lifespan,
        liveliness=QosLiveliness.MANUAL_BY_TOPIC if is_manual else QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=lease,
        avoid_ros_namespace_conventions=False,
    )


if __name__ == "__main__":
    sys.exit(main())
