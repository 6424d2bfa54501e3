"""Models inside models: joints between them, and robots of several models or several trees of links."""

import numpy as np
import pytest
from lxml import etree
from pydrake.math import RigidTransform, RollPitchYaw
from sdf_worlds import findings, model_file, world_of
from waters import propelled, thruster

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.sdf_nested import join_across_models
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario import World

INERTIAL = "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
LIFT = f"""<model name="lift"><pose>0 0 5 0 0.3 0</pose><link name="platform">{INERTIAL}</link>
  <joint name="cabin" type="fixed"><parent>world</parent><child>platform</child></joint>
  <model name="door"><pose>0.5 0 0 0 0 1.5707963267948966</pose>
    <link name="wing"><pose>0 1 0 0 0 0</pose>{INERTIAL}</link>
    <joint name="slide" type="prismatic"><parent>platform</parent><child>wing</child>
      <axis><xyz>0 1 0</xyz></axis></joint></model></model>"""


def test_a_door_slides_along_the_cabin_of_the_model_around_it(tmp_path):
    file = tmp_path / "lift.sdf"
    file.write_text(f'<sdf version="1.7"><world name="w"><gravity>0 0 -9.81</gravity>{LIFT}</world></sdf>')
    robot = tmp_path / "r.urdf"
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    robot.write_text(f"<robot name='r'><link name='l'><inertial><mass value='1'/>{inertia}</inertial></link></robot>")
    twin = TwinBuilder(0.001, world=World(file=str(file), ground=False)).robot("r", robot, xyz=(9, 0, 0)).build()
    twin.advance_to(0.4)
    wing = twin.plant.GetBodyByName("wing")
    position = wing.EvalPoseInWorld(twin.plant.GetMyContextFromRoot(twin.context)).translation()
    # The rail falls at 0.3 rad along the lift's x: g·sin(0.3) without friction.
    X_WL = RigidTransform(RollPitchYaw(0, 0.3, 0), [0, 0, 5])
    slid = 0.5 * 9.81 * np.sin(0.3) * 0.4**2
    np.testing.assert_allclose(position, X_WL @ np.array([-0.5 + slid, 0, 0]), atol=1e-3)
    assert abs(slid) > 0.2


@pytest.mark.parametrize(
    ("joint", "expected"),
    [
        ("<parent>base</parent><child>wing</child>", ("base", "inner::deep::wing")),
        ("<parent>rail</parent><child>wing</child>", ("rail", "deep::wing")),
        ("<parent>wing</parent><child>base</child>", ("inner::deep::wing", "base")),
        ("<parent>world</parent><child>wing</child>", None),
        ("<parent>__model__</parent><child>wing</child>", None),
        ("<parent>absent</parent><child>wing</child>", None),
        ("<parent>a::b</parent><child>wing</child>", None),
    ],
)
def test_the_nearest_model_around_has_the_link(joint, expected):
    pose = '<pose relative_to="wing">0 0 1 0 0 0</pose><axis><xyz expressed_in="__model__">1 0 0</xyz></axis>'
    text = f"""<model name="outer"><link name="base"/><joint name="inner_deep_j"/>
      <model name="inner"><link name="rail"/><model name="deep"><link name="wing"/>
      <joint name="j" type="revolute">{joint}{pose}</joint></model></model></model>"""
    model = etree.fromstring(text)
    said = list(join_across_models(model))
    (moved,) = [item for item in model.iter("joint") if item.find("child") is not None]
    if expected is None:
        assert (said, moved.getparent().get("name")) == ([], "deep")
        return
    assert (moved.findtext("parent"), moved.findtext("child")) == expected
    path = next(name for name in expected if "::" in name).removesuffix("::wing")
    assert moved.find("pose").get("relative_to") == f"{path}::wing"
    assert moved.find("axis/xyz").get("expressed_in") == f"{path}::__model__"
    assert moved.get("name") == {"inner::deep": "inner_deep_j_0", "deep": "deep_j"}[path]
    assert said[0].startswith(f"j of the model {path} inside it: joined to ")


