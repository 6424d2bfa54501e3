"""parallel_gripper_controller/test/test_parallel_gripper_controller.cpp on the twin's controller."""

from math import isnan

from device_harness import ROBOT, Running, setup_of

from drake_twin.controllers.parallel_gripper_action_controller import ParallelGripperActionController as Controller
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError
from upstream.suite import Suite, refuses

ASSERTIONS = 12
SUITE = Suite("parallel_gripper_controller/test/test_parallel_gripper_controller.cpp")

EFFORT = {"max_effort_interface": "finger/effort"}
VELOCITY = {"max_velocity_interface": "finger/velocity"}


def read(**given):
    kind = "parallel_gripper_action_controller/GripperActionController"
    return read_parameters(Controller.Parameters, ControllerParameters("gripper", kind, given))[0]


def claims(**given):
    return [str(claim) for claim in Controller.claimed_interfaces(read(joint="finger", **given), ROBOT)]


@SUITE.scenario({113: 1, 114: ["finger/position"], 172: True, 193: True, 215: True, 216: True})
def claims_of_position_and_limits():
    yield 113, len(claims())
    yield 114, claims()
    yield 172, "finger/effort" in claims(**EFFORT)
    yield 193, "finger/velocity" in claims(**VELOCITY)
    yield 215, "finger/effort" in claims(**EFFORT, **VELOCITY)
    yield 216, "finger/velocity" in claims(**EFFORT, **VELOCITY)


@SUITE.scenario({76: True})
def a_joint_is_needed():
    yield 76, refuses(read, InputError) and refuses(lambda: read(joint=""), InputError)


@SUITE.scenario({141: True, 142: True, 153: True, 218: True, 237: True})
def activated_deactivated_and_activated():
    for lines, given in (((141, 142, 153), {}), ((218, 237), EFFORT | VELOCITY)):
        run = Running(Controller(setup_of(Controller, read(joint="finger", **given))), state=[0.2, 0.0, 0.0, 0.0])
        run.advance(0.01)
        yield lines[0], not isnan(run.commands()[0])
        run.controller.deactivate(run.context)
        yield lines[1], isnan(run.commands()[0])
        if len(lines) > 2:
            run.controller.activate(run.context)
            run.advance(0.02)
            yield lines[2], not isnan(run.commands()[0])


test_holds_against_upstream = SUITE.test()
