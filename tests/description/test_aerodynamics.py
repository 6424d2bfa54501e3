"""gz-sim's wings as controllers: the elements and defaults of its LiftDrag and AdvancedLiftDrag."""

from math import pi

import pytest
from test_gazebo_drives import drive_of, drives_of

from drake_twin.description.gazebo_drive import ADVANCED_LIFT_DRAG, LIFT_DRAG
from drake_twin.errors import InputError

LIBRARY = "gz-sim-lift-drag-system"
LINK = "<link_name>fl_link</link_name>"
LIFT = {"a0": 0.1, "cla": 2.0, "cda": 0.2, "cma": 0.3, "cm_delta": 0.8, "control_joint_rad_to_cl": 1.1}
STALL = {"alpha_stall": 0.4, "cla_stall": -0.5, "cda_stall": 0.6, "cma_stall": 0.7}
ALL = {**LIFT, **STALL, "area": 9.0, "air_density": 1.0}


def test_lift_drag_with_everything_said():
    numbers = "".join(f"<{tag}>{value}</{tag}>" for tag, value in ALL.items())
    drive = drive_of(
        f"{LINK}{numbers}<cp>1 2 3</cp><forward>0 2 0</forward><upward>1 0 1</upward><reversible>1</reversible>"
        "<radial_symmetry>true</radial_symmetry><control_joint_name>fr</control_joint_name>",
        LIBRARY,
        "gz::sim::systems::LiftDrag",
    )
    assert (drive.controller.name, drive.controller.type) == ("lift_drag", LIFT_DRAG)
    vectors = {"cp": [1.0, 2.0, 3.0], "forward": [0.0, 2.0, 0.0], "upward": [1.0, 0.0, 1.0]}
    names = {"link_name": "fl_link", "control_joint_name": "fr", "radial_symmetry": True, "reversible": True}
    assert drive.controller.parameters == {**ALL, **vectors, **names}
    assert (drive.unread, drive.interfaces, drive.topics) == ((), (), {})


def test_lift_drags_defaults():
    values = drive_of(f"{LINK}<forward/><upward/><area/><odd>1</odd>", LIBRARY).controller.parameters
    of_air = ("cla", "cda", "cda_stall", "alpha_stall", "air_density", "area", "control_joint_rad_to_cl")
    assert [values[name] for name in of_air] == [1.0, 0.01, 1.0, pi / 2, 1.2041, 1.0, 4.0]
    assert not any(values[name] for name in ("a0", "cma", "cla_stall", "cma_stall", "cm_delta", "control_joint_name"))
    assert (values["forward"], values["upward"], values["cp"]) == ([1, 0, 0], [0, 0, 1], [0, 0, 0])
    assert [values["radial_symmetry"], values["reversible"]] == [False, False]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "<link_name> is missing"),
        ("<link_name>fl</link_name>", "the robot has no link 'fl'"),
        (f"{LINK}<control_joint_name>flap</control_joint_name>", "the robot has no movable joint 'flap'"),
        (f"{LINK}<forward>0 0 0</forward>", "<forward> is zero"),
        (f"{LINK}<upward>-3 0 0</upward>", "<upward> is along <forward>"),
    ],
)
def test_a_wing_on_which_no_air_can_act_is_not_started(content, reason):
    (drive,) = drives_of(content, LIBRARY)
    assert drive.controller is None
    assert drive.not_started == f"drive ({LIBRARY}): {reason}"


@pytest.mark.parametrize(
    ("content", "what"),
    [
        ("<area>-1</area>", "<area> is -1, and has to be zero or more"),
        ("<air_density>-1.2</air_density>", "<air_density> is -1.2, and has to be zero or more"),
        ("<alpha_stall>-0.3</alpha_stall>", "<alpha_stall> is -0.3, and has to be zero or more"),
        ("<cla>much</cla>", "<cla> is 'much', which is not a number"),
        ("<cda>nan</cda>", "<cda> is 'nan', which is not finite"),
        ("<cp>1 2</cp>", "<cp> is '1 2', which is not three finite numbers"),
        ("<forward>1 0 inf</forward>", "<forward> is '1 0 inf', which is not three finite numbers"),
        ("<reversible>maybe</reversible>", "<reversible> is 'maybe', which is neither true nor false"),
    ],
)
def test_a_value_that_cannot_be_is_an_error(content, what):
    with pytest.raises(InputError) as caught:
        drives_of(f"{LINK}{content}", LIBRARY)
    assert caught.value.message == f"<plugin filename={LIBRARY!r}>: {what}"


