"""forward_command_controller/test/test_forward_command_controller.cpp on the twin's controller."""

import numpy as np
from pydrake.common.value import AbstractValue

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.forward_command_controller import ForwardCommandController
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.errors import InputError
from drake_twin.systems.state_layout import StateLayout
from upstream.suite import Suite, refuses

ASSERTIONS = 20
SUITE = Suite("forward_command_controller/test/test_forward_command_controller.cpp")

ROBOT = RobotDescription("robot", ("base", "link"), (Joint("joint1", "continuous", "base", "link"),))
JOINTS = ["joint1", "joint2", "joint3"]


class Forwarding:
    """A controller and its context."""

    def __init__(self, **given):
        kind = "forward_command_controller/ForwardCommandController"
        given = {"joints": JOINTS, "interface_name": "position"} | given
        parameters = ControllerParameters("forward_command_controller", kind, given)
        values, _ = read_parameters(ForwardCommandController.Parameters, parameters)
        self.claims = ForwardCommandController.claimed_interfaces(values, ROBOT)
        setup = ControllerSetup("forward_command_controller", values, self.claims, ROBOT, StateLayout(0, {}, {}, {}))
        self.dut = ForwardCommandController(setup)
        self.context = self.dut.CreateDefaultContext()
        self.clear()

    def clear(self):
        self.dut.get_commands_input_port().FixValue(self.context, AbstractValue.Make(None))

    def send(self, *values):
        value = self.dut.read("commands", messages.float64_multi_array(values), self.context)
        self.dut.get_commands_input_port().FixValue(self.context, AbstractValue.Make(value))

    @property
    def commands(self):
        return self.dut.get_command_interfaces_output_port().Eval(self.context).tolist()


@SUITE.table(
    (
        (85, {"joints": [], "interface_name": ""}, True),
        (96, {"joints": [], "interface_name": "position"}, True),
        (109, {"joints": [], "interface_name": ""}, True),
        (121, {"joints": ["joint1", "joint2"], "interface_name": ""}, True),
    )
)
def parameters_that_are_refused(given):
    return refuses(lambda: Forwarding(**given), InputError)


@SUITE.scenario({138: 2, 188: 3, 197: 3})
def claims():
    yield 138, len(Forwarding(joints=["joint1", "joint2"]).claims)
    yield 188, len(Forwarding().claims)
    yield 197, len(Forwarding().dut.claims)


def of_three(*lines):
    return [line + n for line in lines for n in range(3)]


@SUITE.scenario(
    dict(zip(of_three(234, 323, 415), [10.0, 20.0, 30.0] * 3, strict=True))
    | dict(zip(of_three(474), [5.5, 6.6, 7.7], strict=True))
    | {431: True}
)
def commands_are_forwarded():
    forwarding = Forwarding()
    forwarding.send(10.0, 20.0, 30.0)
    yield from zip(of_three(234, 323, 415), forwarding.commands * 3, strict=True)
    forwarding.dut.deactivate(forwarding.context)
    forwarding.clear()
    yield 431, bool(np.isnan(forwarding.commands).all())
    forwarding.dut.activate(forwarding.context)
    forwarding.send(5.5, 6.6, 7.7)
    yield from zip(of_three(474), forwarding.commands, strict=True)


test_holds_against_upstream = SUITE.test()
