"""A forward command controller of any type with its context, of a robot with three joints, as upstream's tests have."""

from typing import Any

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import empty_value, make_value

JOINTS = ["joint1", "joint2", "joint3"]
ROBOT = RobotDescription("robot", ("base", "link"), tuple(Joint(name, "continuous", "base", "link") for name in JOINTS))
COMMAND = (10.0, 20.0, 30.0)


class Forwarding:
    """A controller, made from parameters as in a YAML file."""

    def __init__(self, kind: str, **given: Any):
        cls = controller_class(kind)
        assert cls is not None
        values, _ = read_parameters(cls.Parameters, ControllerParameters("forward_command_controller", kind, given))
        claims = cls.claimed_interfaces(values, ROBOT)
        setup = ControllerSetup("forward_command_controller", values, claims, ROBOT, StateLayout(0, {}, {}, {}))
        self.dut = cls(setup)
        self.context = self.dut.CreateDefaultContext()
        self.clear()

    @property
    def claims(self) -> list[str]:
        return [str(claim) for claim in self.dut.claims]

    def clear(self) -> None:
        self.dut.get_commands_input_port().FixValue(self.context, empty_value())

    def send(self, *values: float) -> None:
        value = self.dut.read("commands", messages.float64_multi_array(values), self.context)
        self.dut.get_commands_input_port().FixValue(self.context, make_value(value))

    def deactivate(self) -> None:
        """Deactivate it, and clear its topic, as the twin does."""
        self.dut.deactivate(self.context)
        self.clear()

    @property
    def commands(self) -> list[float]:
        return self.dut.get_command_interfaces_output_port().Eval(self.context).tolist()


def of_three(*lines: int) -> list[int]:
    """Return the lines of three joints' assertions, from those of the first joint."""
    return [line + n for line in lines for n in range(3)]
