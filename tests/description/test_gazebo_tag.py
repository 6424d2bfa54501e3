"""Flags below a URDF's ``<gazebo>``: those that libsdformat's reader of URDFs converts know ``yes`` and ``no``, too."""

import pytest
from lxml import etree

from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.description.flags import wrong_flags
from drake_twin.description.gazebo_tag import text_or_value
from drake_twin.description.link_gravity import gravity_of_urdf
from drake_twin.description.link_surface import link_surfaces
from drake_twin.description.urdf import is_static_in_gazebo
from drake_twin.description.xml_reader import XmlReader


def reader(tag, reference="base"):
    joint = '<joint name="j" type="fixed"><parent link="base"/><child link="tip"/></joint>'
    told = f'<gazebo reference="{reference}">{tag}</gazebo>' if reference else f"<gazebo>{tag}</gazebo>"
    return XmlReader(f'<robot name="r"><link name="base"><inertial/></link><link name="tip"/>{joint}\n{told}</robot>')


@pytest.mark.parametrize(
    ("text", "is_set"), [("yes", True), ("YES", True), ("1", True), ("no", False), ("0", False), ("on", False)]
)
@pytest.mark.parametrize("form", ["<{0}> {1} </{0}>", '<{0} value="{1}"/>'])
def test_a_flag_that_the_reader_converts_may_be_yes(form, text, is_set):
    tag = {name: form.format(name, text) for name in ("static", "selfCollide", "preserveFixedJoint")}
    assert is_static_in_gazebo(reader(tag["static"], "").root) is is_set
    assert link_surfaces(reader(tag["selfCollide"]))["base"].self_collide is is_set
    assert lumped_links(reader(tag["preserveFixedJoint"], "j").root) == ({} if is_set else {"tip": "base"})
    for name, told in tag.items():
        found = reader(told)
        what = f"<{name}> is {text!r}, which is neither true nor false: it counts as false"
        assert [item.what for item in wrong_flags(found, found.root)] == ([what] if text == "on" else [])


@pytest.mark.parametrize(
    ("text", "falls"), [("yes", False), ("off", False), ("no", True), ("False", True), ("0", True)]
)
def test_gravity_is_turned_off_by_any_word_that_is_not_a_no(text, falls):
    found = reader(f"<turnGravityOff>{text}</turnGravityOff>")
    assert gravity_of_urdf(found).falls is falls
    said = [(item.what, item.lines) for item in wrong_flags(found, found.root)]
    what = "<turnGravityOff> is 'off', which is neither true nor false: it counts as true"
    assert said == ([(what, (2,))] if text == "off" else [])


def test_other_flags_are_sdfs_own():
    found = reader("<self_collide>yes</self_collide>")
    assert link_surfaces(found)["base"].self_collide is False
    (finding,) = wrong_flags(found, found.root)
    assert finding.what == "<self_collide> is 'yes', which is neither true nor false: it counts as false"


def test_a_word_is_read_in_both_spellings():
    element = etree.fromstring("<gazebo><mu1>0.9</mu1><mu2 value='0.8'/><kp/></gazebo>")
    assert [text_or_value(element, tag) for tag in ("mu1", "mu2", "kp", "kd")] == ["0.9", "0.8", None, None]
