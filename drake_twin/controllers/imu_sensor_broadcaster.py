"""An IMU's values as messages, as ros2_controllers' imu_sensor_broadcaster publishes them."""

from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import SensorBroadcaster, check_covariances
from drake_twin.dataclass import dataclass

_UNKNOWN_SPREAD = (0.0,) * 9
_INTERFACES = (
    *(f"orientation.{axis}" for axis in "wxyz"),
    *(f"angular_velocity.{axis}" for axis in "xyz"),
    *(f"linear_acceleration.{axis}" for axis in "xyz"),
)
_COVARIANCES = (
    "static_covariance_orientation",
    "static_covariance_angular_velocity",
    "static_covariance_linear_acceleration",
)


@dataclass(frozen=True)
class IMUSensorBroadcasterParameters:
    """Parameters of ``imu_sensor_broadcaster/IMUSensorBroadcaster``.

    Attributes:
        sensor_name: The sensor in ``<ros2_control>``.
        frame_id: The frame of the values.
        static_covariance_orientation: Nine numbers, row by row (rad²).
        static_covariance_angular_velocity: Nine numbers, row by row (rad²/s²).
        static_covariance_linear_acceleration: Nine numbers, row by row (m²/s⁴).
    """

    sensor_name: str = field(metadata={"not_empty": True})
    frame_id: str = field(metadata={"not_empty": True})
    static_covariance_orientation: tuple[float, ...] = _UNKNOWN_SPREAD
    static_covariance_angular_velocity: tuple[float, ...] = _UNKNOWN_SPREAD
    static_covariance_linear_acceleration: tuple[float, ...] = _UNKNOWN_SPREAD


@controller("imu_sensor_broadcaster/IMUSensorBroadcaster")
class IMUSensorBroadcaster(SensorBroadcaster):
    """Publish an IMU's values as ``Imu`` messages.

    Behaves as ``imu_sensor_broadcaster/IMUSensorBroadcaster`` in ROS 2 Jazzy.

    .. pydrake_system::

        name: IMUSensorBroadcaster
        input_ports:
        - spatial
        output_ports:
        - imu

    - ``spatial``: vector ``[qw qx qy qz, wx wy wz, ax ay az]`` (rad/s, m/s²), as from `ImuSensor`.
    - ``imu``: ``sensor_msgs/msg/Imu`` of the present time, None while inactive; topic ``~/imu``.
    """

    Parameters: ClassVar[type] = IMUSensorBroadcasterParameters
    kind = "imu"

    @classmethod
    def state_interfaces(cls, parameters: IMUSensorBroadcasterParameters) -> tuple[str, ...]:
        """Return orientation, angular velocity and linear acceleration."""
        return tuple(f"{parameters.sensor_name}/{name}" for name in _INTERFACES)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, "spatial")
        check_covariances(setup, *_COVARIANCES)
        self.declare_message_output("imu", "sensor_msgs/msg/Imu", self._imu, self._present())

    def _imu(self, context: Context) -> Any:
        spreads = [np.array(getattr(self.setup.parameters, name)) for name in _COVARIANCES]
        header = messages.header(context.get_time(), self.setup.frame(self.setup.parameters.frame_id))
        return messages.imu_message(header, self._sensor.Eval(context).tolist(), spreads)
