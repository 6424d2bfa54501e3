"""controller_manager/test/test_controllers_chaining_with_controller_manager.cpp (9ffbf97fd) on the twin's manager.

Upstream's controllers also export state interfaces, which sensor_fusion, robot_localization and odom_publisher use; the
twin has no such interfaces, and these three are left out with what is asserted of them.
"""

from made_up_controllers import Manager, controller

from drake_twin.twin.controller_manager import BEST_EFFORT, STRICT
from upstream.suite import Suite

ASSERTIONS = 128
SUITE = Suite("controller_manager/test/test_controllers_chaining_with_controller_manager.cpp")

LEFT, RIGHT = "pid_left_wheel_controller", "pid_right_wheel_controller"
DRIVE, DRIVE_TWO = "diff_drive_controller", "diff_drive_controller_two"
TRACKING, TRACKING_TWO = "position_tracking_controller", "position_tracking_controller_two"
STATES = "all_state_broadcaster"
REFERENCES = ("vel_x/velocity", "vel_y/velocity", "rot_z/velocity")
OF_WHEELS = (f"{LEFT}/a/velocity", f"{RIGHT}/b/velocity")
CONTROLLERS = {
    LEFT: (("a/effort",), ("a/velocity",)),
    RIGHT: (("b/effort",), ("b/velocity",)),
    DRIVE: (OF_WHEELS, REFERENCES),
    DRIVE_TWO: (OF_WHEELS, REFERENCES),
    TRACKING: ((f"{DRIVE}/vel_x/velocity", f"{DRIVE}/vel_y/velocity"), ()),
    TRACKING_TWO: ((f"{DRIVE}/vel_x/velocity", f"{DRIVE}/vel_y/velocity"), ()),
    STATES: ((), ()),
}
STRICTNESSES = (STRICT, BEST_EFFORT)


def manager(state="inactive"):
    return Manager(
        *(
            controller(name, *claims, references=references, state=state)
            for name, (claims, references) in CONTROLLERS.items()
        )
    )


def claimed(of):
    """Interface → whether it is claimed."""
    return {item.name: item.is_claimed for item in of.list_hardware_interfaces()[0]}


def available(of):
    """Interface → whether it is available."""
    return {item.name: item.is_available for item in of.list_hardware_interfaces()[0]}


def seen(of, name, what):
    if isinstance(what, bool):
        return next(item.is_chained for item in of.list_controllers() if item.name == name)
    return of.states[name]


def both(value):
    """What holds with either strictness; a pair is of strict, and of best effort."""
    return list(value) if isinstance(value, tuple) else [value, value]


def add(name, *steps):
    """Add a scenario of steps: what to activate, what to deactivate, then line → controller and what holds of it.

    What holds is a state, or whether the controller is in chained mode.
    """
    expected = {line: both(value) for *_, lines in steps for line, (_, value) in lines.items()}

    def play():
        managers = [manager(), manager()]
        for activate, deactivate, lines in steps:
            if activate or deactivate:
                for each, strictness in zip(managers, STRICTNESSES, strict=True):
                    each.switch_controller(activate, deactivate, strictness)
            for line, (of, value) in lines.items():
                yield line, [seen(each, of, what) for each, what in zip(managers, both(value), strict=True)]

    play.__name__ = name
    SUITE.scenario(expected)(play)


def chained(lines, *values):
    """The chained modes of left, right and drive."""
    return {line: (name, value) for line, name, value in zip(lines, (LEFT, RIGHT, DRIVE), values, strict=True)}


ON, OFF = "active", "inactive"