def test_a_world_tells_of_such_a_joint(tmp_path):
    (text,) = [text for text in findings(world_of(tmp_path, LIFT)) if "slide" in text]
    assert "lift: slide of the model door inside it: joined to 'platform' of the model around" in text


BOX = "<collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>"
HAND = f"""<model name="hand"><pose relative_to="lower">0 0 1 0 0 0</pose><link name="palm">{INERTIAL}</link></model>"""
ARM = f"""<model name="arm"><pose>1 0 0 0 0 1.5707963267948966</pose>
  <link name="upper"><pose>1 0 0 0 0 0</pose>{INERTIAL}</link>
  <link name="lower"><pose relative_to="upper">1 0 0 0 0 0</pose>{INERTIAL}
    <sensor name="imu" type="imu"><update_rate>5</update_rate></sensor></link>
  <frame name="tool" attached_to="lower"/>{{hand}}
  <joint name="elbow" type="revolute"><parent>upper</parent><child>lower</child>
    <axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint>
  <joint name="wrist" type="fixed"><parent>lower</parent><child>hand::palm</child></joint>{{more}}</model>"""
PLUGIN = """<plugin filename="gz-sim-joint-position-controller-system" name="gz::sim::systems::JointPositionController">
  <joint_name>{}</joint_name></plugin>"""


def robot_file(folder, body):
    file = folder / "robot.sdf"
    file.write_text(
        f'<sdf version="1.9"><model name="robot">\n<link name="base">{INERTIAL}</link>\n{body}</model></sdf>'
    )
    return file


def positions(twin, *links):
    context = twin.plant.GetMyContextFromRoot(twin.context)
    return [twin.plant.GetBodyByName(link).EvalPoseInWorld(context).translation() for link in links]


MOUNT = '<joint name="mount" type="fixed"><parent>base</parent><child>arm::upper</child></joint>'


@pytest.mark.parametrize("plugin", ["around", "inside"])
def test_a_robot_may_consist_of_models_inside_models(tmp_path, plugin):
    inside, around = ("", PLUGIN.format("arm::elbow")) if plugin == "around" else (PLUGIN.format("elbow"), "")
    file = robot_file(tmp_path, ARM.format(hand=HAND, more=inside) + MOUNT + around)
    twin = TwinBuilder(0.001).robot("r", file, xyz=(0, 0, 5)).build()
    assert [finding.what for finding in twin.findings if "collision shape" not in finding.what] == []
    # The arm stands at (1, 0) and looks along y; each link is 1 m further on, the palm 1 m above the last.
    expected = [(0, 0, 5), (1, 1, 5), (1, 2, 5), (1, 2, 6)]
    np.testing.assert_allclose(positions(twin, "base", "arm_upper", "arm_lower", "arm_hand_palm"), expected, atol=1e-12)
    assert twin.graph.topics()["/r/joint/arm_elbow/0/cmd_pos"] == "std_msgs/msg/Float64"
    (axis,) = [joint.axis for joint in twin.built.plans[0].description.joints if joint.name == "arm_elbow"]
    np.testing.assert_allclose(axis, (0, 1, 0), atol=1e-12)  # of the arm's frame, as the link is
    assert [(sensor.name, sensor.link) for sensor in twin.built.plans[0].description.sensors] == [("imu", "arm_lower")]


def test_a_robots_own_includes_are_parts_of_it(tmp_path):
    link = f"<link name='palm'>{INERTIAL}</link>"
    model_file(tmp_path, "gripper", link)
    include = "<include><uri>gripper</uri><name>left</name><pose>0 0 3 0 0 0</pose></include>"
    joint = '<joint name="mount" type="fixed"><parent>base</parent><child>left::palm</child></joint>'
    file = robot_file(tmp_path, include + joint)
    description = load_robot_model(
        str(file), PackageIndex((tmp_path,), {"GZ_SIM_RESOURCE_PATH": str(tmp_path)})
    ).description
    assert description.links == ("base", "left_palm")
    assert description.joints[0].origin.xyz == (0, 0, 3)


