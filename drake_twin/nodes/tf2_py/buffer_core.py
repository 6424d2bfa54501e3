"""``tf2_py.BufferCore``: frames, their transforms over time, and lookups between any two of them."""

from math import inf, isnan
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.logging import get_logger
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.rigid_motion import IDENTITY, Quaternion, Vector, add, inverse, multiply, normalized, rotate
from drake_twin.nodes.tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from drake_twin.nodes.tf2_py.time_cache import StaticCache, Stored, TimeCache, shown

_DEFAULT_CACHE_TIME = 10 * 10**9  # ns, as tf2's
_MOST_PARENTS = 1000  # tf2's MAX_GRAPH_DEPTH
_SECOND = 10**9  # ns

_Motion = tuple[Vector, Quaternion]
_NO_MOTION: _Motion = ((0.0, 0.0, 0.0), IDENTITY)


class BufferCore:
    """Stores transforms and looks up others between them.

    Args:
        cache_time: How long transforms are kept (a ``Duration``); 10 s by default.
    """

    def __init__(self, cache_time: Any = None):
        self._cache_time = _DEFAULT_CACHE_TIME if cache_time is None else nanoseconds(cache_time, "duration")
        self._frames: dict[str, TimeCache | None] = {}  # None for those without a parent
        self._authorities: dict[str, str] = {}

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a ``TransformStamped``; what cannot be one is said and left out."""
        self._insert(transform, authority, is_static=False)

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a ``TransformStamped`` that holds at all times."""
        self._insert(transform, authority, is_static=True)

    def clear(self) -> None:
        """Forget all transforms that change with time."""
        for cache in self._frames.values():
            if cache is not None:
                cache.clear()

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return the ``TransformStamped`` that takes data of the source frame into the target frame.

        Raises:
            TransformException: If it cannot be computed at the time; zero is the latest time that all have.
        """
        motion, at = self._looked_up(target_frame, source_frame, nanoseconds(time))
        return _message(target_frame, source_frame, motion, at)

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """Return the transform from one frame at one time to another at another, by way of a fixed frame.

        Raises:
            TransformException: If it cannot be computed.
        """
        for what, name in (("target", target_frame), ("source", source_frame), ("fixed", fixed_frame)):
            self._check(f"lookupTransform argument {what}_frame", name)
        first, _ = self._looked_up(fixed_frame, source_frame, nanoseconds(source_time))
        second, at = self._looked_up(target_frame, fixed_frame, nanoseconds(target_time))
        return _message(target_frame, source_frame, _then(first, second), at)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[int, str]:
        """Return whether there is a transform, and why not."""
        return self._can(((target_frame, source_frame, nanoseconds(time)),), target=target_frame, source=source_frame)

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[int, str]:
        """Return whether there is a transform from one frame at one time to another at another, and why not."""
        legs = (
            (target_frame, fixed_frame, nanoseconds(target_time)),
            (fixed_frame, source_frame, nanoseconds(source_time)),
        )
        return self._can(legs, target=target_frame, source=source_frame, fixed=fixed_frame)

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Time:
        """Return the latest ``Time`` at which there is a transform.

        Raises:
            TransformException: If it cannot be computed.
        """
        for name in (target_frame, source_frame):
            self._check("get_latest_common_time", name)
        return Time(nanoseconds=self._latest_common_time(target_frame, source_frame))

    def all_frames_as_string(self) -> str:
        """Return a line for each frame with a parent."""
        return "".join(
            f"Frame {name} exists with parent {cache.latest_parent or 'NO_PARENT'}.\n"
            for name, cache in self._frames.items()
            if cache is not None
        )

    def all_frames_as_yaml(self) -> str:
        """Return parent, rate and times of each frame as YAML."""
        text = "" if self._frames else "[]"
        for name, cache in self._frames.items():
            if cache is None or not cache.latest_parent:
                continue
            span = cache.latest - cache.oldest
            text += (
                f"{name}: \n"
                f"  parent: '{cache.latest_parent}'\n"
                f"  broadcaster: '{self._authorities.get(name, 'no recorded authority')}'\n"
                f"  rate: {len(cache) * 1e9 / max(span, 100_000):.3f}\n"
                f"  most_recent_transform: {shown(cache.latest)}\n"
                f"  oldest_transform: {shown(cache.oldest)}\n"
                f"  buffer_length: {span * 1e-9:.3f}\n"
            )
        return text

    # Names of tf2_py that begin like private ones are used by nodes, too.

    def _frameExists(self, frame_id: str) -> bool:
        return frame_id in self._frames

    def _getFrameStrings(self) -> list[str]:
        return [*self._frames]

    def _chain(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> list[str]:
        found = []
        for frame, ends, time in (
            (source_frame, fixed_frame, source_time),
            *([] if source_time == target_time else [(target_frame, fixed_frame, target_time)]),
        ):
            while frame != ends and (cache := self._frames.get(frame)) is not None:
                found.append(frame)
                at = nanoseconds(time) or self._latest_common_time(frame, ends)
                frame = cache.at(at).parent
        return found

    def _insert(self, transform: Any, authority: str, *, is_static: bool) -> None:
        parent, child = transform.header.frame_id.removeprefix("/"), transform.child_frame_id.removeprefix("/")
        moved, turned = transform.transform.translation, transform.transform.rotation
        translation: Vector = (moved.x, moved.y, moved.z)
        rotation: Quaternion = (turned.x, turned.y, turned.z, turned.w)
        error = _wrong(parent, child, translation, rotation, authority)
        if error:
            get_logger("tf2").error(error)
            return
        cache = self._frames.get(child)
        if cache is None or isinstance(cache, StaticCache) != is_static:
            cache = self._frames[child] = StaticCache() if is_static else TimeCache(self._cache_time)
        self._frames.setdefault(parent, None)
        stamp = nanoseconds(transform.header.stamp)
        if cache.insert(Stored(stamp, parent, translation, normalized(rotation))):
            self._authorities[child] = authority
            return
        get_logger("tf2").warning(
            f"TF_OLD_DATA ignoring data from the past for frame {child} at time {shown(stamp)} according to authority "
            f"{authority}\nPossible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"
        )

    def _check(self, what: str, name: str) -> None:
        """Raise for a frame that cannot be looked up."""
        if not name or name[0] == "/":
            why = "in tf2 frame_ids cannot start with a '/'" if name else "in tf2 frame_ids cannot be empty"
            raise InvalidArgumentException(f'Invalid argument "{name}" passed to {what} - {why}')
        if name not in self._frames:
            raise LookupException(f'"{name}" passed to {what} does not exist. ')

    def _can(self, legs: tuple[tuple[str, str, int], ...], **frames: str) -> tuple[int, str]:
        if len(legs) == 1 and frames["target"] == frames["source"]:
            return 1, ""
        for what, name in frames.items():
            if not name or name[0] == "/" or name not in self._frames:
                why = "frame does not exist" if name else "in tf2 frame_ids cannot be empty"
                why = "in tf2 frame_ids cannot start with a '/'" if name[:1] == "/" else why
                return 0, f'Invalid frame ID "{name}" passed to canTransform argument {what}_frame - {why}'
        try:
            for target, source, time in legs:
                self._walk(target, source, time)
        except TransformException as error:
            return 0, str(error)
        return 1, ""

    def _looked_up(self, target: str, source: str, time: int) -> tuple[_Motion, int]:
        """Return a motion, and its time (ns)."""
        if target == source:
            cache = self._frames.get(target)
            return _NO_MOTION, cache.latest if cache is not None and not time else time
        self._check("lookupTransform argument target_frame", target)
        self._check("lookupTransform argument source_frame", source)
        return self._walk(target, source, time)

    def _walk(self, target: str, source: str, time: int) -> tuple[_Motion, int]:
        """Return the motion from a frame up to the common parent and down to the other one, and its time (ns)."""
        if target == source:
            return _NO_MOTION, time
        time = time or self._latest_common_time(target, source)
        up, top, failed = self._climb(source, (target,), time)  # there may still be a path from source to target
        if top == target:
            return up, time
        down, end, error = self._climb(target, (top, source), time)
        if error is not None:
            raise _between(error, target, source)
        if end == source:
            return _inverse(down), time
        if end != top:
            raise _unconnected(target, source) if failed is None else _between(failed, target, source)
        return _then(up, _inverse(down)), time

    def _climb(
        self, frame: str, ends: tuple[str, ...], time: int
    ) -> tuple[_Motion, str, ExtrapolationException | None]:
        """Return the motion from a frame up to one of the ends or as far as it is known, the frame there, an error."""
        motion = _NO_MOTION
        for _ in range(_MOST_PARENTS + 1):
            cache = self._frames.get(frame)
            if frame in ends or cache is None:
                return motion, frame, None
            try:
                stored = cache.at(time)
            except ExtrapolationException as error:
                return motion, frame, error
            motion = _then(motion, (stored.translation, stored.rotation))
            frame = stored.parent
        raise self._loop()

    def _latest_common_time(self, target: str, source: str) -> int:
        """Return the latest time (ns) of all transforms between two frames; zero if all are static."""
        if target == source:
            cache = self._frames.get(source)
            return 0 if cache is None else cache.latest
        up = self._parents(source, target)
        if up and up[-1][1] == target:
            return _earliest(up)
        parents = {parent: index for index, (_, parent) in enumerate(up)}
        down = self._parents(target, source, *parents)
        if down and down[-1][1] == source:
            return _earliest(down)
        if not down or down[-1][1] not in parents:
            raise _unconnected(target, source)
        return _earliest([*down, *up[: parents[down[-1][1]] + 1]])

    def _parents(self, frame: str, *ends: str) -> list[tuple[int, str]]:
        """Return the latest times (ns) of the transforms from a frame upwards, each with its parent."""
        found: list[tuple[int, str]] = []
        while (cache := self._frames.get(frame)) is not None and cache.latest_parent:
            frame = cache.latest_parent
            found.append((cache.latest, frame))
            if frame in ends:
                break
            if len(found) > _MOST_PARENTS:
                raise self._loop()
        return found

    def _loop(self) -> LookupException:
        return LookupException(f"The tf tree is invalid because it contains a loop.\n{self.all_frames_as_string()}\n")


def nanoseconds(value: Any, what: str = "time") -> int:
    """Return a time or duration of rclpy or a message (ns).

    Raises:
        TypeError: If the value is of another type.
    """
    if hasattr(value, "sec") and hasattr(value, "nanosec"):
        return int(value.sec) * _SECOND + int(value.nanosec)
    if hasattr(value, "nanoseconds"):
        return int(value.nanoseconds)
    raise TypeError(f"{what} must have sec and nanosec, or nanoseconds.")


def _earliest(times: list[tuple[int, str]]) -> int:
    earliest = min((time for time, _ in times if time), default=inf)
    return 0 if earliest == inf else int(earliest)


def _then(first: _Motion, second: _Motion) -> _Motion:
    """Return one motion and then another, both from frame to frame."""
    translation, rotation = second
    return add(rotate(rotation, first[0]), translation), multiply(rotation, first[1])


def _inverse(motion: _Motion) -> _Motion:
    translation, rotation = motion
    back = inverse(rotation)
    x, y, z = rotate(back, translation)
    return (-x, -y, -z), back


def _message(target: str, source: str, motion: _Motion, time: int) -> Any:
    found = message_class("geometry_msgs/msg/TransformStamped")()
    stamp, moved, turned = found.header.stamp, found.transform.translation, found.transform.rotation
    stamp.sec, stamp.nanosec = divmod(time, _SECOND)
    found.header.frame_id, found.child_frame_id = target, source
    moved.x, moved.y, moved.z = motion[0]
    turned.x, turned.y, turned.z, turned.w = normalized(motion[1])
    return found


def _between(error: ExtrapolationException, target: str, source: str) -> ExtrapolationException:
    return ExtrapolationException(f"{error}, when looking up transform from frame [{source}] to frame [{target}]")


def _unconnected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part of the same tree."
        "Tf has two or more unconnected trees."
    )


def _wrong(parent: str, child: str, translation: Vector, rotation: Quaternion, authority: str) -> str:
    """Return why a transform is left out; empty if it is not."""
    start = f'Ignoring transform for child_frame_id "{child}" from authority "{authority}" because of'
    turned = " ".join(f"{value:f}" for value in rotation)
    if child == parent:
        return (
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and  child_frame_id '
            f'"{child}" because they are the same'
        )
    if not child:
        return f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because child_frame_id not set '
    if not parent:
        return (
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority "{authority}" because '
            "frame_id not set"
        )
    if any(map(isnan, (*translation, *rotation))):
        moved = " ".join(f"{value:f}" for value in translation)
        return f"TF_NAN_INPUT: {start} a nan value in the transform ({moved}) ({turned})"
    if not any(rotation):  # of another length it is normalized on its way into the matrix of a tf2::Transform
        return f"TF_DENORMALIZED_QUATERNION: {start} an invalid quaternion in the transform ({turned})"
    return ""
