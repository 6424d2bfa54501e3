from pathlib import Path

import pytest

from drake_twin.description.urdf_values import check_values
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

SHAPE = "<link name='a'><collision><geometry>{}</geometry></collision></link>"
ELEMENTS = {
    "origin": ("<link name='a'><visual>{}</visual></link>", "<origin xyz='0 0 {}'/>"),
    "turn": ("<joint name='a'>{}</joint>", "<origin rpy='0 0 {}'/>"),
    "mass": ("<link name='a'><inertial>{}</inertial></link>", "<mass value='{}'/>"),
    "inertia": ("<link name='a'><inertial>{}</inertial></link>", "<inertia ixx='1' iyz='{}'/>"),
    "box": (SHAPE, "<box size='1 1 {}'/>"),
    "sphere": (SHAPE, "<sphere radius='{}'/>"),
    "cylinder": (
        SHAPE,
        "<cylinder radius='1' length='{}'/>",
    ),
    "capsule": (SHAPE, "<capsule radius='{}' length='1'/>"),
    "mesh": (SHAPE, "<mesh scale='1 1 {}'/>"),
    "dynamics": ("<joint name='a'>{}</joint>", "<dynamics damping='{}'/>"),
    "mimic": ("<joint name='a'>{}</joint>", "<mimic offset='{}'/>"),
    "color": ("<material name='a'>{}</material>", "<color rgba='1 1 1 {}'/>"),
}


def check(body: str) -> None:
    check_values(XmlReader(f"<robot name='r'>\n{body}</robot>", Path("arm.urdf")))


def refusal(body: str) -> str:
    with pytest.raises(InputError) as raised:
        check(body)
    return str(raised.value)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("one", "'one', which is not a number."),
        ("nan", "'nan', which is not finite."),
        ("-inf", "'-inf', which is not finite."),
        ("1e308", "which is larger than 1e+12."),
        ("1 1", "needed."),
        ("", "needed."),
    ],
)
def test_a_wrong_number_gives_file_line_and_value(element, value, reason):
    around, inside = ELEMENTS[element]
    text = refusal(around.format("\n" + inside.format(value)))
    assert text.startswith("arm.urdf:3: <")
    assert text.endswith(reason)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_good_number_is_taken(element):
    around, inside = ELEMENTS[element]
    check(around.format(inside.format("0.5")))


@pytest.mark.parametrize(
    ("element", "text"),
    [
        ("mass", "<mass> of <inertial> of <link name=\"a\">: value is '-1', but it cannot be negative."),
        ("dynamics", "<dynamics> of <joint name=\"a\">: damping is '-1', but it cannot be negative."),
    ],
)
def test_what_cannot_be_negative_is_refused(element, text):
    around, inside = ELEMENTS[element]
    assert refusal(around.format(inside.format("-1"))) == f"arm.urdf:2: {text}"


def test_the_number_of_numbers_is_named():
    around, inside = ELEMENTS["color"]
    assert "rgba is '1 1 1 ', where 4 numbers are needed" in refusal(around.format(inside.format("")))
    around, inside = ELEMENTS["mass"]
    assert "value is '', where one number is needed" in refusal(around.format(inside.format("")))


def test_attributes_that_are_absent_are_left_to_their_defaults():
    check("<link name='a'><inertial><origin/><mass/><inertia/></inertial></link>")


@pytest.mark.parametrize("tag", ["gazebo", "ros2_control", "sensor"])
def test_what_drake_is_not_given_is_not_checked(tag):
    check(f"<{tag}><origin xyz='here'/></{tag}>")
