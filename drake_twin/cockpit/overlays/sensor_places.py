"""Where sensors are and what they can see: the frustums of cameras, the fans of lidars."""

from itertools import pairwise

import numpy as np

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.sensors.cameras.settings import CameraSettings
from drake_twin.sensors.lidar import LidarSettings
from drake_twin.twin.twin import Twin

_FAR_CAMERA, _FAR_RAY = 1.0, 3.0  # m: no line is drawn farther away
_RAYS = 13  # of a row that are drawn
_COLOR = (0.98, 0.75, 0.15)


@overlay("sensors", "Sensors' views", "The frustums of cameras and the fans of lidars, as the files describe them", "B")
class SensorPlaces:
    """Lines for each camera and lidar, which move with their links."""

    def __init__(self, scene: Scene, twin: Twin):
        self._scene, self._twin = scene, twin
        self._drawn: list[tuple[str, str, str]] = []
        for owner, item in twin.entities.sensors:
            if (ends := lines_of(item)) is not None:
                path = f"{OVERLAYS}/sensors/{len(self._drawn)}"
                scene.set_lines(path, ends, _COLOR)
                self._drawn.append((path, owner, item.place))

    def draw(self) -> None:
        """Move the lines to their sensors."""
        for path, robot, place in self._drawn:
            self._scene.set_transform(path, self._twin.sensor(robot, place).pose)

    def remove(self) -> None:
        """Remove the lines."""
        self._scene.delete(f"{OVERLAYS}/sensors")


def lines_of(plan: SensorPlan) -> np.ndarray | None:
    """Return the ends of the lines that show what a sensor can see, in its frame (m); None if there is nothing."""
    if isinstance(plan.settings, CameraSettings):
        return _frustum(plan.settings)
    return _fan(plan.settings) if isinstance(plan.settings, LidarSettings) else None


def _frustum(camera: CameraSettings) -> np.ndarray:
    fx, fy, cx, cy = camera.drawn
    corners = [
        _FAR_CAMERA * np.array([1.0, -(u - cx) / fx, -(v - cy) / fy])
        for u, v in (
            (-0.5, -0.5),
            (camera.width - 0.5, -0.5),
            (camera.width - 0.5, camera.height - 0.5),
            (-0.5, camera.height - 0.5),
        )
    ]
    eye = np.zeros(3)
    sides = [(eye, corner) for corner in corners]
    rim = [(corners[index - 1], corners[index]) for index in range(4)]
    return np.array(sides + rim).reshape(-1, 3)


def _fan(lidar: LidarSettings) -> np.ndarray:
    grid = lidar.grid
    across = np.linspace(grid.angle_min, grid.angle_max, _RAYS)
    ends = []
    for height in sorted({grid.row_min, grid.row_max} if grid.rows > 1 else {grid.row_min}):
        rays = np.column_stack(
            [np.cos(height) * np.cos(across), np.cos(height) * np.sin(across), np.full(_RAYS, np.sin(height))]
        )
        near, far = grid.range_min * rays, min(grid.range_max, _FAR_RAY) * rays
        ends += [point for pair in zip(near, far, strict=True) for point in pair]
        ends += [point for pair in pairwise(far) for point in pair]
    return np.array(ends)
