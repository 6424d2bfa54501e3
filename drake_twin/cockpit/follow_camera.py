"""A camera that goes along with a robot.

Meshcat's camera belongs to whoever turns it with the mouse, so it stays and the scene is moved under it: the robot
stands still in the picture, and can be looked at from all sides meanwhile.
"""

from collections.abc import Sequence

import numpy as np
from pydrake.math import RigidTransform

from drake_twin.cockpit.scene import OVERLAYS, TWIN, Scene
from drake_twin.twin.twin import Twin

_MOVED = (TWIN, OVERLAYS, "/Grid")
_FROM = np.array([1.1, -1.0, 0.9])  # m: where the camera begins, seen from the robot


class FollowCamera:
    """Moves the scene so that a robot stays in the middle of the picture.

    Args:
        scene: what the page draws.

    Attributes:
        robot: the robot; empty for none.
    """

    def __init__(self, scene: Scene):
        self._scene = scene
        self.robot = ""
        self._offset: tuple[float, ...] = (0.0, 0.0, 0.0)

    def follow(self, robot: str, twin: Twin) -> None:
        """Goes along with a robot from now on; with none when the name is empty.

        Raises:
            InputError: no such robot.
        """
        if robot:
            twin.robot_state(robot)
        if robot == self.robot:
            return
        before, self.robot = np.array(self._offset), robot
        if robot:
            self.draw(twin)
            self._scene.set_camera_pose(_FROM, np.zeros(3))
        else:
            self._move((0.0, 0.0, 0.0))
            self._scene.set_camera_pose(before + _FROM, before)

    def draw(self, twin: Twin) -> None:
        """Moves the scene to where the robot is now."""
        if not self.robot:
            return
        if self.robot not in twin.robots:
            self.follow("", twin)
            return
        self._move(twin.robot_state(self.robot).base_pose[:3])

    def _move(self, offset: Sequence[float]) -> None:
        if tuple(offset) == self._offset:
            return
        self._offset = tuple(offset)
        for path in _MOVED:
            self._scene.set_transform(path, RigidTransform(-np.array(offset)))