add(
    "chained_mode_follows_the_writers",
    ([], [], chained((967, 968, 969), False, False, False)),
    ([LEFT], [], {}),
    ([RIGHT], [], chained((976, 977, 978), False, False, False)),
    ([DRIVE], [], chained((984, 985, 986), True, True, False)),
    ([TRACKING], [], chained((993, 994, 995), True, True, True)),
    ([], [TRACKING], chained((1039, 1040, 1041), True, True, False) | {1042: (DRIVE, ON)}),
    ([], [DRIVE], chained((1119, 1120, 1121), False, False, False) | {1123: (DRIVE, OFF)}),
    ([], [LEFT], {}),
    ([], [RIGHT], chained((1138, 1139, 1140), False, False, False) | {1142: (DRIVE, OFF)}),
)
add(
    "a_writer_is_not_activated_without_what_it_writes_to",
    ([], [], chained((1202, 1203, 1204), False, False, False)),
    ([DRIVE], [], {1224: (DRIVE, OFF), 1235: (DRIVE, OFF)}),
    ([LEFT], [], {}),
    ([RIGHT], [], {}),
    ([DRIVE], [RIGHT], {1265: (LEFT, ON), 1268: (DRIVE, OFF)}),
)
add(
    "writers_of_the_same_references_replace_each_other",
    ([LEFT], [], {}),
    ([RIGHT], [], {}),
    ([DRIVE], [], {}),
    (
        [TRACKING],
        [],
        {1344: (DRIVE_TWO, OFF), 1356: (TRACKING, ON), 1359: (TRACKING_TWO, OFF), 1362: (STATES, OFF)},
    ),
    ([TRACKING_TWO, STATES], [TRACKING], {1370: (TRACKING, OFF), 1373: (TRACKING_TWO, ON), 1376: (STATES, ON)}),
    ([], [TRACKING_TWO, STATES], {1384: (TRACKING_TWO, OFF)}),
    ([TRACKING_TWO], [], {1392: (TRACKING, OFF), 1395: (TRACKING_TWO, ON)}),
    (
        [DRIVE_TWO],
        [TRACKING_TWO, DRIVE],
        {
            1408: (LEFT, ON),
            1411: (RIGHT, ON),
            1416: (DRIVE, OFF),
            1419: (DRIVE_TWO, ON),
            1431: (TRACKING, OFF),
            1434: (TRACKING_TWO, OFF),
        },
    ),
    (
        [TRACKING_TWO, DRIVE, STATES],
        [DRIVE_TWO],
        {
            1464: (LEFT, ON),
            1467: (LEFT, True),
            1468: (RIGHT, ON),
            1471: (LEFT, True),
            1472: (DRIVE, ON),
            1475: (DRIVE, True),
            1476: (DRIVE_TWO, OFF),
            1482: (STATES, ON),
            1493: (TRACKING, OFF),
            1496: (TRACKING_TWO, ON),
        },
    ),
)
add(
    "what_is_written_to_is_not_deactivated_alone",
    ([], [], chained((1547, 1548, 1549), False, False, False)),
    ([LEFT], [], {}),
    ([RIGHT], [], {1571: (DRIVE, OFF)}),
    ([], [DRIVE], {1600: (LEFT, ON), 1603: (RIGHT, ON), 1606: (DRIVE, OFF)}),
    ([DRIVE], [LEFT, RIGHT], {1631: (RIGHT, (ON, OFF)), 1634: (LEFT, (ON, OFF)), 1637: (DRIVE, OFF)}),
    ([LEFT], [], {}),
    ([RIGHT], [], {}),
    ([DRIVE], [], {1655: (LEFT, ON), 1658: (RIGHT, ON), 1661: (DRIVE, ON)}),
    ([], [LEFT, RIGHT], {1671: (LEFT, ON), 1674: (RIGHT, ON), 1677: (DRIVE, ON)}),
    ([], [RIGHT], {1687: (LEFT, ON), 1690: (DRIVE, ON)}),
)
add(
    "a_chain_that_is_deactivated_from_its_end",
    ([], [], chained((1741, 1742, 1743), False, False, False)),
    ([LEFT], [], {}),
    ([RIGHT], [], {}),
    ([DRIVE], [], {}),
    (
        [TRACKING],
        [],
        chained((1761, 1762, 1763), True, True, True)
        | {1767: (LEFT, ON), 1770: (RIGHT, ON), 1773: (DRIVE, ON), 1785: (TRACKING, ON)},
    ),
    ([], [TRACKING], chained((1809, 1810, 1811), True, True, False) | {1813: (DRIVE, ON)}),
)

CONFIGURED = (  # line of the state, that of the number of interfaces, controller, their number more than before
    (285, 288, LEFT, 1),
    (298, 301, RIGHT, 2),
    (315, 318, DRIVE, 5),
    (335, 338, DRIVE_TWO, 8),
    (355, 358, TRACKING, 8),
    (383, 386, TRACKING_TWO, 8),
    (390, 393, STATES, 8),
)
EXPORTED = (  # lines of whether they exist, are available, and are claimed; controller
    (292, 293, 294, LEFT),
    (305, 306, 307, RIGHT),
    (324, 325, 326, DRIVE),
    (344, 345, 346, DRIVE_TWO),
)


@SUITE.scenario(
    {state: OFF for state, *_ in CONFIGURED}
    | {size: number for _, size, _, number in CONFIGURED}
    | {exists: True for exists, *_ in EXPORTED}
    | {line: False for _, *lines, _ in EXPORTED for line in lines}
)
def references_come_with_the_configuration():
    of = manager("unloaded")
    before = len(claimed(of))
    for state, size, name, _ in CONFIGURED:
        assert of.load_controller(name)
        assert of.configure_controller(name)
        yield state, of.states[name]
        interfaces = claimed(of)
        yield size, len(interfaces) - before
        for exists, is_available, is_claimed, exporter in EXPORTED:
            if exporter == name:
                names = [f"{name}/{reference}" for reference in CONTROLLERS[name][1]]
                yield exists, all(each in interfaces for each in names)
                yield is_available, any(available(of)[each] for each in names)
                yield is_claimed, any(interfaces[each] for each in names)


@SUITE.scenario(
    {446: True, 452: True, 459: True, 467: False}
    | {803: True, 804: True, 805: False, 999: True, 1000: True, 1001: True, 2059: True, 2060: True, 2061: False}
)
def claims_of_a_chain():
    of = manager()
    exist, hold = [], []
    for name in (LEFT, RIGHT, DRIVE, TRACKING):
        of.switch_controller([name], strictness=STRICT)
        interfaces = claimed(of)
        exist += [each in interfaces for each in CONTROLLERS[name][0]]
        hold += [interfaces[each] for each in CONTROLLERS[name][0]]
    yield 446, all(exist)
    yield 452, all(hold)
    for line in (803, 2059):
        yield line, f"{DRIVE}/rot_z/velocity" in interfaces
        yield line + 1, available(of)[f"{DRIVE}/rot_z/velocity"]
        yield line + 2, interfaces[f"{DRIVE}/rot_z/velocity"]
    yield 999, all(f"{DRIVE}/{each}/velocity" in interfaces for each in ("vel_x", "vel_y"))
    yield 1000, all(available(of)[f"{DRIVE}/{each}/velocity"] for each in ("vel_x", "vel_y"))
    yield 1001, all(interfaces[f"{DRIVE}/{each}/velocity"] for each in ("vel_x", "vel_y"))
    left, free = [], []
    for name in (TRACKING, DRIVE, RIGHT, LEFT):
        of.switch_controller(deactivate=[name], strictness=STRICT)
        left += [claimed(of)[each] for each in CONTROLLERS[name][0]]
        free += [available(of)[each] for each in CONTROLLERS[name][0]]
    yield 459, all(free)
    yield 467, any(left)


test_holds_against_upstream = SUITE.test()
