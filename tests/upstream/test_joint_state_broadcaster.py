"""joint_state_broadcaster/test/test_joint_state_broadcaster.cpp on the twin's broadcaster.

Upstream's joints report position, velocity and effort, each of the value 1.1, 2.1 or 3.1.
"""

import numpy as np

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.joint_state_broadcaster import (
    JointStateBroadcaster,
    JointStateBroadcasterParameters,
    JointStateInterfaceMap,
)
from drake_twin.description.robot_description import (
    ControlledJoint,
    HardwareSystem,
    Joint,
    RobotDescription,
    StateInterface,
)
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import or_none
from upstream.suite import Suite

ASSERTIONS = 203
SUITE = Suite("joint_state_broadcaster/test/test_joint_state_broadcaster.cpp")

JOINTS = ["joint1", "joint2", "joint3"]
ALL = ["position", "velocity", "effort"]
VALUES = [1.1, 2.1, 3.1]
CUSTOM = "measured_position"
NAN = float("nan")


class Broadcast:
    """The messages of a broadcaster, with the names of upstream's assertions."""

    def __init__(self, of_robot=None, movable=None, **parameters):
        of_robot = dict.fromkeys(JOINTS, ALL) if of_robot is None else of_robot
        numbers = {joint: n for n, joint in enumerate(JOINTS)}
        layout = StateLayout(
            size=6,
            positions=numbers,
            velocities={joint: 3 + n for joint, n in numbers.items()},
            efforts=numbers,
            num_actuators=3,
        )
        joints = tuple(
            ControlledJoint(joint, state_interfaces=tuple(map(StateInterface, names)))
            for joint, names in of_robot.items()
        )
        description = RobotDescription(
            "robot",
            ("base_link", "link"),
            tuple(Joint(name, "continuous", "base_link", "link") for name in movable or JOINTS),
            systems=(HardwareSystem("system", "system", "plugin", joints),),
        )
        self.parameters = JointStateBroadcasterParameters(**parameters)
        dut = JointStateBroadcaster(
            ControllerSetup("joint_state_broadcaster", self.parameters, (), description, layout)
        )
        context = dut.CreateDefaultContext()
        dut.get_state_input_port().FixValue(context, VALUES * 2)
        dut.get_net_actuation_input_port().FixValue(context, VALUES)
        self.claims = list(dut.claims)
        self.joint_states = or_none(dut.get_joint_states_output_port().Eval(context))
        self.dynamic = or_none(dut.get_dynamic_joint_states_output_port().Eval(context))

    def __getitem__(self, what):
        """The value of one of the names below, or ``interfaces 0`` of the dynamic message."""
        message, dynamic = self.joint_states, self.dynamic
        if what.startswith("interfaces"):
            return list(dynamic.interface_values[int(what.split()[1])].interface_names)
        return {
            "claims": lambda: self.claims,
            "published": lambda: message is not None,
            "dynamic published": lambda: dynamic is not None,
            "frame": lambda: message.header.frame_id,
            "name": lambda: list(message.name),
            "positions": lambda: message.position.size,
            "velocities": lambda: message.velocity.size,
            "efforts": lambda: message.effort.size,
            "position": lambda: message.position.tolist(),
            "velocity": lambda: message.velocity.tolist(),
            "effort": lambda: message.effort.tolist(),
            "velocity is the position": lambda: message.velocity.tolist() == message.position.tolist(),
            "effort is the position": lambda: message.effort.tolist() == message.position.tolist(),
            "dynamic frame": lambda: dynamic.header.frame_id,
            "dynamic size": lambda: len(dynamic.joint_names),
            "dynamic values": lambda: len(dynamic.interface_values),
            "dynamic names": lambda: list(dynamic.joint_names),
            "values": lambda: [item.values.tolist() for item in dynamic.interface_values],
        }[what]()


