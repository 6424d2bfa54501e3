"""What a sensor measures at the present time, as NumPy arrays."""

from typing import Any

import numpy as np
from pydrake.math import RigidTransform

from drake_twin.errors import InputError
from drake_twin.sensors.sensor_host import sensor_hosts
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.systems.no_message import or_none
from drake_twin.twin.owner import Owned
from drake_twin.twin.session import Session


class SensorReading(Owned, path="twin.sensor(…)"):
    """A sensor of a twin; each of its values is measured when it is asked for, at the present time.

    Args:
        session: The twin's session.
        robot: The robot's name, or that of a model of the world.
        name: The sensor's name, or ``LINK/NAME`` where two sensors of the robot have one name.

    Raises:
        InputError: If the robot or the sensor is unknown.
    """

    def __init__(self, session: Session, robot: str, name: str):
        self._owner = session.owner
        self._session, self._robot, self._name = session, robot, name
        self._system()

    @property
    def image(self) -> np.ndarray | None:
        """The color picture of a camera, (height, width, 3), or (height, width) in shades of grey or a Bayer pattern.

        None while there are no pictures.
        """
        return self._pixels("image")

    @property
    def depth(self) -> np.ndarray | None:
        """The depths that a camera sees, (height, width) (m): -inf for what is too near, inf for what is too far."""
        return self._pixels("depth")

    @property
    def label(self) -> np.ndarray | None:
        """The body that each pixel of a camera shows, (height, width): its index in the plant, and one; 0 for none."""
        return self._pixels("label")

    @property
    def ranges(self) -> np.ndarray:
        """The ranges of a lidar's scan (m)."""
        return np.asarray(self.message("scan").ranges)

    @property
    def pose(self) -> RigidTransform:
        """The sensor's pose in the world; of one on a joint, with the joint's frame on the child link."""
        setup = self._system().setup
        context = self._session.physics.plant_context
        if setup.sensor.link:
            return setup.body.EvalPoseInWorld(context) @ setup.pose
        return setup.joint.frame_on_child().CalcPoseInWorld(context) @ setup.pose

    def message(self, own: str) -> Any:
        """Return a message that the sensor publishes, whether or not a bridge carries it.

        Args:
            own: Its output port: ``image``, ``depth``, ``points``, ``info`` or ``label`` of a camera, ``scan`` or
                ``points`` of a lidar, ``message`` of other sensors.

        Raises:
            InputError: If the sensor has none.
        """
        system = self._system()
        valid = [
            port.get_name().removeprefix(system.setup.prefix)
            for port in map(system.host.get_output_port, range(system.host.num_output_ports()))
            if port.get_name().startswith(system.setup.prefix)
        ]
        if own not in valid:
            raise InputError(f"sensor {self._name!r} of {self._robot!r} has no {own!r}", value=own, valid=valid)
        return or_none(system.output(own).Eval(system.host.GetMyContextFromRoot(self._session.physics.context)))

    def _pixels(self, own: str) -> np.ndarray | None:
        from drake_twin.sensors.cameras.picture_messages import pixels

        message = self.message(own)
        return None if message is None else pixels(message)

    def _system(self) -> SensorSystem:
        """Return the sensor in the present diagram."""
        built = self._session.built
        owners = [*built.robots, *(model.name for model in built.sensing_models)]
        if self._robot not in owners:
            raise InputError(f"unknown robot {self._robot!r}", value=str(self._robot), valid=owners)
        found: dict[str, SensorSystem] = {
            f"{sensor.setup.sensor.link or sensor.setup.sensor.joint}/{sensor.setup.sensor.name}": sensor
            for host in sensor_hosts(built.diagram)
            for sensor in host.sensors
            if sensor.setup.owner == self._robot
        }
        for place, sensor in found.items():
            if self._name in (place, sensor.setup.sensor.name):
                return sensor
        raise InputError(f"robot {self._robot!r} has no sensor {self._name!r}", value=str(self._name), valid=found)
