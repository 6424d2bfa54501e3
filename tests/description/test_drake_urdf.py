from pathlib import Path

import pytest
from lxml import etree
from prepared_urdf import BOX, DRAKE, ignored, in_drake, joint, links, prepare, refusal

from drake_twin import TwinBuilder
from drake_twin.description.drake_urdf import drake_link_name, prepare_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def test_the_model_has_the_robots_name_in_the_twin():
    robot, repairs = prepare(links("base"))
    assert robot.get("name") == "robot_1"
    assert repairs == []


@pytest.mark.parametrize("tag", ["ros2_control", "gazebo", "transmission"])
def test_tags_that_drake_must_not_act_on_are_dropped(tag):
    robot, _ = prepare(f"{links('base', 'arm')}{joint()}<{tag} name='t'/><{tag} name='u'/>")
    assert robot.find(tag) is None


def test_a_transmission_makes_no_actuator():
    transmission = (
        "<transmission name='t'><type>transmission_interface/SimpleTransmission</type><joint name='elbow'/>"
        "<actuator name='motor'/></transmission>"
    )
    robot, _ = prepare(links("base", "arm") + joint() + transmission)
    assert in_drake(etree.tostring(robot, encoding="unicode")).num_actuators() == 0


def test_a_link_called_world_gets_another_name_wherever_it_is_named():
    robot, _ = prepare(links("world", "base") + joint(parent="world", child="base"))
    assert [link.get("name") for link in robot.iterfind("link")] == ["robot_world", "base"]
    assert robot.find("joint/parent").get("link") == "robot_world"
    assert (drake_link_name("world"), drake_link_name("base")) == ("robot_world", "base")


def test_materials_defined_at_the_top_are_inlined():
    body = (
        f"<material name='red'><color rgba='1 0 0 1'/></material>"
        f"<link name='base'><visual>{BOX}<material name='red'/></visual></link>"
    )
    robot, repairs = prepare(body)
    assert robot.find("material") is None
    assert robot.find("link/visual/material/color").get("rgba") == "1 0 0 1"
    assert repairs == []


def test_a_material_defined_twice_keeps_each_visuals_own_colour():
    visuals = "".join(
        f"<visual name='v{index}'>{BOX}<material name='paint'>{color}</material></visual>"
        for index, color in enumerate(["<color rgba='1 0 0 1'/>", "<color rgba='0 1 0 1'/>", ""])
    )
    robot, _ = prepare(f"<link name='base'>{visuals}</link>")
    colors = [color.get("rgba") for color in robot.iterfind("link/visual/material/color")]
    assert colors == ["1 0 0 1", "0 1 0 1", "1 0 0 1"]
    names = [material.get("name") for material in robot.iter("material")]
    assert len(set(names)) == 3


def test_a_material_that_is_not_defined_is_left_out_once_for_all_its_visuals():
    visual = f"<visual>{BOX}<material name='pink'/></visual>"
    robot, repairs = prepare(f"<link name='base'>\n{visual}{visual}</link>")
    assert robot.find("link/visual/material") is None
    what = "material 'pink' is not defined: its visuals keep the colours of their meshes, or grey"
    assert repairs == [f"line 2: {what} [undefined_material]"]


def test_a_material_that_is_not_defined_is_refused_without_that_repair():
    body = f"<link name='base'><visual>{BOX}\n<material name='pink'/></visual></link>"
    text = refusal(body, Path("rover.urdf"), without=["undefined_material"])
    assert text == "rover.urdf:2: <material name=\"pink\">: the material 'pink' is not defined."


def test_the_first_of_several_materials_of_a_visual_counts():
    paints = "".join(f"<material name='{name}'/>" for name in ("red", "green"))
    colors = "<material name='red'><color rgba='1 0 0 1'/></material>"
    robot, repairs = prepare(f"{colors}<link name='base'><visual>{BOX}{paints}</visual></link>")
    assert [color.get("rgba") for color in robot.iter("color")] == ["1 0 0 1"]
    assert repairs == []


def test_a_blank_name_of_a_shape_is_left_out():
    robot, _ = prepare(f"<link name='base'><visual name=' '>{BOX}</visual><collision name='c'>{BOX}</collision></link>")
    assert robot.find("link/visual").get("name") is None
    assert robot.find("link/collision").get("name") == "c"


def test_a_material_of_a_texture_alone_needs_no_repair():
    _, repairs = prepare(
        f"<link name='base'><visual>{BOX}<material name='wood'><texture filename='a.png'/></material></visual></link>"
    )
    assert repairs == []


def test_gazebos_colour_is_used_where_a_visual_has_none_of_its_own():
    red = "<material name='red'><color rgba='1 0 0 1'/></material>"
    gazebo = "<gazebo reference='base'><material>Gazebo/Green</material></gazebo>"
    robot, repairs = prepare(f"<link name='base'><visual>{BOX}</visual><visual>{BOX}{red}</visual></link>{gazebo}")
    assert [color.get("rgba") for color in robot.iterfind("link/visual/material/color")] == ["0 1 0 1", "1 0 0 1"]
    assert repairs == []