def add(name, expected, **robot_and_parameters):
    """Add a scenario: line → (what of `Broadcast`, upstream's value)."""

    def play():
        broadcast = Broadcast(**robot_and_parameters)
        for line, (what, _) in expected.items():
            yield line, broadcast[what]

    play.__name__ = name
    SUITE.scenario({line: value for line, (_, value) in expected.items()})(play)


def lines(whats, *numbers):
    return dict(zip(numbers, whats, strict=True))


def joint_states(joints, *, frame=True):
    """What upstream asserts of most messages."""
    size = len(joints)
    sizes = [("positions", size), ("velocities", size), ("efforts", size)]
    return [*([("frame", "base_link")] if frame else []), ("name", joints), *sizes]


def dynamic(joints, *interfaces, frame=True):
    size = len(joints)
    start = [("dynamic frame", "base_link")] if frame else []
    whats = [("dynamic size", size), ("dynamic values", size), ("dynamic names", joints)]
    return [*start, *whats, *((f"interfaces {n}", names) for n, names in enumerate(interfaces))]


CLAIMS = [("claims", [])]
PUBLISHED = [("published", True), ("dynamic published", True)]
EVERYTHING = [*CLAIMS, *PUBLISHED, *joint_states(JOINTS), *dynamic(JOINTS, ALL, ALL, ALL)]
ONE, TWO, POSITION = JOINTS[:1], JOINTS[:2], ["position"]

