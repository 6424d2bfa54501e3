"""gz-sim's wings as controllers: the elements and defaults of its LiftDrag."""

from math import pi

import pytest
from test_gazebo_drives import drive_of, drives_of

from drake_twin.description.gazebo_drive import LIFT_DRAG
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
