"""A sensor of somebody else's, in one file: the height of a link, as Gazebo's altimeter measures it."""

from drake_twin import messages
from drake_twin.sensors import sensor
from drake_twin.sensors.sensor_system import SensorSystem


@sensor("height")
class Height(SensorSystem):
    """Publishes the height of a link's origin above where it started (m)."""

    message_type = "std_msgs/msg/Float64"

    def __init__(self, setup):
        super().__init__(setup)
        self._body = int(setup.body.index())
        self._start = setup.start.translation()[2]
        self._poses = self.declare_plant_input("body_poses")
        self.declare_message_output(self._calc)

    def _calc(self, context, output):
        height = self._poses.Eval(context)[self._body].translation()[2]
        output.set_value(messages.message("std_msgs/msg/Float64", {"data": float(height - self._start)}))
