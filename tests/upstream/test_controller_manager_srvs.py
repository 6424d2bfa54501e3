"""controller_manager/test/test_controller_manager_srvs.cpp (9ffbf97fd) on the twin's manager.

Upstream's joint1/position and joint2/velocity are the interfaces a/effort and b/effort of the made-up robot.
"""

from made_up_controllers import Manager, controller

from drake_twin.twin.controller_manager import BEST_EFFORT, STRICT
from upstream.suite import Suite

ASSERTIONS = 98
SUITE = Suite("controller_manager/test/test_controller_manager_srvs.cpp")

NAME, CHAINED = "test_controller_name", "test_chainable_controller_name"
CLAIMS = ("a/effort", "b/effort")
UNKNOWN = "unknown_controller"


def manager():
    return Manager(controller(NAME, *CLAIMS))


def listed(of, number=0):
    return of.list_controllers()[number]


@SUITE.scenario(
    {74: 0, 90: 1, 91: NAME, 92: "a/Type", 93: "unconfigured", 95: 100.0, 96: (), 97: ()}
    | {102: 1, 103: "inactive", 105: 100.0, 106: (), 107: CLAIMS}
    | {119: 1, 121: 100.0, 122: "active", 123: CLAIMS, 126: CLAIMS}
    | {138: 1, 140: 100.0, 141: "inactive", 142: (), 143: CLAIMS}
    | {227: True, 231: 0}
)
def one_controller_is_listed():
    of = manager()
    yield 74, len(of.list_controllers())
    of.load_controller(NAME)
    item = listed(of)
    yield 90, len(of.list_controllers())
    yield from zip((91, 92, 93, 95), (item.name, item.type, item.state, item.update_rate), strict=True)
    yield from zip((96, 97), (item.claimed_interfaces, item.required_command_interfaces), strict=True)
    of.configure_controller(NAME)
    item = listed(of)
    yield 102, len(of.list_controllers())
    yield from zip((103, 105), (item.state, item.update_rate), strict=True)
    yield from zip((106, 107), (item.claimed_interfaces, item.required_command_interfaces), strict=True)
    for lines, switch in (((119, 121, 122, 123, 126), ([NAME], [])), ((138, 140, 141, 142, 143), ([], [NAME]))):
        of.switch_controller(*switch, STRICT)
        item = listed(of)
        seen = (len(of.list_controllers()), item.update_rate, item.state)
        yield from zip(lines, (*seen, item.claimed_interfaces, item.required_command_interfaces), strict=True)
    yield 227, bool(of.unload_controller(NAME))
    yield 231, len(of.list_controllers())


@SUITE.scenario(
    {275: CHAINED, 277: "unconfigured", 278: 0, 279: 0, 282: False, 283: 0}
    | {286: NAME, 288: "unconfigured", 289: 0, 290: 0, 293: False, 294: 0}
    | {304: "inactive", 305: 0, 306: 3, 309: False, 310: 0}
    | {314: "inactive", 315: 0, 316: 1, 319: False, 320: 2, 322: "a/position", 323: "a/velocity"}
    | {334: "active", 335: 3, 337: "active", 338: 1, 339: True}
)
def a_chain_is_listed():
    of = Manager(
        controller(CHAINED, "a/effort", references=("a/position", "a/velocity")),
        controller(NAME, f"{CHAINED}/a/position", f"{CHAINED}/a/velocity", "b/effort"),
    )
    for name in (CHAINED, NAME):
        of.load_controller(name)

    def seen(number):
        item = listed(of, number)
        interfaces = (item.claimed_interfaces, item.required_command_interfaces, item.reference_interfaces)
        claimed, required, references = map(len, interfaces)
        return item.name, item.state, claimed, required, item.is_chained, references

    yield from zip((275, 277, 278, 279, 282, 283), seen(0), strict=True)
    yield from zip((286, 288, 289, 290, 293, 294), seen(1), strict=True)
    for name in (CHAINED, NAME):
        of.configure_controller(name)
    yield from zip((304, 305, 306, 309, 310), seen(1)[1:], strict=True)
    yield from zip((314, 315, 316, 319, 320), seen(0)[1:], strict=True)
    yield from zip((322, 323), listed(of, 0).reference_interfaces, strict=True)
    of.switch_controller([CHAINED], strictness=STRICT)
    of.switch_controller([NAME], strictness=STRICT)
    yield from zip((334, 335), seen(1)[1:3], strict=True)
    _, state, claimed, _, is_chained, _ = seen(0)
    yield from zip((337, 338, 339), (state, claimed, is_chained), strict=True)


