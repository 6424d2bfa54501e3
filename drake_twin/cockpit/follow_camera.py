"""A camera that follows a robot.

The user turns Meshcat's camera with the mouse, so the camera stays and the scene is moved under it: the robot stays in
the middle of the picture, and the user can look at it from all sides.
"""

from collections.abc import Sequence

import numpy as np
from pydrake.math import RigidTransform

from drake_twin.cockpit.scene import OVERLAYS, TWIN, Scene
from drake_twin.twin.twin import Twin

_MOVED = (TWIN, OVERLAYS)
_FROM = np.array([1.1, -1.0, 0.9])  # m: the initial position of the camera relative to the robot


class FollowCamera:
    """Moves the scene so that a robot stays in the middle of the picture.

    Args:
        scene: The page's scene.

    Attributes:
        robot: The name of the robot; empty if the camera follows no robot.
    """

    def __init__(self, scene: Scene):
        self._scene = scene
        self.robot = ""
        self._offset: tuple[float, ...] = (0.0, 0.0, 0.0)

    def follow(self, robot: str, twin: Twin) -> None:
        """Follow a robot from now on, or no robot if the name is empty.

        Raises:
            InputError: If the twin has no robot of the name.
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
        """Move the scene so that the robot is in the middle."""
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
