"""A GPS's values as messages, as ros2_controllers' gps_sensor_broadcaster publishes them."""

from dataclasses import field
from math import isnan
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import check_covariances
from drake_twin.dataclass import dataclass

_INTERFACES = ("status", "service", "latitude", "longitude", "altitude")
_COVARIANCES = ("latitude_covariance", "longitude_covariance", "altitude_covariance")


@dataclass(frozen=True)
class GPSSensorBroadcasterParameters:
    """Parameters of ``gps_sensor_broadcaster/GPSSensorBroadcaster``.

    Attributes:
        sensor_name: The sensor in ``<ros2_control>``.
        frame_id: The frame of the values.
        static_position_covariance: Nine numbers, row by row (m²).
        read_covariance_from_interface: Whether the diagonal of the covariance comes from the sensor's state interfaces.
    """

    sensor_name: str = field(metadata={"not_empty": True})
    frame_id: str = field(metadata={"not_empty": True})
    static_position_covariance: tuple[float, ...] = (0.0,) * 9
    read_covariance_from_interface: bool = False


@controller("gps_sensor_broadcaster/GPSSensorBroadcaster")
class GPSSensorBroadcaster(HardwareSensorBroadcaster):
    """Publish a GPS's values as ``NavSatFix`` messages.

    Behaves as ``gps_sensor_broadcaster/GPSSensorBroadcaster`` in ROS 2 Jazzy. The twin does not simulate a GPS: the
    values are the state interfaces' ``initial_value`` in ``<ros2_control>``, or NaN. A status or service that is NaN is
    ``STATUS_UNKNOWN`` or ``SERVICE_UNKNOWN``; upstream, it is what the processor makes of NaN as an integer.

    .. pydrake_system::

        name: GPSSensorBroadcaster
        input_ports:
        - values
        output_ports:
        - gps/fix

    - ``values``: vector ``[status, service, latitude, longitude, altitude]`` (degrees, degrees, m above the ellipsoid),
      and with ``read_covariance_from_interface`` the variances of latitude, longitude and altitude (m²).
    - ``gps/fix``: ``sensor_msgs/msg/NavSatFix`` of the present time, None while inactive; topic ``~/gps/fix``.
    """

    Parameters: ClassVar[type] = GPSSensorBroadcasterParameters

    @classmethod
    def state_interfaces(cls, parameters: GPSSensorBroadcasterParameters) -> tuple[str, ...]:
        """Return status, service and position, and the variances if they are read."""
        names = (*_INTERFACES, *_COVARIANCES) if parameters.read_covariance_from_interface else _INTERFACES
        return tuple(f"{parameters.sensor_name}/{name}" for name in names)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        check_covariances(setup, "static_position_covariance")
        self.declare_message_output("gps/fix", "sensor_msgs/msg/NavSatFix", self._fix, self._present())

    def _fix(self, context: Context) -> Any:
        parameters: GPSSensorBroadcasterParameters = self.setup.parameters
        status, service, latitude, longitude, altitude, *variances = self._sensor.Eval(context).tolist()
        kind, state = messages.NavSatFix, messages.NavSatStatus
        known = kind.COVARIANCE_TYPE_DIAGONAL_KNOWN if variances else kind.COVARIANCE_TYPE_KNOWN
        covariance = np.diag(variances).ravel() if variances else np.array(parameters.static_position_covariance)
        return kind(
            header=messages.header(context.get_time(), self.setup.frame(parameters.frame_id)),
            status=state(
                status=state.STATUS_UNKNOWN if isnan(status) else int(status),
                service=state.SERVICE_UNKNOWN if isnan(service) else int(service),
            ),
            latitude=latitude,
            longitude=longitude,
            altitude=altitude,
            position_covariance=covariance,
            position_covariance_type=known,
        )
