"""What the page shows of a mirror: the robot as it was measured, a ghost beside its twin, and what differs."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.page_panel import page_panel
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.mirror.mirror import Mirror
from drake_twin.twin.twin import Twin

if TYPE_CHECKING:
    from drake_twin.cockpit.page_panel import PagePanel

_COLOR = (0.90, 0.30, 0.25)
_MOST = 8  # numbers that are listed
_LIGHTS = {0: "ok:", 1: "look:", 2: "alarm:"}


def show_on_page(mirror: Mirror) -> None:
    """Let pages of this process show a mirror: an overlay with the ghosts of its robots, and a panel."""

    @overlay("robot", "Robot", "A red ghost of each robot where it was measured, beside its twin", "B")
    class Measured:
        """The robots as they were measured."""

        def __init__(self, scene: Scene, twin: Twin):
            self._scene, self._ghosts = scene, _Ghosts(scene, twin, mirror)

        def draw(self) -> None:
            """Draw the last measurements."""
            self._ghosts.draw()

        def remove(self) -> None:
            """Remove the ghosts."""
            self._scene.delete(f"{OVERLAYS}/robot")

    page_panel("Mirror")(lambda panel, twin: _fill(panel, mirror))


def lights(mirror: Mirror) -> dict[str, str]:
    """Return for each robot whether it is as its twin (ok), was not (look) or is not (alarm), and a text."""
    return {
        robot: f"{_LIGHTS[level]} {text}" for robot, level, text in (mirror.condition(robot) for robot in mirror.robots)
    }


def _fill(panel: "PagePanel", mirror: Mirror) -> None:
    panel.table("robots", lambda: lights(mirror))
    panel.table("alarms", lambda: {f"{a.began:.1f} s {a.robot}": f"{a.kind}: {a.text}" for a in mirror.alarms[-_MOST:]})
    panel.plot("on the way to an alarm (at 1)", _highest(mirror))


def _highest(mirror: Mirror) -> Callable[[], dict[str, float]]:
    def get() -> dict[str, float]:
        found: dict[str, float] = {}
        for name, level in mirror.levels().items():
            kind = name.rpartition(" ")[2].rpartition(".")[2]
            found[kind] = max(found.get(kind, 0.0), min(level, 2.0))
        return found

    return get


class _Ghosts:
    """Copies of the robots at their measured positions."""

    def __init__(self, scene: Scene, twin: Twin, mirror: Mirror):
        self._scene, self._twin, self._mirror = scene, twin, mirror
        self._context = twin.plant.CreateDefaultContext()
        self._drawn: set[str] = set()

    def draw(self) -> None:
        twin, plant = self._twin, self._twin.plant
        own = plant.GetMyContextFromRoot(twin.context)
        paths = self._scene.shared(twin).body_paths
        for plan in twin.built.plans:
            measured = self._mirror.measured(plan.name)
            if measured is None:
                continue
            parts = twin.built.robots[plan.name]
            q = np.array(plant.GetPositions(own, parts.instance))
            for joint, at in measured.positions.items():
                if joint in parts.layout.positions:
                    q[parts.layout.positions[joint]] = at
            plant.SetPositions(self._context, parts.instance, q)
            root = plant.GetBodyByName(plan.model.root_body, parts.instance)
            if measured.place is not None and root.is_floating_base_body():
                x, y, yaw = measured.place
                X = plant.EvalBodyPoseInWorld(own, root)
                turn = yaw - np.arctan2(X.rotation().matrix()[1, 0], X.rotation().matrix()[0, 0])
                R = RotationMatrix.MakeZRotation(float(turn)) @ X.rotation()
                plant.SetFreeBodyPose(self._context, root, RigidTransform(R, [x, y, X.translation()[2]]))
            for index in plant.GetBodyIndices(parts.instance):
                if int(index) in paths:
                    self._put(paths[int(index)], plant.EvalBodyPoseInWorld(self._context, plant.get_body(index)))

    def _put(self, body: str, X_WB: RigidTransform) -> None:
        path = f"{OVERLAYS}/robot/{body}"
        if body not in self._drawn:
            self._drawn.add(body)
            self._scene.set_ghost(path, body, _COLOR)
        self._scene.set_transform(path, X_WB)