add(
    "without_parameters",
    lines(EVERYTHING, 210, 217, 218, *range(222, 227), 230, 231, 232, 233, 234, 237, 240),
)
add(
    "without_dynamic_joint_states",
    lines(
        [*CLAIMS, ("published", True), ("dynamic published", False), *joint_states(JOINTS)],
        *(262, 269, 271, *range(275, 280)),
    ),
    publish_dynamic_joint_states=False,
)
add(
    "without_joints",
    lines(EVERYTHING, 395, 402, 403, *range(407, 412), 415, 416, 417, 418, 419, 422, 425),
    interfaces=("position",),
)
# Upstream's hardware has a third joint that the description lacks.
OF_DESCRIPTION = [
    *CLAIMS,
    *PUBLISHED,
    *joint_states(TWO, frame=False),
    *dynamic(JOINTS, ALL, ALL, frame=False),
]
add(
    "joints_of_the_description",
    lines(OF_DESCRIPTION, 500, 507, 508, 512, 513, 514, 515, 519, 520, 521, 522, 525),
    movable=TWO,
    interfaces=("position",),
)
add(
    "joints_of_the_description_without_interfaces",
    lines(OF_DESCRIPTION, 553, 560, 561, 565, 566, 567, 568, 572, 573, 574, 575, 578),
    movable=TWO,
    joints=("joint1",),
)
add(
    "joints_and_interfaces",
    lines(
        [*CLAIMS, *PUBLISHED, *joint_states(ONE, frame=False), *dynamic(ONE, ALL, frame=False)],
        *(605, 612, 613, 617, 618, 619, 620, 624, 625, 626, 627),
    ),
    joints=("joint1",),
    interfaces=tuple(ALL),
)
add(
    "without_interfaces",
    lines(EVERYTHING, 647, 654, 655, *range(659, 664), 667, 668, 669, 670, 671, 674, 677),
    joints=("joint1",),
)
add(
    "two_joints_with_one_interface",
    lines(
        [
            *(*CLAIMS, *PUBLISHED, *joint_states(TWO)),
            *(("velocity", [NAN] * 2), ("effort", [NAN] * 2)),
            *dynamic(TWO, POSITION, POSITION),
        ],
        *(697, 704, 705, 709, 710, 711, 712, 717, 715, 720, 725, 726, 727, 728, 729, 731),
    ),
    joints=tuple(TWO),
    interfaces=("position",),
)
add(
    "one_joint_with_two_interfaces",
    lines(
        [*CLAIMS, *PUBLISHED, *joint_states(ONE), ("effort", [NAN]), *dynamic(ONE, ALL[:2])],
        *(763, 770, 771, *range(775, 780), 782, 787, 788, 789, 790, 791),
    ),
    joints=("joint1",),
    interfaces=("position", "velocity"),
)
add(
    "one_interface_is_missing",
    lines(
        [
            *(*CLAIMS, *PUBLISHED, *joint_states(TWO)),
            *(("velocity", [NAN, 2.1]), ("effort", [NAN, NAN])),
            *dynamic(TWO, POSITION, ALL[:2]),
        ],
        *(855, 862, 863, *range(867, 872), 873, 876, 881, 882, 883, 884, 885, 888),
    ),
    of_robot={"joint1": POSITION, "joint2": ALL[:2]},
    joints=tuple(TWO),
    interfaces=("position", "velocity"),
)
add(
    "an_interface_of_another_name",
    lines(
        [*CLAIMS, *joint_states([]), *dynamic(ONE, [CUSTOM]), *PUBLISHED],
        *(907, *range(915, 920), 923, 924, 925, 926, 927, 931, 932),
    ),
    of_robot={"joint1": [CUSTOM]},
    joints=("joint1",),
    interfaces=(CUSTOM,),
)
MAPPED = {
    "of_robot": {"joint1": [CUSTOM]},
    "joints": ("joint1",),
    "interfaces": (CUSTOM,),
    "map_interface_to_joint_state": JointStateInterfaceMap(position=CUSTOM),
}
NO_VELOCITY_OR_EFFORT = [("velocity", [NAN]), ("effort", [NAN])]
add(
    "a_mapped_interface",
    lines(
        [*CLAIMS, *joint_states(ONE), *NO_VELOCITY_OR_EFFORT, *dynamic(ONE, POSITION), *PUBLISHED],
        *(953, 961, 962, 963, 964, 969, 967, 972, 977, 978, 979, 980, 981, 986, 987),
    ),
    **MAPPED,
)
add(
    "a_mapping_of_an_interface_that_is_asked_for_is_ignored",
    lines(
        [*CLAIMS, *joint_states(ONE), ("position", [NAN]), ("effort", [NAN]), ("published", True)],
        *(1015, 1023, 1024, 1025, 1027, 1029, 1026, 1030, 1033),
    ),
    joints=("joint1",),
    interfaces=("velocity",),
    map_interface_to_joint_state=JointStateInterfaceMap(velocity="derived_velocity"),
)
add(
    "the_value_of_a_mapped_interface",
    lines(
        [
            *joint_states(ONE),
            *(("position", [3.5]), *NO_VELOCITY_OR_EFFORT),
            *(*dynamic(ONE, POSITION), *PUBLISHED),
        ],
        *(1051, 1052, 1053, 1055, 1060, 1054, 1058, 1063, 1068, 1069, 1070, 1071, 1072, 1077, 1078),
    ),
    **MAPPED,
)
add(
    "published_values",
    lines(
        [
            *(("frame", "base_link"), ("positions", 3), ("position", VALUES)),
            *(("velocity is the position", True), ("effort is the position", True)),
            *(("dynamic frame", "base_link"), ("dynamic size", 3)),
            *(("interfaces 0", ALL), ("values", [[value] * 3 for value in VALUES])),
        ],
        *(1294, 1295, 1300, 1301, 1302, 1364, 1365, 1372, 1379),
    ),
)
add(
    "extra_joints",
    lines(
        [*joint_states([*JOINTS, "extra1", "extra2", "extra3"]), ("dynamic frame", "base_link"), ("dynamic size", 6)],
        *(*range(1420, 1425), 1428, 1429),
    ),
    extra_joints=("extra1", "extra2", "extra3"),
)


@SUITE.scenario({817: False})
def no_interface_is_there():
    """Whether it publishes although none of the interfaces that are asked for exists."""
    broadcast = Broadcast(of_robot={"joint3": ALL}, joints=tuple(TWO), interfaces=("position", "velocity"))
    assert np.isnan(broadcast.joint_states.position).all()
    yield 817, broadcast.joint_states is not None


test_holds_against_upstream = SUITE.test()