def test_a_model_inside_may_be_placed_in_the_frame_of_the_model_around_it(tmp_path):
    """Its pose is in the scope of that: ``__model__`` there is not the model itself."""
    inner = f"""<model name="{{0}}"><pose relative_to="{{1}}">1 0 0 0 0 0</pose><link name="base">{INERTIAL}</link>
    </model>
    <joint name="{{0}}_joint" type="fixed"><parent>base</parent><child>{{0}}::base</child></joint>"""
    models = inner.format("front", "__model__") + inner.format("further", "front")
    file = tmp_path / "r.sdf"
    base = f'<link name="base"><pose>0 2 0 0 0 0</pose>{INERTIAL}</link>'
    file.write_text(f'<sdf version="1.11"><model name="r">{base}{models}</model></sdf>')
    plant = TwinBuilder(0.001).robot("r", file, xyz=(0, 0, 3)).build().plant
    context = plant.CreateDefaultContext()
    places = [plant.GetBodyByName(name).EvalPoseInWorld(context).translation() for name in ("base", "front_base")]
    np.testing.assert_allclose(places[1] - places[0], [1, -2, 0], atol=1e-9)
    further = plant.GetBodyByName("further_base").EvalPoseInWorld(context).translation()
    np.testing.assert_allclose(further - places[1], [1, 0, 0], atol=1e-9)


def test_a_topic_with_the_name_of_a_model_inside_keeps_it(tmp_path):
    plugin = thruster(topic="left", namespace="left", velocity_control=1)
    text = propelled((1.0, 0.4, 0.3), plugin).replace('name="auv"', 'name="left"')
    file = tmp_path / "r.sdf"
    file.write_text(f'<sdf version="1.11"><model name="r">{text}</model></sdf>')
    twin = TwinBuilder(0.001).robot("r", file, xyz=(0, 0, 3)).build()
    assert twin.graph.topics()["/r/left"] == "std_msgs/msg/Float64"


def test_what_a_model_inside_a_robot_asks_beyond_its_links_is_told_with_its_line(tmp_path):
    file = robot_file(tmp_path, '<model name="a">\n<static>true</static><enable_wind>false</enable_wind></model>')
    (finding,) = load_robot_model(str(file), PackageIndex(())).findings
    assert (finding.kind, finding.what, finding.lines) == (
        Kind.IGNORED,
        "<static> of a model inside the robot's",
        (4,),
    )
    file = robot_file(tmp_path, '<model name="a" placement_frame="l"><link name="l"/></model>')
    with pytest.raises(InputError, match=r"robot.sdf:3: <model name=\"a\">: the placement_frame of a model inside"):
        load_robot_model(str(file), PackageIndex(()))


def test_links_that_nothing_joins_are_free_bodies_of_one_robot(tmp_path):
    loose = f"""<link name="crate"><pose>1 0 2 0 0 0</pose>{INERTIAL}</link>
      <link name="arm"><pose>0 1 3 0 0 0</pose>{INERTIAL}</link>
      <link name="rod"><pose>0 2 3 0 0 0</pose>{INERTIAL}</link>
      <joint name="hinge" type="revolute"><parent>arm</parent><child>rod</child><axis><xyz>0 0 1</xyz></axis></joint>"""
    file = robot_file(tmp_path, loose)
    builder = TwinBuilder(0.001, world=World(ground=False))
    twin = builder.robot("r", file, xyz=(3, 0, 4), rpy=(0, 0, np.pi / 2)).build()
    start = np.array([(3, 0, 4), (3, 1, 6), (2, 0, 7), (1, 0, 7)])
    names = ("base", "crate", "arm", "rod")
    np.testing.assert_allclose(positions(twin, *names), start, atol=1e-12)
    assert twin.robot_state("r").joints == ("hinge",)
    twin.advance_to(0.5)
    fallen = start - (0, 0, 0.5 * 9.81 * 0.5**2)
    np.testing.assert_allclose(positions(twin, *names), fallen, atol=3e-3)  # the step times half the speed
    before, digest = twin.snapshot(), twin.state_sha256()
    twin.advance_to(0.7)
    twin.restore(before)
    assert twin.state_sha256() == digest
    twin.reset()
    np.testing.assert_allclose(positions(twin, *names), start, atol=1e-12)
    twin.entities.place("r", (3, 0, 1))  # the whole model, as Gazebo's set_pose
    turned = [(3, 0, 1), (4, 0, 3), (3, 1, 4), (3, 2, 4)]
    np.testing.assert_allclose(positions(twin, *names), turned, atol=1e-12)
    twin.entities.set_state("r::crate", (0, 0, 9))
    np.testing.assert_allclose(positions(twin, *names), [turned[0], (0, 0, 9), *turned[2:]], atol=1e-12)


