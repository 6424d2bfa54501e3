"""A sensor of somebody else's, in one file: the height of a link, as Gazebo's altimeter measures it."""

from pydrake.common.value import Value
from pydrake.math import RigidTransform

from drake_twin import messages
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_system import SensorSystem


@sensor("altimeter")
class Altimeter(SensorSystem):
    """Publishes the height of a link's origin above where it started (m)."""

    message_type = "std_msgs/msg/Float64"

    @classmethod
    def of(cls, plant, instance, sensor):
        """Return the altimeter of a ``<sensor type="altimeter">`` tag."""
        body = plant.GetBodyByName(drake_link_name(sensor.link), instance)
        start = plant.EvalBodyPoseInWorld(plant.CreateDefaultContext(), body).translation()[2]
        return cls(int(body.index()), float(start))

    def __init__(self, body, start):
        super().__init__()
        self._body, self._start = body, start
        self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self.declare_message_output(self._calc, {self.input_port_ticket(self._poses.get_index())})

    def inputs_from(self, plant):
        """Return the plant's poses."""
        return ((plant.get_body_poses_output_port(), self._poses),)

    def _calc(self, context, output):
        height = self._poses.Eval(context)[self._body].translation()[2]
        output.set_value(messages.message("std_msgs/msg/Float64", {"data": float(height) - self._start}))