@pytest.mark.parametrize(
    ("material", "expected"),
    [
        ("<ambient>0 .3 0 1</ambient><diffuse>0 .8 0 1</diffuse>", "0 0.8 0 1"),
        ("<ambient>0 .3 0</ambient>", "0 0.3 0 1"),
        ("<diffuse>0 9 0 1</diffuse>", "0 1 0 1"),
        ("<diffuse>green</diffuse>", "1 0 0 1"),
    ],
)
def test_a_visual_of_gazebos_tag_colours_visuals_without_a_name(material, expected):
    """As libsdformat merges it into these alone, whatever their own colour is."""
    red = "<material name='red'><color rgba='1 0 0 1'/></material>"
    gazebo = f"<gazebo reference='base'><visual><material>{material}</material></visual></gazebo>"
    visuals = f"<visual>{BOX}{red}</visual><visual name='own'>{BOX}{red}</visual>"
    robot, _ = prepare(f"<link name='base'>{visuals}</link>{gazebo}")
    assert [color.get("rgba") for color in robot.iterfind("link/visual/material/color")] == [expected, "1 0 0 1"]


def test_a_gazebo_colour_that_is_not_known_changes_nothing():
    gazebo = "<gazebo reference='base'><material>Gazebo/Plaid</material></gazebo>"
    robot, _ = prepare(f"<link name='base'><visual>{BOX}</visual></link>{gazebo}")
    assert robot.find("link/visual/material") is None


@pytest.mark.parametrize(("tags", "expected"), [("<mu1>0.9</mu1><mu2>0.5</mu2>", 0.5), ("<mu2>0.7</mu2>", 0.7)])
@pytest.mark.parametrize("link", ["base", "world"])
def test_the_smaller_friction_coefficient_of_a_link_reaches_its_collision_shapes(link, tags, expected):
    body = f"<link name='{link}'><collision>{BOX}</collision></link><gazebo reference='{link}'>{tags}</gazebo>"
    robot, _ = prepare(body)
    properties = robot.find(f"link/collision/{DRAKE}proximity_properties")
    for name in ("mu_dynamic", "mu_static"):
        assert float(properties.find(DRAKE + name).get("value")) == expected


def test_a_link_without_friction_keeps_drakes_own():
    robot, _ = prepare(f"<link name='base'><collision>{BOX}</collision></link>")
    assert robot.find(f"link/collision/{DRAKE}proximity_properties") is None


def test_a_follower_of_ros2_control_is_coupled_in_drake():
    ros2_control = (
        "<ros2_control name='s' type='system'><joint name='wrist'><param name='mimic'>elbow</param>"
        "<param name='multiplier'>-0.5</param></joint></ros2_control>"
    )
    robot, _ = prepare(links("base", "arm", "hand") + joint() + joint("wrist", "arm", "hand") + ros2_control)
    assert dict(robot.find("joint[@name='wrist']/mimic").attrib) == {
        "joint": "elbow",
        "multiplier": "-0.5",
        "offset": "0",
    }
    assert in_drake(etree.tostring(robot, encoding="unicode")).num_constraints() == 1


def test_a_follower_of_the_urdf_keeps_its_own_mimic():
    inside = "<mimic joint='elbow' multiplier='2'/>"
    robot, _ = prepare(links("base", "arm", "hand") + joint() + joint("wrist", "arm", "hand", inside))
    (mimic,) = robot.findall("joint/mimic")
    assert dict(mimic.attrib) == {"joint": "elbow", "multiplier": "2"}


def test_joint_friction_is_left_to_the_plant_and_damping_stays():
    robot, repairs = prepare(links("base", "arm") + joint(inside="<dynamics damping='0.5' friction='0.1'/>"))
    assert dict(robot.find("joint/dynamics").attrib) == {"damping": "0.5"}
    assert repairs == []


def test_joint_friction_counts_as_ignored_only_when_it_is_left_out():
    body = links("base", "arm") + joint(inside="<dynamics friction='0.1'/>")
    assert ignored(body) == []
    assert ignored(body, without=["joint_friction"]) == ["friction of joint elbow: without the repair joint_friction"]
    assert ignored(body.replace("0.1", "0.0"), without=["joint_friction"]) == []
    follower = joint("wrist", "arm", "hand", "<dynamics friction='0.1'/><mimic joint='elbow'/>")
    why = "it follows another joint, whose friction counts"
    assert ignored(links("base", "arm", "hand") + joint() + follower) == [f"friction of joint wrist: {why}"]


def test_what_is_ignored_does_not_reach_drake():
    robot, _ = prepare(f"<link name='base'><note/></link><link name='arm'/>{joint(inside='<note/>')}<note/>")
    assert next(robot.iter("note"), None) is None


def test_the_document_that_was_read_is_not_changed():
    text = f"<robot name='own'>{links('world', 'arm')}{joint(parent='world')}<transmission name='t'/></robot>"
    reader = XmlReader(text)
    before = etree.tostring(reader.root)
    description = describe_urdf(reader, text)
    prepare_urdf(reader, description, "robot_1", PackageIndex((), {}))
    assert etree.tostring(reader.root) == before
    assert description.text == text


def test_an_attribute_that_links_do_not_have_is_one_finding_of_the_twins_own(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(f"<robot name='r'>{links('base').replace('<link ', '<link type=' + repr('laser') + ' ')}</robot>")
    twin = TwinBuilder().robot("r", file).build()
    about = [finding.what for finding in twin.findings if "type" in finding.what]
    assert about == ["the attribute type of <link>"]