@SUITE.scenario({465: False, 471: True, 472: 1, 473: "unconfigured", 561: False, 567: 1, 570: True, 574: 0})
def loaded_and_unloaded():
    yield 465, bool(Manager().load_controller(NAME))
    of = manager()
    yield 561, bool(of.unload_controller(NAME))
    yield 471, bool(of.load_controller(NAME))
    yield 472, len(of.list_controllers())
    yield 473, of.states[NAME]
    yield 567, len(of.list_controllers())
    yield 570, bool(of.unload_controller(NAME))
    yield 574, len(of.list_controllers())


@SUITE.scenario(
    {636: False, 642: 1, 645: True, 646: 1, 647: "inactive", 656: True, 657: 1, 658: "inactive"}
    | {668: False, 689: 2, 692: True, 693: 2, 697: "inactive", 706: True, 707: 2, 711: "inactive"}
)
def configured_once_and_again():
    of = Manager(controller(NAME, "a/effort"), controller(CHAINED, "b/effort", references=("b/position",)))
    for name, refused, loaded, rest in (
        (NAME, 636, 642, ((645, 646, 647), (656, 657, 658))),
        (CHAINED, 668, 689, ((692, 693, 697), (706, 707, 711))),
    ):
        yield refused, bool(of.configure_controller(name))
        of.load_controller(name)
        yield loaded, len(of.list_controllers())
        for ok, size, state in rest:
            yield ok, bool(of.configure_controller(name))
            yield size, len(of.list_controllers())
            yield state, of.states[name]


@SUITE.scenario({2026: 3, 2042: 3, 2053: True, 2057: True, 2061: True, 2128: 3, 2144: 3, 2156: True})
def chains_one_by_one_and_at_once():
    first, second = "test_chainable_controller_name_1", "test_chainable_controller_name_2"
    chain = (
        controller(first, "a/effort", references=("a/position", "a/velocity")),
        controller(NAME, f"{second}/a/position", f"{second}/a/velocity", "b/effort"),
        controller(second, f"{first}/a/position", references=("a/position", "a/velocity")),
    )
    for lines, switches in (
        ((2026, 2042, 2053, 2057, 2061), ([first], [second], [NAME])),
        ((2128, 2144, 2156), ([first, second, NAME],)),
    ):
        of = Manager(*chain)
        for item in chain:
            of.load_controller(item.name)
        yield lines[0], len(of.list_controllers())
        for item in chain:
            of.configure_controller(item.name)
        yield lines[1], len(of.list_controllers())
        for line, names in zip(lines[2:], switches, strict=True):
            yield line, bool(of.switch_controller(names, strictness=STRICT))


# Rows of the line, what to activate and to deactivate, the strictness, and whether it succeeds.
SWITCHES = (
    (2214, [UNKNOWN], [], (BEST_EFFORT, STRICT), False),
    (2217, [], [UNKNOWN], (BEST_EFFORT, STRICT), False),
    (2224, [NAME, UNKNOWN], [], (STRICT,), False),
    (2230, [], [NAME, UNKNOWN], (STRICT,), False),
    (2238, [NAME, UNKNOWN], [], (BEST_EFFORT,), True),
    (2244, [], [NAME, UNKNOWN], (BEST_EFFORT,), True),
    (2251, [NAME], [], (STRICT,), True),
    (2260, [UNKNOWN], [NAME], (STRICT,), False),
    (2266, [UNKNOWN], [NAME], (BEST_EFFORT,), False),
)


@SUITE.scenario({line: ok for line, *_, ok in SWITCHES} | {2275: "active", 2276: CLAIMS, 2279: CLAIMS})
def switches_with_an_unknown_controller():
    of = manager()
    of.load_controller(NAME)
    of.configure_controller(NAME)
    for line, activate, deactivate, strictnesses, _ in SWITCHES:
        yield line, any(of.switch_controller(activate, deactivate, strictness) for strictness in strictnesses)
    item = listed(of)
    yield 2275, item.state
    yield 2276, item.claimed_interfaces
    yield 2279, item.required_command_interfaces


test_holds_against_upstream = SUITE.test()
