"""The older accessors of controllers' ports."""

import pytest

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.forward_command_controller import ForwardCommandController, ForwardCommandParameters
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout

ROBOT = RobotDescription("robot", ("base", "link"), (Joint("left", "continuous", "base", "link"),))
LAYOUT = StateLayout(0, {}, {}, {})


class Echo(ForwardCommandController):
    """Has a port without an accessor."""

    def __init__(self, setup):
        super().__init__(setup)
        self.DeclareVectorInputPort("spatial", 2)


def test_older_accessors_work_and_warn():
    parameters = ForwardCommandParameters(("left",), "velocity")
    claims = ForwardCommandController.claimed_interfaces(parameters, ROBOT)
    dut = Echo(ControllerSetup("dut", parameters, claims, ROBOT, LAYOUT))
    with pytest.deprecated_call(match=r"older name of GetInputPort\('spatial'\)"):
        assert dut.get_spatial_input_port().size() == 2
    for name in ("get_imu_output_port", "get_nothing_input_port", "nothing"):
        with pytest.raises(AttributeError, match=name):
            getattr(dut, name)
