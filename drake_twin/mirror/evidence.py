"""What is known of a robot since something changed: its differences to the twin as arrays, and shares of them."""

from collections.abc import Callable, Container, Sequence
from functools import cached_property

import numpy as np

from drake_twin.mirror.detector import Detector, Judged
from drake_twin.mirror.watched import JOINTS, POSE
from drake_twin.twin.twin import Twin

_MOST = 10.0  # standard deviations that a measurement counts
_BEFORE = 0.15  # s before a change seems to have begun
MOVES = 0.05  # rad/s or m/s from which on a joint moves
_OFF = 0.05  # of the twin's velocity by which a joint's is another
_ALONE = 0.55  # of all joints' energy that is one joint's, from which on it is about this joint
_FAR = 4.0  # standard deviations
_SEEN = 4.0  # mean square of deviations from which on a delay is looked for


class Joints:
    """The joints' measurements, of shape (N, J): positions, velocities and efforts.

    Args:
        judged: The measurements.
        followers: The joints that follow others.

    Attributes:
        names: The J joints; joints that follow others are left out.
        times: Of the measurements (s), shape (N,).
    """

    def __init__(self, judged: Sequence[Judged], followers: Container[str]):
        first = judged[0].innovation.predicted if judged else {}
        names = [name.removesuffix(".velocity") for name in first if name.endswith(".velocity")]
        self.names = [name for name in names if name not in followers]
        self.times = np.array([item.time for item in judged])
        self._judged = judged

    def measured(self, kind: str) -> np.ndarray:
        """What was measured; NaN of what was not."""
        return self._array(kind, lambda item, name: item.innovation.measured.get(name, np.nan))

    def predicted(self, kind: str) -> np.ndarray:
        """What the twin had."""
        return self._array(kind, lambda item, name: item.innovation.predicted.get(name, np.nan))

    def left(self, kind: str) -> np.ndarray:
        """What of the differences is not explained."""
        return self._array(kind, lambda item, name: item.readings[name].left if name in item.readings else np.nan)

    def deviations(self, kind: str) -> np.ndarray:
        """The same in standard deviations, ten at most; zero of what was not measured."""
        found = self._array(kind, lambda item, name: item.readings[name].deviations if name in item.readings else 0.0)
        return np.asarray(np.clip(found, -_MOST, _MOST))

    def _array(self, kind: str, value: Callable[[Judged, str], float]) -> np.ndarray:
        names = [f"{joint}.{kind}" for joint in self.names]
        return np.array([[value(item, name) for name in names] for item in self._judged]).reshape(-1, len(names))


