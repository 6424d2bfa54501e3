"""Joints of SDF that follow others: what Drake is given, the description of a robot, and how they move."""

import pytest
from lxml import etree
from sdf_worlds import findings, world_of

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Mimic
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.sdf_mimic import couple, followers
from drake_twin.scenario import World

INERTIAL = """<inertial><pose>0 0 -0.5 0 0 0</pose><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz>
</inertia></inertial>"""
RULE = "<multiplier>-2</multiplier><reference>0.1</reference><offset>0.3</offset>"  # -2 (q - 0.1) + 0.3


def mimic(inside="", leader="lead", axis="axis"):
    return f'<mimic joint="{leader}" axis="{axis}">{inside}</mimic>'


def hinge(name, inside="", kind="revolute", child=None):
    return f"""<joint name="{name}" type="{kind}"><parent>base</parent><child>{child or name + "_arm"}</child>
<axis><xyz>0 1 0</xyz>{inside}</axis></joint>"""


def model(follow, *, kind="revolute", more="", name="m"):
    """A base in the air with two arms, of which one follows the other."""
    links = "".join(f'<link name="{link}">{INERTIAL}</link>' for link in ("base", "lead_arm", "follow_arm"))
    fixed = '<joint name="fixed" type="fixed"><parent>world</parent><child>base</child></joint>'
    return f'<model name="{name}">{links}{fixed}{hinge("lead")}{hinge("follow", follow, kind)}{more}</model>'


def test_a_follower_has_the_rule_of_its_file_with_its_defaults():
    found = [(joint.get("name"), rule) for joint, rule in followers(etree.fromstring(model(mimic(RULE))))]
    assert found == [("follow", Mimic("lead", -2.0, 0.5))]
    assert [rule for _, rule in followers(etree.fromstring(model(mimic())))] == [Mimic("lead")]


def test_drake_has_it_as_an_element_of_its_own():
    root = etree.fromstring(model(mimic(RULE)))
    assert list(couple(root)) == []
    (found,) = root.iter("{http://drake.mit.edu}mimic")
    assert dict(found.attrib) == {"joint": "lead", "multiplier": "-2", "offset": "0.5"}
    assert root.find(".//axis/mimic") is None


@pytest.mark.parametrize(
    ("inside", "kind"),
    [
        (mimic(leader="nobody"), "revolute"),
        (mimic(leader="follow"), "revolute"),
        (mimic(leader="fixed"), "revolute"),
        (mimic(axis="axis2"), "revolute"),
        (mimic("<multiplier>inf</multiplier>"), "revolute"),
        (mimic(), "ball"),
    ],
)
def test_one_that_cannot_follow_is_a_finding(tmp_path, inside, kind):
    (what,) = (item for item in findings(world_of(tmp_path, model(inside, kind=kind))) if "moves freely" in item)
    assert "joint follow moves freely: it cannot follow " in what


def angles(twin, instance):
    context, index = twin.plant.GetMyContextFromRoot(twin.context), twin.plant.GetModelInstanceByName(instance)
    return {name: twin.plant.GetJointByName(name, index).get_angle(context) for name in ("lead", "follow")}


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_in_a_world_it_follows_while_the_leader_is_pushed(tmp_path, time_step):
    (tmp_path / "w.sdf").write_text(f'<sdf version="1.11"><world name="w">{model(mimic(RULE))}</world></sdf>')
    twin = TwinBuilder(world=World(file=str(tmp_path / "w.sdf")), time_step=time_step).build()
    assert twin.findings == ()
    twin.entities.apply_wrench("m::lead_arm", torque=(0.0, 2.0, 0.0), duration=1.0)
    twin.advance_to(1.0)
    found = angles(twin, "m")
    assert found["follow"] == pytest.approx(-2 * found["lead"] + 0.5, abs=2e-3)
    assert abs(found["lead"]) > 0.05


def test_a_robots_follower_is_one_in_its_description_also_from_a_model_inside(tmp_path):
    inside = model(mimic(RULE), name="in").replace("world</parent>", "mount</parent>")
    inside = inside.replace(inside[inside.index('<joint name="fixed"') : inside.index('<joint name="lead"')], "")
    outer = """<link name="mount"/><joint name="j" type="fixed"><parent>mount</parent><child>in::base</child></joint>"""
    (tmp_path / "r.sdf").write_text(f'<sdf version="1.11"><model name="r">{outer}{inside}</model></sdf>')
    read = load_robot_model(str(tmp_path / "r.sdf"), PackageIndex(()))
    assert read.findings == ()
    assert {joint.name: joint.mimic for joint in read.description.movable_joints} == {
        "in_lead": None,
        "in_follow": Mimic("in_lead", -2.0, 0.5),
    }
    twin = TwinBuilder().robot("r", tmp_path / "r.sdf", xyz=(0, 0, 5)).build()
    twin.advance_to(0.5)
    lead, follow = (twin.joint_states("r").position[place] for place in (0, 1))
    assert follow == pytest.approx(-2 * lead + 0.5, abs=2e-3)
