"""What the broadcasters of sensors share: the port that carries the sensor's values, and being active or not."""

from dataclasses import replace
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import AbstractStateIndex, BasicVector, Context, InputPort

from drake_twin.controllers.controller import Controller, ControllerSetup, Sample


class SensorBroadcaster(Controller):
    """A broadcaster of one sensor's values: it claims nothing, and has no events unless a subclass adds one.

    A message is computed when somebody asks for it and has the present time, so one that is asked for at the
    controller's update rate is what ros2_control publishes. While it is not active there is no message.

    Attributes:
        kind: the kind of the sensor, as `drake_twin.description.robot_description.Sensor` has it.
    """

    kind: ClassVar[str]

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """The name of the sensor in ``<ros2_control>`` whose values it needs."""
        name: str = parameters.sensor_name
        return name

    def __init__(self, setup: ControllerSetup, port: str, size: int):
        super().__init__(setup)
        self._sensor = self.DeclareVectorInputPort(port, size)
        self._sample_index: AbstractStateIndex = self.DeclareAbstractState(AbstractValue.Make(Sample()))
        self._declare_command_interfaces(self._calc_nothing, {self.nothing_ticket()})

    def get_sensor_input_port(self) -> InputPort:
        """The port that carries the sensor's values."""
        return self._sensor

    def sample(self, context: Context) -> Sample:
        """Whether it is active, and what the last update left."""
        sample: Sample = context.get_abstract_state(int(self._sample_index)).get_value()
        return sample

    def fault(self, context: Context) -> str | None:
        """What its last update raised; None when it works."""
        return self.sample(context).fault

    def activate(self, context: Context) -> None:
        """Begins anew at the present time."""
        context.SetAbstractState(int(self._sample_index), Sample(active=True, time=context.get_time()))

    def deactivate(self, context: Context) -> None:
        """Publishes nothing from now on."""
        context.SetAbstractState(int(self._sample_index), replace(self.sample(context), active=False))

    def _calc_nothing(self, context: Context, output: BasicVector) -> None:
        """There is nothing to write."""

    def _present(self) -> set[Any]:
        """What a message of the present time depends on."""
        sensor = self.input_port_ticket(self._sensor.get_index())
        return {self.time_ticket(), sensor, self.abstract_state_ticket(self._sample_index)}

    def _frame(self, frame_id: str) -> str:
        """A frame as /tf has it: a link of this robot gets the prefix that the twin puts before its links."""
        is_link = frame_id in self.setup.description.links
        return f"{self.setup.frame_prefix}{frame_id}" if is_link else frame_id