class Evidence:
    """The measurements of a robot since a change.

    Args:
        twin: The twin.
        robot: The robot.
        kept: Its measurements, the last seconds.
        began: When the change seems to have begun (s).
        detector: What found it.

    Attributes:
        joints: Of its joints.
        before: The same before the change.
    """

    def __init__(self, twin: Twin, robot: str, kept: Sequence[Judged], began: float, detector: Detector):
        self.twin, self.robot = twin, robot
        self.began = began
        self._since = [item for item in kept if item.time >= began - _BEFORE]
        self._earlier = [item for item in kept if item.time < began - _BEFORE]
        plan = next(plan for plan in twin.built.plans if plan.name == robot)
        followers = {joint.name for joint in plan.description.joints if joint.mimic is not None}
        self.joints = Joints([item for item in self._since if item.innovation.watched.kind == JOINTS], followers)
        self.before = Joints([item for item in self._earlier if item.innovation.watched.kind == JOINTS], followers)
        self.before.names = self.joints.names
        self.frozen = [name for _, name in detector.frozen()]
        self.jittery = [name for _, name in detector.jittery()]
        self._noise = detector.noise()

    @cached_property
    def energy(self) -> dict[str, np.ndarray]:
        """Kind → the mean square of each joint's deviations beyond that of noise, shape (J,)."""
        kinds = ("position", "velocity", "effort")
        return {
            kind: np.maximum(np.mean(self.joints.deviations(kind) ** 2, axis=0) - 1.0, 0.0)
            if len(self.joints.times)
            else np.zeros(len(self.joints.names))
            for kind in kinds
        }

    @cached_property
    def energies(self) -> np.ndarray:
        """The sum of `energy` of each joint, shape (J,)."""
        return np.asarray(sum(self.energy.values()))

    def alone(self, *kinds: str) -> int | None:
        """Return the joint that has most of the energy of some kinds, for then it is about this joint; None without."""
        energies = np.asarray(sum(self.energy[kind] for kind in kinds))
        total = float(np.sum(energies)) if energies.size else 0.0
        if not total > 0 or float(np.max(energies)) < max(_ALONE * total, 1.0):
            return None
        return int(np.argmax(energies))

    def base(self, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return a number of the base: times, what is left of its differences, deviations (ten at most)."""
        own = [item for item in self._since if item.innovation.watched.kind == POSE and name in item.readings]
        times = np.array([item.time for item in own])
        left = np.array([item.readings[name].left for item in own])
        deviations = np.clip([item.readings[name].deviations for item in own], -_MOST, _MOST)
        return times, left, np.asarray(deviations, dtype=float)

    def base_energy(self, *names: str) -> float:
        """The largest mean square of some numbers' deviations beyond that of noise."""
        found = [self.base(name)[2] for name in names]
        return max((float(np.mean(own**2)) - 1.0 for own in found if len(own)), default=0.0)

    def lasts(self, *names: str) -> float:
        """Return for how long numbers of the base have been far off, from the first time to the last (s)."""
        spans = [0.0]
        for name in names:
            times, _, deviations = self.base(name)
            far = times[np.abs(deviations) > _FAR]
            spans.append(float(np.ptp(far)) if len(far) > 1 else 0.0)
        return max(spans)

    @property
    def grip(self) -> float:
        """The efforts of all joints while some move, in those of the twin; NaN if they are not measured."""
        own = self.joints
        if len(own.times) < 4:
            return float("nan")
        moving = np.any(np.abs(own.predicted("velocity")) > MOVES, axis=1)
        found, expected = np.abs(own.measured("effort"))[moving], np.abs(own.predicted("effort"))[moving]
        total = float(np.nansum(np.where(np.isfinite(found), expected, 0.0)))
        return float(np.nansum(found)) / total if total > 0 and np.isfinite(found).any() else float("nan")

    def deviations(self, name: str) -> np.ndarray:
        """Return the deviations of any number since the change, ten at most."""
        found = [item.readings[name].deviations for item in self._since if name in item.readings]
        return np.asarray(np.clip(found, -_MOST, _MOST))

    @property
    def has_base(self) -> bool:
        """Whether the base was measured since."""
        return len(self.base("yaw")[0]) > 0

    def gain(self, joint: int, last: float = 0.8) -> float:
        """Return which part of the twin's velocity a joint had while the twin's moved; NaN if it did not.

        Args:
            joint: Its number.
            last: The last seconds that count.
        """
        own = self.joints
        late = own.times >= max(own.times[-1] - last, self.began)
        expected, found = own.predicted("velocity")[late, joint], own.measured("velocity")[late, joint]
        counts = (np.abs(expected) > MOVES) & np.isfinite(found)
        if np.count_nonzero(counts) < 4:
            return float("nan")
        return float(np.dot(expected[counts], found[counts]) / np.dot(expected[counts], expected[counts]))

    @property
    def slow(self) -> int | None:
        """The only joint that does not have the twin's velocity, while its change is seen; None without one."""
        gains = [self.gain(joint) for joint in range(len(self.joints.names))]
        off = [
            joint for joint, gain in enumerate(gains) if abs(gain - 1.0) > _OFF and self.energy["velocity"][joint] > 1.0
        ]
        return off[0] if len(off) == 1 else None

    def effort_pattern(self, joint: int) -> tuple[float, float]:
        """Return how much of a joint's effort that is left follows its direction, and how much is constant (0 to 1)."""
        left = self.joints.left("effort")[:, joint]
        speed = self.joints.predicted("velocity")[:, joint]
        ok = np.isfinite(left)
        total = float(np.sum(left[ok] ** 2))
        if not total > 0:
            return 0.0, 0.0
        sign = np.tanh(speed[ok] / MOVES)
        along = float(np.dot(sign, left[ok])) ** 2 / max(float(np.dot(sign, sign)), 1e-9) / total
        constant = float(np.sum(left[ok])) ** 2 / np.count_nonzero(ok) / total
        return along, constant

    def jump(self, joint: int) -> float:
        """Return the largest step of a joint's position that no velocity of before or after explains, in its noise."""
        own, earlier = self.joints, self.before
        times = np.concatenate([earlier.times[-2:], own.times])
        if len(times) < 3:
            return 0.0
        position = np.concatenate([earlier.measured("position")[-2:], own.measured("position")])[:, joint]
        speed = np.concatenate([earlier.measured("velocity")[-2:], own.measured("velocity")])[:, joint]
        ways = np.diff(times) * np.array([speed[:-1], speed[1:]])
        steps = np.diff(position)
        beyond = steps - np.clip(steps, np.min(ways, axis=0), np.max(ways, axis=0))
        beyond = beyond[np.isfinite(beyond)]
        scale = max(float(np.median(np.abs(beyond))) * 1.5, 1e-4)
        return float(np.max(np.abs(beyond), initial=0.0)) / scale

    def delay(self) -> tuple[float, float]:
        """Return by how much later all joints did what the twin's did (s), and the part of differences it explains."""
        own = self.joints
        if len(own.times) < 12:
            return 0.0, 0.0
        times = np.concatenate([self.before.times, own.times])
        expected = np.concatenate([self.before.predicted("velocity"), own.predicted("velocity")])
        found, noise = own.measured("velocity"), self.noise("velocity")
        known = np.isfinite(found).all(axis=0) & (noise > 0)
        if not np.any(known):
            return 0.0, 0.0

        def misfit(late: float) -> float:
            moved = [np.interp(own.times - late, times, expected[:, j]) for j in np.flatnonzero(known)]
            return float(np.mean(((found[:, known] - np.column_stack(moved)) / noise[known]) ** 2))

        without = misfit(0.0)
        if without < _SEEN:
            return 0.0, 0.0
        lates = np.arange(0.02, 0.4, 0.02)
        rests = [misfit(late) for late in lates]
        best = int(np.argmin(rests))
        return float(lates[best]), 1.0 - rests[best] / without

    def noise(self, kind: str) -> np.ndarray:
        """Return the standard deviation of each joint's number in the healthy run, shape (J,); zero if unknown."""
        return np.array([self._noise.get(f"{name}.{kind}", 0.0) for name in self.joints.names])