def test_the_tree_that_is_fixed_to_the_world_is_the_robots_base(tmp_path):
    links = "".join(
        f"<link name='{name}'><pose>{x} 0 2 0 0 0</pose>{INERTIAL}</link>"
        for name, x in {"a": 1, "b": 2, "c": 3}.items()
    )
    welds = "".join(
        f"<joint name='{name}_weld' type='fixed'><parent>world</parent><child>{name}</child></joint>" for name in "ac"
    )
    file = robot_file(tmp_path, links + welds)
    twin = TwinBuilder(0.001, world=World(ground=False)).robot("r", file, xyz=(0, 5, 0)).build()
    twin.advance_to(0.5)
    fallen = 0.5 * 9.81 * 0.5**2
    expected = [(0, 5, -fallen), (1, 5, 2), (2, 5, 2 - fallen), (3, 5, 2)]
    np.testing.assert_allclose(positions(twin, "base", *"abc"), expected, atol=3e-3)


@pytest.mark.parametrize(
    ("canonical", "links"),
    [("", "tip grip"), (' canonical_link="tip"', "tip grip"), (' canonical_link="grip"', "grip tip")],
)
@pytest.mark.parametrize(("pose", "x"), [("<pose>0 0.5 2 0 0 0</pose>", (0.0, 0.5, 1.0)), ("", (0.0, 0.0, -1.0))])
def test_a_joint_may_name_a_model_inside_for_its_canonical_link(tmp_path, canonical, links, pose, x):
    """The joint is in the frame of that model, wherever its link is: at x of the rod, and turns about y."""
    first, second = links.split()
    (tmp_path / "arm.sdf").write_text(f"""<sdf version="1.9"><model name="arm"><link name="base">{INERTIAL}</link>
<link name="rod"><pose>0 0 1 0 0 0</pose>{INERTIAL}</link>
<joint name="turn" type="revolute"><parent>base</parent><child>rod</child><axis><xyz>1 0 0</xyz></axis></joint>
<model name="hand"{canonical}>{pose}
<link name="tip"><pose>0 1 0 0 0 0</pose>{INERTIAL}</link><link name="grip"><pose>0 0 3 0 0 0</pose>{INERTIAL}</link>
<joint name="both" type="fixed"><parent>{first}</parent><child>{second}</child></joint></model>
<joint name="wrist" type="revolute"><parent>rod</parent><child>hand</child><axis><xyz>0 1 0</xyz></axis></joint>
</model></sdf>""")
    twin = TwinBuilder(world=World(gravity=(0, 0, 0))).robot("arm", tmp_path / "arm.sdf").build()
    twin.entities.set_joint_positions("arm", {"wrist": np.pi / 2})
    place = {link: twin.entities.state(f"arm::{link}", "arm::rod").position for link in ("hand_tip", "hand_grip")}
    assert place["hand_tip"] == pytest.approx(np.add(x, (0, 1, 0)), abs=1e-9)
    assert place["hand_grip"] == pytest.approx(np.add(x, (3, 0, 0)), abs=1e-9)
