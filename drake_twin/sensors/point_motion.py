"""Position and velocity of a point of a link."""

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.sensors.sensor_system import SensorSystem


class PointMotion:
    """Position and velocity of a point of a link, from the plant's poses and velocities.

    Args:
        sensor: The sensor whose input ports carry them; they are declared here.
        body: The index of the link's body.
        point: The point P in the body's frame B (m).
    """

    def __init__(self, sensor: SensorSystem, body: int, point: np.ndarray):
        self._body, self._p_BP_B = body, np.array(point)
        self._poses = sensor.declare_plant_input("body_poses")
        self._velocities = sensor.declare_plant_input("body_spatial_velocities")

    def position(self, context: Context) -> np.ndarray:
        """Return the position in the world (m)."""
        return np.array(self._poses.Eval(context)[self._body].multiply(self._p_BP_B))

    def velocity(self, context: Context) -> np.ndarray:
        """Return the velocity in the world (m/s)."""
        V_WB = self._velocities.Eval(context)[self._body]
        p_BP_W = self._poses.Eval(context)[self._body].rotation().matrix() @ self._p_BP_B
        return np.array(V_WB.translational()) + np.cross(V_WB.rotational(), p_BP_W)
