"""Frames and the transforms between them, as messages of ``/tf`` and ``/tf_static`` give them."""

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Transform:
    """The pose of one frame in another.

    Attributes:
        translation: x, y, z (m).
        rotation: The rotation.
        time: The time of the oldest transform in it (ns); None if all are static.
    """

    translation: np.ndarray
    rotation: Rotation
    time: int | None = None

    def of(self, inner: "Transform") -> "Transform":
        """Return the pose in the outer frame of what `inner` places in the inner one."""
        times = [time for time in (self.time, inner.time) if time is not None]
        translation = self.translation + self.rotation.apply(inner.translation)
        return Transform(translation, self.rotation * inner.rotation, min(times, default=None))

    def inverse(self) -> "Transform":
        """Return the pose of the outer frame in the inner one."""
        back = self.rotation.inv()
        return Transform(-back.apply(self.translation), back, self.time)


class TransformTree:
    """The newest transform of each frame.

    Attributes:
        parents: Frame → the frame above it, and its pose in that.
    """

    def __init__(self) -> None:
        self.parents: dict[str, tuple[str, Transform]] = {}
        self._ignored: set[str] = set()

    @property
    def frames(self) -> list[str]:
        """The frames' names, sorted."""
        return sorted({*self.parents, *(parent for parent, _ in self.parents.values())})

    def copy(self) -> "TransformTree":
        """Return a copy."""
        copied = TransformTree()
        copied.parents.update(self.parents)
        copied._ignored |= self._ignored
        return copied

    def add(self, message: Any, *, is_static: bool) -> None:
        """Take the transforms of a ``TFMessage``; those that are not a pose are ignored with a warning."""
        for item in message.transforms:
            at, turn, stamp = item.transform.translation, item.transform.rotation, item.header.stamp
            numbers = np.array([at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w])
            if not np.isfinite(numbers).all() or not numbers[3:].any():  # tf2 ignores it, too
                if item.child_frame_id not in self._ignored:
                    _log.warning("a transform of the frame %r is ignored: %s", item.child_frame_id, numbers)
                self._ignored.add(item.child_frame_id)
                continue
            time = None if is_static else stamp.sec * 1_000_000_000 + stamp.nanosec
            pose = Transform(numbers[:3], Rotation.from_quat(numbers[3:]), time)
            self.parents[item.child_frame_id] = item.header.frame_id, pose

    def look_up(self, outer: str, inner: str) -> Transform:
        """Return the pose of a frame in another one.

        Raises:
            InputError: If a frame is unknown, or no transforms connect the two.
        """
        for name in (outer, inner):
            if name not in self.frames:
                raise InputError(f"unknown frame {name!r}", value=name, valid=self.frames)
        lines = self._line(outer), self._line(inner)
        common = next((frame for frame in lines[0] if frame in lines[1]), None)
        if common is None:
            what = f"no transforms connect {outer!r} in {lines[0][-1]!r} with {inner!r} in {lines[1][-1]!r}"
            raise InputError(what)
        of_outer, of_inner = (self._pose(line[: line.index(common)]) for line in lines)
        return of_outer.inverse().of(of_inner)

    def in_root(self, frame: str) -> tuple[str, Transform]:
        """Return the root above a frame, and the frame's pose in it.

        Raises:
            InputError: If the frames are a loop.
        """
        *line, root = self._line(frame)
        return root, self._pose(line)

    def as_plain(self) -> list[dict[str, Any]]:
        """Return each frame with the one above it, its translation (m) and roll, pitch, yaw (rad) in that."""
        return [
            {
                "frame": frame,
                "parent": parent,
                "xyz": [round(float(number), 4) for number in pose.translation],
                "rpy": [round(float(number), 4) for number in pose.rotation.as_euler("xyz")],
                "static": pose.time is None,
            }
            for frame, (parent, pose) in sorted(self.parents.items())
        ]

    def _line(self, frame: str) -> list[str]:
        """Return a frame and those above it, up to the root."""
        line = [frame]
        while frame in self.parents:
            frame, _ = self.parents[frame]
            if frame in line:
                raise InputError(f"the frame {frame!r} is above itself")
            line.append(frame)
        return line

    def _pose(self, line: Sequence[str]) -> Transform:
        """Return the pose of the first of some frames in the parent of the last one."""
        pose = Transform(np.zeros(3), Rotation.identity())
        for frame in line:
            pose = self.parents[frame][1].of(pose)
        return pose
