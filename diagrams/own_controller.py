"""Your own controller: a joint follows a sine wave, whose amplitude a topic changes.

Run it: python diagrams/own_controller.py

It can also be loaded by the programs, for a controllers YAML that names the type wave/Wave:
python -m drake_twin.run my_arm.urdf.xacro --plugin diagrams/own_controller.py
"""

from dataclasses import dataclass, field
from math import cos, pi

from drake_twin import TwinBuilder
from drake_twin.controllers import Interface, PeriodicController, Update, controller


@dataclass(frozen=True)
class WaveParameters:
    joint: str
    amplitude: float = field(default=0.5, metadata={"lower": 0.0})  # rad
    frequency: float = field(default=0.5, metadata={"lower": 0.0})  # Hz


@controller("wave/Wave")
class Wave(PeriodicController):
    """Writes the velocity of a sine wave to one joint."""

    Parameters = WaveParameters

    @classmethod
    def claimed_interfaces(cls, parameters, description):
        return (Interface(parameters.joint, "velocity"),)

    def __init__(self, setup):
        super().__init__(setup)
        self.amplitude = self.declare_topic_input("amplitude", "std_msgs/msg/Float64MultiArray")

    def update(self, context, time, memory):
        message = self.received(self.amplitude, context)  # None before the first
        amplitude = self.setup.parameters.amplitude if message is None else message.data[0]
        rate = 2 * pi * self.setup.parameters.frequency
        return Update(memory, [amplitude * rate * cos(rate * time)])


if __name__ == "__main__":
    arm = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
    twin = (
        TwinBuilder()
        .robot("arm", arm, active_controllers=["joint_state_broadcaster"])
        .controller("arm", "wave", "wave/Wave", {"joint": "joint_1", "amplitude": 0.3})
        .build()
    )
    print(*twin.control.manager("arm").list_controllers(), sep="\n")
    twin.advance_to(0.5)
    quarter = twin.joint_states("arm").position[0]
    twin.advance_to(2.0)
    twin.publish("/arm/wave/amplitude", [0.6])
    twin.advance_to(2.5)
    doubled = twin.joint_states("arm").position[0]
    print(f"joint_1 after a quarter of a period: {quarter:.3f} rad; with twice the amplitude: {doubled:.3f} rad")
    assert abs(quarter - 0.3) < 0.02
    assert abs(doubled - 0.6) < 0.03
