from math import cos, sin, sqrt

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.roller_wheels_controller import RollerWheelsController, RollerWheelsParameters
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import Pose, RobotDescription
from drake_twin.kinematics.planar_base import PlanarBase
from drake_twin.kinematics.state_layout import StateLayout

WHEELS = ("left", "right", "back")
# Slides along x, y, z and a turn, then the wheels; their positions and then their velocities.
PLACES = {"base.angular.z": 3, "left": 4, "right": 5, "back": 6}
LAYOUT = StateLayout(
    14,
    PLACES,
    {name: 7 + place for name, place in PLACES.items()},
    {},
    planar_base=PlanarBase(Pose(), (0, 1, 2, 3), (7, 8, 9, 10)),
)
ROBOT = RobotDescription("robot", ("base_footprint",), ())
HALF = sqrt(0.5)
# Two wheels ahead with their friction across each other, and one behind that holds sideways.
PARAMETERS = RollerWheelsParameters(
    wheels=WHEELS,
    center_x=(0.2, 0.2, -0.3),
    center_y=(0.1, -0.1, 0.0),
    direction_x=(HALF, HALF, 0.0),
    direction_y=(-HALF, HALF, 1.0),
    rim=(0.05, 0.05, -0.04),
)


def written(speeds, heading=0.0, parameters=PARAMETERS):
    claims = RollerWheelsController.claimed_interfaces(None, ROBOT)
    dut = RollerWheelsController(ControllerSetup("rollers", parameters, claims, ROBOT, LAYOUT))
    builder = DiagramBuilder()
    builder.AddSystem(dut)
    simulator = Simulator(builder.Build())
    context = dut.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    dut.get_state_input_port().FixValue(context, [0, 0, 0, heading, 0, 0, 0, 0, 0, 0, 0, *speeds])
    dut.activate(context)
    simulator.AdvanceTo(0.005)
    assert dut.fault(context) is None
    return dut.setup.update_period, dut.get_command_interfaces_output_port().Eval(context)


@pytest.mark.parametrize("seed", range(5))
def test_no_wheel_slips_along_its_direction(seed):
    rng = np.random.default_rng(seed)
    speeds, heading = rng.uniform(-5, 5, 3), rng.uniform(-3, 3)
    period, (along_x, along_y, turn) = written(speeds, heading)
    middle = heading + 0.5 * period * turn
    forwards, left = (
        cos(middle) * along_x + sin(middle) * along_y,
        cos(middle) * along_y - sin(middle) * along_x,
    )
    for index, speed in enumerate(speeds):
        x, y = PARAMETERS.center_x[index], PARAMETERS.center_y[index]
        moved = PARAMETERS.direction_x[index] * (forwards - turn * y)
        moved += PARAMETERS.direction_y[index] * (left + turn * x)
        assert moved == pytest.approx(PARAMETERS.rim[index] * speed, abs=1e-12)


def test_standing_wheels_hold_the_base():
    _, velocities = written([0.0, 0.0, 0.0], heading=0.7)
    assert velocities.tolist() == [0.0, 0.0, 0.0]


def test_every_wheel_needs_each_value():
    with pytest.raises(ParameterError, match="center_y has 2 elements; 3 wheels need one each"):
        RollerWheelsParameters(
            wheels=WHEELS,
            center_x=(0, 0, 0),
            center_y=(0, 0),
            direction_x=(1, 1, 1),
            direction_y=(0, 0, 0),
            rim=(1, 1, 1),
        )
