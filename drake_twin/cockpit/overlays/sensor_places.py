"""Where sensors are and what they can see: the frustums of cameras, the fans of lidars."""

from itertools import pairwise

import numpy as np

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_folders import BodyFolders
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.sensors.cameras.settings import CameraSettings
from drake_twin.sensors.lidar import LidarSettings
from drake_twin.sensors.sensor_host import sensor_hosts
from drake_twin.twin.twin import Twin

_FAR_CAMERA, _FAR_RAY = 1.0, 3.0  # m: no line is drawn farther away
_RAYS = 13  # of a row that are drawn
_COLOR = (0.98, 0.75, 0.15)


@overlay("sensors", "Sensors' views", "The frustums of cameras and the fans of lidars, as the files describe them", "B")
class SensorPlaces:
    """Lines for each camera and lidar, which move with their links."""

    def __init__(self, scene: Scene, twin: Twin):
        self._folders = BodyFolders(scene, twin, f"{OVERLAYS}/sensors")
        setups = [sensor.setup for host in sensor_hosts(twin.diagram) for sensor in host.sensors]
        for number, setup in enumerate(setups):
            if (ends := lines_of(setup.settings)) is None:
                continue
            body, X_BS = setup.body, setup.pose
            if not setup.sensor.link:  # it is on a joint, with the joint's frame on the child link
                body = setup.joint.child_body()
                X_BS = setup.joint.frame_on_child().GetFixedPoseInBodyFrame() @ X_BS
            folder, X_FB = self._folders.of(body.index())
            scene.set_lines(f"{folder}/{number}", ends, _COLOR)
            scene.set_transform(f"{folder}/{number}", X_FB @ X_BS)

    def draw(self) -> None:
        """Move the lines to their sensors, where no browser does."""
        self._folders.draw()

    def remove(self) -> None:
        """Remove the lines."""
        self._folders.remove()


def lines_of(settings: object) -> np.ndarray | None:
    """Return the ends of the lines that show what a sensor can see, in its frame (m); None if there is nothing."""
    if isinstance(settings, CameraSettings):
        return _frustum(settings)
    return _fan(settings) if isinstance(settings, LidarSettings) else None


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
