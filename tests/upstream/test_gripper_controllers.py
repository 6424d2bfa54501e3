"""gripper_controllers/test/test_gripper_controllers.cpp on the grippers of a position and of an effort.

Upstream runs each of its tests with both interfaces; each line counts once and holds for both.
"""

from device_harness import ROBOT, Running, setup_of

from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError
from upstream.suite import Suite, refuses

ASSERTIONS = 8
SUITE = Suite("gripper_controllers/test/test_gripper_controllers.cpp")
KINDS = {
    "position": "position_controllers/GripperActionController",
    "effort": "effort_controllers/GripperActionController",
}


def read(interface, **given):
    kind = controller_class(KINDS[interface])
    return kind, read_parameters(kind.Parameters, ControllerParameters("gripper_controller", KINDS[interface], given))[
        0
    ]


def running(interface):
    kind, parameters = read(interface, joint="finger")
    return Running(kind(setup_of(kind, parameters)), state=[0.2, 0.0, 0.0, 0.0])


@SUITE.scenario({83: True, 95: True})
def a_joint_is_needed():
    yield 83, all(refuses(lambda each=each: read(each), InputError) for each in KINDS)
    yield 95, all(refuses(lambda each=each: read(each, joint=""), InputError) for each in KINDS)


@SUITE.scenario({113: [1, 1], 114: ["finger/position", "finger/effort"]})
def claims():
    of_both = []
    for interface in KINDS:
        kind, parameters = read(interface, joint="finger")
        of_both.append(kind.claimed_interfaces(parameters, ROBOT))
    yield 113, [len(names) for names in of_both]
    yield 114, [str(names[0]) for names in of_both]


@SUITE.scenario(dict.fromkeys((147, 161, 164, 179), True))
def activated_deactivated_and_activated():
    runs = [running(interface) for interface in KINDS]

    def write():
        return all(run.commands()[0] == run.commands()[0] for run in runs)  # not NaN

    for run in runs:
        run.advance(0.01)
    yield 147, write()
    yield 161, write()
    for run in runs:
        run.controller.deactivate(run.context)
    yield 164, not any(run.commands()[0] == run.commands()[0] for run in runs)
    for run in runs:
        run.controller.activate(run.context)
        run.advance(0.02)
    yield 179, write()


test_holds_against_upstream = SUITE.test()
