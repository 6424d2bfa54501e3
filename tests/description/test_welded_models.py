"""Models that joints fix to the world: what gz-sim's gz-sim-detachable-joint-system holds others by."""

import pytest
from lxml import etree

from drake_twin.cli.options import parser
from drake_twin.cli.target import build_twin, find_target
from drake_twin.description.welded_models import weld_holder, weld_to_world

JOINT = """<plugin filename="gz-sim-detachable-joint-system" name="gz::sim::systems::DetachableJoint">
<parent_link>arm</parent_link><child_model>box</child_model><child_link>body</child_link>
<detach_topic>/drop</detach_topic></plugin>"""


def model(inside):
    return etree.fromstring(f'<model name="m">{inside}</model>')


def welds(element):
    return [(joint.findtext("parent"), joint.findtext("child")) for joint in element.findall("joint[@type='fixed']")]


def test_each_link_that_no_joint_holds_is_fixed():
    joint = '<joint name="j" type="revolute"><parent>a</parent><child>b</child></joint>'
    element = model(f'<link name="a"/><link name="b"/><link name="c"/>{joint}')
    weld_to_world(element)
    assert welds(element) == [("world", "a"), ("world", "c")]


def test_a_model_without_links_cannot_be_fixed():
    with pytest.raises(ValueError, match="no link of its own"):
        weld_to_world(model("<model name='n'><link name='l'/></model>"))


def test_a_static_model_that_holds_others_is_fixed_by_joints():
    element = model(f"<static>1</static><link name='arm'/>{JOINT}")
    weld_holder(element)
    assert welds(element) == [("world", "arm")]
    assert element.find("static") is None


@pytest.mark.parametrize(
    "inside",
    [
        "<static>1</static><link name='arm'/>",
        f"<link name='arm'/>{JOINT}",
        f"<static>1</static><link name='arm'><collision><geometry><plane/></geometry></collision></link>{JOINT}",
        f"<static>1</static><model name='n'><link name='arm'/></model>{JOINT}",
    ],
)
def test_others_stay_as_they_are(inside):
    element = model(inside)
    before = etree.tostring(element)
    weld_holder(element)
    assert etree.tostring(element) == before


def test_it_holds_a_model_until_a_message_comes(tmp_path):
    """The box is held for 0.5 s, and then falls for 0.5 s."""
    holder = f'<model name="holder"><static>true</static><pose>0 0 9 0 0 0</pose><link name="arm"/>{JOINT}</model>'
    inertial = "<inertial><mass>2</mass></inertial>"
    box = f'<model name="box"><pose>1 0 5 0 0 0</pose><link name="body">{inertial}</link></model>'
    file = tmp_path / "w.sdf"
    file.write_text(f'<sdf version="1.9"><world name="w">{holder}{box}</world></sdf>')
    twin = build_twin(find_target(parser().parse_args([str(file)])))
    assert twin.robots == ("holder",)
    twin.advance_to(0.5)
    assert twin.entities.state("box").position == pytest.approx((1, 0, 5), abs=1e-4)
    twin.publish("/holder/drop", {})
    twin.advance_to(1.0)
    assert twin.entities.state("box").position == pytest.approx((1, 0, 5 - 9.8 / 2 * 0.25), abs=5e-3)
