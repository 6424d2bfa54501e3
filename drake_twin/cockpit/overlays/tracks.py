"""The path that each robot drove in the last minute."""

from collections import deque
from itertools import pairwise

import numpy as np
from pydrake.multibody.tree import BodyIndex

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.twin.twin import Twin

_PATH = f"{OVERLAYS}/tracks"
_SECONDS = 60.0  # s of simulation time
_APART = 0.1  # s of simulation time between two points
_STRETCH = 2.0  # s of simulation time that are drawn as one object, so that old ones are not sent again
_MOVED = 2e-3  # m; a smaller motion is not drawn
_FASTEST = 40.0  # m/s: what is farther apart was put there
COLORS = np.array(
    [
        (0.15, 0.39, 0.66),
        (0.85, 0.41, 0.04),
        (0.17, 0.54, 0.24),
        (0.70, 0.15, 0.12),
        (0.48, 0.32, 0.70),
        (0.54, 0.35, 0.24),
        (0.76, 0.33, 0.60),
        (0.06, 0.56, 0.60),
    ]
)


@overlay("tracks", "Tracks", "The path of each robot in the last minute; of a fixed robot, of its last link", "T")
class Tracks:
    """Lines in a color for each robot, through the places of its root link; of a fixed robot, of its last link."""

    def __init__(self, scene: Scene, twin: Twin):
        self._scene, self._twin = scene, twin
        self._bodies = [_tracked(twin, plan) for plan in twin.built.plans]
        self._colors = COLORS[np.arange(len(self._bodies)) % len(COLORS)]
        self._samples: deque[tuple[float, np.ndarray]] = deque()  # times (s) and places, shape (robots, 3)
        self._stretches: set[int] = set()

    def draw(self) -> None:
        """Extend the paths to the present; after a reset, end them there."""
        now = self._twin.time
        if self._samples and self._samples[-1][0] > now:
            self._end_at(now)
        if not self._is_due(now):
            return
        plant = self._twin.plant
        poses = plant.get_body_poses_output_port().Eval(plant.GetMyContextFromRoot(self._twin.context))
        self._add(now, np.array([poses[body].translation() for body in self._bodies]).reshape(-1, 3))

    def note_past(self, time: float, frame: Frame) -> None:
        """Add what was drawn at a time (s), after those that were noted before; other robots are left out."""
        if frame.scene is not self._scene.shared(self._twin) or not self._is_due(time):
            return
        rows = {body: row for row, body in enumerate(frame.scene.body_paths)}
        tracked = [rows.get(int(body)) for body in self._bodies]
        places = [np.full(3, np.nan) if row is None else frame.poses[row, :3, 3] for row in tracked]
        self._add(time, np.array(places).reshape(-1, 3))

    def remove(self) -> None:
        """Remove the paths."""
        self._scene.delete(_PATH)

    def _is_due(self, time: float) -> bool:
        return not self._samples or time - self._samples[-1][0] > _APART - 1e-6

    def _end_at(self, time: float) -> None:
        """Drop what is after a time (s), to which the twin was returned."""
        while self._samples and self._samples[-1][0] > time:
            self._samples.pop()
        for stretch in [each for each in self._stretches if (each + 1) * _STRETCH > time]:
            self._drop(stretch)
        self._write(int(time // _STRETCH))

    def _add(self, time: float, places: np.ndarray) -> None:
        last = self._samples[-1][1] if self._samples else None
        if last is not None and not (np.abs(places - last).max(initial=0.0) > _MOVED or np.isnan(places - last).any()):
            return
        self._samples.append((time, places))
        while self._samples[0][0] < time - _SECONDS:
            self._samples.popleft()
        for stretch in [each for each in self._stretches if (each + 1) * _STRETCH < time - _SECONDS]:
            self._drop(stretch)
        self._write(int(time // _STRETCH))

    def _write(self, stretch: int) -> None:
        """Draw what was driven in a stretch of time."""
        begin = stretch * _STRETCH
        samples = [sample for sample in reversed(self._samples) if sample[0] >= begin]
        samples += [sample for sample in reversed(self._samples) if sample[0] < begin][:1]
        ends, colors = [], []
        for (late, here), (early, there) in pairwise(samples):
            far = np.linalg.norm(here - there, axis=1)
            is_driven = (far > 1e-6) & (far < _FASTEST * (late - early))
            ends.append(np.stack([there, here], axis=1)[is_driven].reshape(-1, 3))
            colors.append(np.repeat(self._colors[is_driven], 2, axis=0))
        if not sum(map(len, ends)):
            return
        self._stretches.add(stretch)
        self._scene.set_lines(f"{_PATH}/{stretch}", np.vstack(ends), np.vstack(colors))

    def _drop(self, stretch: int) -> None:
        self._stretches.remove(stretch)
        self._scene.delete(f"{_PATH}/{stretch}")


def _tracked(twin: Twin, plan: RobotPlan) -> BodyIndex:
    """Return the body whose path is drawn: the root link, or the last link where that is fixed to the world."""
    plant, instance = twin.plant, twin.built.robots[plan.name].instance
    root = plant.GetBodyByName(plan.model.root_body, instance)
    fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
    if root.index() not in fixed:
        return root.index()
    above = {joint.child: joint for joint in plan.description.joints}

    def depth(link: str) -> int:
        joint = above.get(link)
        return 0 if joint is None else depth(joint.parent) + joint.is_movable

    links = [joint.child for joint in plan.description.joints if plant.HasBodyNamed(joint.child, instance)]
    return plant.GetBodyByName(max(links, key=depth), instance).index() if links else root.index()
