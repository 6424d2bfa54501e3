"""``drake-twin tf_echo SOURCE TARGET``: the transform between two frames, as tf2_ros's ``tf2_echo`` prints it."""

import argparse
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Arrivals, Verb, positive, run_verb

if TYPE_CHECKING:
    import numpy as np

    from drake_twin.client import Client
    from drake_twin.messages.transform_tree import Transform

_PATIENCE = 5.0  # s until a frame that nobody publishes is reported


def _add(parser: ArgumentParser) -> None:
    parser.add_argument("source_frame", metavar="SOURCE", help="the frame in which the pose is")
    parser.add_argument("target_frame", metavar="TARGET", help="the frame whose pose it is")
    parser.add_argument(
        "rate", metavar="RATE", nargs="?", type=positive, default=1.0, help="times a second (default: 1)"
    )
    parser.add_argument("--once", action="store_true", help="end after the first")


def _echo(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.messages.transform_tree import TransformTree

    topics = [topic for topic in ("/tf", "/tf_static") if topic in client.topics()]
    if not topics:
        raise InputError("nobody publishes /tf or /tf_static")
    tree, arrivals = TransformTree(), Arrivals()
    for topic in topics:
        client.subscribe(topic, lambda message, topic=topic: arrivals.put((topic, message)))  # type: ignore[misc]
    last, due = time.monotonic() + _PATIENCE, 0.0
    try:
        while True:
            arrived = arrivals.get((due or last) - time.monotonic())
            if arrived is not None:
                tree.add(arrived[1], is_static=arrived[0] == "/tf_static")
            now = time.monotonic()
            if now < due:
                continue
            try:
                pose = tree.look_up(options.source_frame, options.target_frame)
            except InputError:
                if now < last:
                    continue
                raise
            due = now + 1 / options.rate
            print(transform_text(pose), flush=True)
            if options.once:
                return 0
    except KeyboardInterrupt:
        return 0


def transform_text(pose: "Transform") -> str:
    """Return a transform as ``tf2_echo`` prints it."""
    seconds, nanoseconds = divmod(pose.time or 0, 1_000_000_000)
    turn = pose.rotation.as_euler("xyz")
    rows = [f" {' '.join(f'{value:6.3f}' for value in (*row, x))}" for row, x in _rows(pose)]
    return "\n".join(
        [
            f"At time {seconds}.{nanoseconds:09d}",
            f"- Translation: {_vector(pose.translation)}",
            f"- Rotation: in Quaternion {_vector(pose.rotation.as_quat())}",
            f"- Rotation: in RPY (radian) {_vector(turn)}",
            f"- Rotation: in RPY (degree) {_vector(pose.rotation.as_euler('xyz', degrees=True))}",
            "- Matrix:",
            *rows,
            "  0.000  0.000  0.000  1.000",
        ]
    )


def _rows(pose: "Transform") -> list[tuple[list[float], float]]:
    return list(zip(pose.rotation.as_matrix().tolist(), pose.translation.tolist(), strict=True))


def _vector(values: "np.ndarray") -> str:
    return f"[{', '.join(f'{value:.3f}' for value in values)}]"


VERB = Verb("print the pose of a frame in another one; Ctrl-C ends it", _add, _echo)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verb("tf_echo", VERB, arguments)


if __name__ == "__main__":
    sys.exit(main())
