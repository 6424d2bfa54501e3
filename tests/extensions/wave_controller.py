"""A controller of somebody else's, in one file: the joint's velocity is a wave around what a topic says."""

from dataclasses import dataclass, field
from math import pi, sin

from drake_twin import CommandError
from drake_twin.controllers import ControllerSetup, Interface, PeriodicController, Update, controller
from drake_twin.saved import saved


@dataclass(frozen=True)
class WaveParameters:
    """Parameters of the wave.

    Attributes:
        joint: the joint.
        amplitude: of the velocity (rad/s).
        frequency: Hz.
    """

    joint: str
    amplitude: float = field(default=1.0, metadata={"lower": 0.0})
    frequency: float = field(default=1.0, metadata={"above": 0.0})


@saved("others_pkg/WaveMemory")
@dataclass(frozen=True)
class WaveMemory:
    """The time at which the wave began (s)."""

    start: float


@controller("others_pkg/Wave")
class Wave(PeriodicController):
    """Writes a sine to a joint's velocity."""

    Parameters = WaveParameters

    @classmethod
    def claimed_interfaces(cls, parameters, description):
        """Return the joint's velocity."""
        return (Interface(parameters.joint, "velocity"),)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._offset = self.declare_topic_input("offset", "std_msgs/msg/Float64MultiArray")

    def read(self, topic, message, context):
        """Refuse what is not one number."""
        if len(message.data) != 1:
            raise CommandError("the offset is one number")
        return message

    def start(self, context):
        """Return the time of the activation."""
        return WaveMemory(context.get_time())

    def update(self, context, time, memory):
        """Return the wave around the offset."""
        p = self.setup.parameters
        message = self.received(self._offset, context)
        offset = 0.0 if message is None else message.data[0]
        return Update(memory, [offset + p.amplitude * sin(2 * pi * p.frequency * (time - memory.start))])