ADVANCED = "gz-sim-advanced-lift-drag-system"
WING = f"{LINK}<AR>6.5</AR><eff>0.97</eff>"
SLOPES = [f"{kind}{by}" for kind in ("CD", "CY", "CL", "Cell", "Cem", "Cen") for by in "pqr"] + [
    *("CL0", "CD0", "CLa", "CYa", "Cella", "Cena", "CLb", "CYb", "Cellb", "Cemb", "Cenb")
]
BY_SURFACES = ("CL_ctrl", "CD_ctrl", "CY_ctrl", "Cell_ctrl", "Cem_ctrl", "Cen_ctrl")


def surface(joint, direction=1, first=0.0):
    values = "".join(f"<{tag}>{first + index}</{tag}>" for index, tag in enumerate(BY_SURFACES))
    named = f"<name>{joint}</name><index>0</index><direction>{direction}</direction>"
    return f"<control_surface>{named}{values}</control_surface>"


def test_advanced_lift_drag_with_everything_said():
    numbers = "".join(f"<{tag}>{index / 8}</{tag}>" for index, tag in enumerate(SLOPES))
    drive = drive_of(
        f"{WING}{numbers}<mac>0.2</mac><area>3</area><air_density>1.1</air_density><alpha_stall>0.4</alpha_stall>"
        "<cp>1 2 3</cp><forward>0 1 0</forward><upward>1 0 0</upward><a0>1</a0><CLa_stall>2</CLa_stall>"
        f"<num_ctrl_surfaces>2</num_ctrl_surfaces>{surface('fl', -1)}{surface('fr', 0.5, 10)}{surface('rl', 1, 20)}",
        ADVANCED,
        "gz::sim::systems::AdvancedLiftDrag",
    )
    values = drive.controller.parameters
    assert (drive.controller.name, drive.controller.type) == ("advanced_lift_drag", ADVANCED_LIFT_DRAG)
    assert [values[name] for name in SLOPES] == [index / 8 for index in range(len(SLOPES))]
    names = ("AR", "eff", "mac", "area", "air_density", "alpha_stall")
    assert [values[name] for name in names] == [6.5, 0.97, 0.2, 3.0, 1.1, 0.4]
    assert (values["cp"], values["forward"], values["upward"]) == ([1, 2, 3], [0, 1, 0], [1, 0, 0])
    assert (values["joints"], values["directions"]) == (["fl", "fr"], [-1.0, 0.5])  # the third is not counted
    assert [values[name] for name in BY_SURFACES] == [[index, 10 + index] for index in range(6)]
    assert (drive.unread, drive.warnings) == ((), ())


def test_advanced_lift_drags_defaults():
    values = drive_of(WING, ADVANCED).controller.parameters
    assert not any(values[name] for name in (*SLOPES, "mac", "joints", "directions"))
    assert [values[name] for name in ("area", "air_density", "alpha_stall")] == [1.0, 1.2041, pi / 2]


def test_what_gz_sim_reads_and_writes_over_is_a_warning():
    drive = drive_of(f"{WING}<Cem0>0.1</Cem0><Cema>-0.5</Cema><Cema_stall>0</Cema_stall>", ADVANCED)
    assert drive.warnings == ("<Cem0>, <Cema>: gz-sim reads and does not use it",)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (f"{LINK}<AR>6</AR>", "<eff> is missing"),
        (f"{WING}<area>0</area>", "<area> is zero"),
        (f"{WING}<upward>0 0 0</upward>", "<upward> is zero"),
        (f"{WING}<forward>0 0 0</forward>", "<forward> is zero"),
        ("<AR>6</AR><eff>1</eff>", "<link_name> is missing"),
        (f"{WING}{surface('flap')}", "the robot has no movable joint 'flap'"),
        (f"{WING}<num_ctrl_surfaces>2</num_ctrl_surfaces>{surface('fl')}", "<num_ctrl_surfaces> is 2, and there are 1"),
        (
            f"{WING}<control_surface><name>fl</name><direction>1</direction></control_surface>",
            f"each <control_surface> needs a name and direction, {', '.join(BY_SURFACES)}",
        ),
    ],
)
def test_an_aircraft_on_which_no_air_can_act_is_not_started(content, reason):
    (drive,) = drives_of(content, ADVANCED)
    assert drive.controller is None
    assert drive.not_started == f"drive ({ADVANCED}): {reason}"


@pytest.mark.parametrize(
    ("content", "what"),
    [
        ("<AR>-6</AR>", "<AR> is -6, and has to be zero or more"),
        ("<mac>-0.1</mac>", "<mac> is -0.1, and has to be zero or more"),
        ("<CLq>fast</CLq>", "<CLq> is 'fast', which is not a number"),
        (f"<AR>6</AR>{surface('fl', 'left')}", "<control_surface/direction> is 'left', which is not a number"),
    ],
)
def test_a_value_of_an_aircraft_that_cannot_be_is_an_error(content, what):
    with pytest.raises(InputError) as caught:
        drives_of(f"{LINK}<eff>1</eff>{content}", ADVANCED)
    assert caught.value.message == f"<plugin filename={ADVANCED!r}>: {what}"
