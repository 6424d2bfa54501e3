"""Which findings a run tells, and in what order."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.world_file import read_world
from drake_twin.findings import Finding, Kind, Weight, grouped, most_telling
from drake_twin.scenario import Robot, Scenario, World
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml


def findings(count, kind=Kind.IGNORED, what="<thing {}> in <link>", weight=Weight.MOVES):
    return [Finding(kind, what.format(number), robot="r", weight=weight) for number in range(count)]


def test_a_few_findings_are_all_told():
    assert most_telling([]) == []
    assert most_telling(findings(5)) == [f"ignored: r: <thing {number}> in <link>" for number in range(5)]


def test_of_many_the_last_line_tells_how_many_more_there_are():
    lines = most_telling([*findings(4), *findings(3, Kind.WARNING, "odd {}")])
    assert len(lines) == 5
    assert lines[-1] == "and 3 more findings (3 warning): --findings prints them all"


def test_what_is_lost_comes_first_then_what_does_not_start_and_looks_come_last():
    looks = findings(4, Kind.FAILED, "picture {}", Weight.LOOKS)
    lost = findings(1, Kind.WARNING, "world {}", Weight.LOST)
    moves = [*findings(1, Kind.WARNING, "odd {}"), *findings(1, Kind.NOT_STARTED, "controller {}")]
    assert most_telling([*looks, *moves, *lost])[:4] == [
        "warning: r: world 0",
        "not started: r: controller 0",
        "warning: r: odd 0",
        "failed: r: picture 0",
    ]


KINDS = ("failed", "not started", "ignored", "refused by ROS 2", "warning", "mended", "window")


def test_every_weight_and_kind_has_its_place():
    """By weight, and within it by kind; a report of all has what is lost first and then goes by kind alone."""
    mixed = [Finding(kind, f"{weight} {kind}", weight=weight) for kind in reversed(Kind) for weight in Weight]
    counts = [*(f"3 {kind}" for kind in KINDS[4:]), *(f"2 {kind}" for kind in KINDS[:4])]
    assert most_telling(mixed) == [
        *(f"{kind}: lost {kind}" for kind in KINDS[:4]),
        f"and 17 more findings ({', '.join(counts)}): --findings prints them all",
    ]
    assert (
        most_telling([finding for finding in mixed if finding.weight is not Weight.LOST])[0] == "failed: moves failed"
    )
    by_kind = [(kind, weight) for kind in KINDS for weight in ("moves", "looks")]
    assert [sentence for _, sentence in grouped(mixed)] == [
        *(f"lost {kind}" for kind in KINDS),
        *(f"{weight} {kind}" for kind, weight in by_kind),
    ]


def test_findings_of_one_cause_are_one_line_with_all_their_lines():
    common = " in <sensor> of sensor 's'"
    parts = [
        Finding(Kind.IGNORED, f"<{tag}>{common}", robot, "r.urdf", (line,), common=common)
        for robot in ("a", "b")
        for line, tag in enumerate("xyz", 7)
    ]
    repairs = [Finding(Kind.MENDED, f"<link {name}> has no mass", "a", "r.urdf", (3,), "massless") for name in "stuvw"]
    other = Finding(Kind.MENDED, "<link x> has no shape", "a", "r.urdf", (4,), "shape")
    each = [f"r.urdf:3: <link {name}> has no mass" for name in "stuvw"]
    assert most_telling([*parts, *repairs, other]) == [
        "ignored: a, b: <x>, <y>, <z> in <sensor> of sensor 's' (r.urdf:7, 8, 9)",
        f"mended: a: {'; '.join(each[:3])}; and 2 more [massless]",
        "mended: a: r.urdf:4: <link x> has no shape [shape]",
    ]
    assert grouped([*repairs, other]) == [
        (Kind.MENDED, f"a: {'; '.join(each)} [massless]"),
        (Kind.MENDED, "a: r.urdf:4: <link x> has no shape [shape]"),
    ]
    of_another_file = replace(parts[0], what=f"<w>{common}", file="folder/q.urdf")
    elsewhere = Finding(Kind.IGNORED, "<v>", "a", "r.urdf", (2,), cause="unread")
    (line,) = most_telling([replace(item, robot="a", cause="unread") for item in (*parts, of_another_file, elsewhere)])
    assert line == (
        "ignored: a: <x>, <y>, <z>, <w> in <sensor> of sensor 's' (r.urdf:7, 8, 9; q.urdf:7); <v> (r.urdf:2)"
    )
    many = [replace(parts[0], what=f"<{number}>{common}") for number in range(9)]
    assert most_telling(many) == [
        "ignored: a: <0>, <1>, <2>, <3>, <4>, <5> and 3 more in <sensor> of sensor 's' (r.urdf:7)"
    ]


def test_of_all_findings_what_is_lost_comes_first():
    told = [*findings(1, Kind.FAILED, "node {}"), *findings(1, what="model {}", weight=Weight.LOST)]
    assert grouped(told) == [(Kind.IGNORED, "r: model 0"), (Kind.FAILED, "r: node 0")]


def test_the_same_of_several_robots_is_one_line():
    each = [Finding(Kind.IGNORED, f"<thing {number}>", robot=robot) for number in range(5) for robot in ("a", "b")]
    assert most_telling(each)[0] == "ignored: a, b: <thing 0>"
    assert len(most_telling(each)) == 5


URDF = """\
<robot name="r">
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="1 1 1" colour="red"/></geometry><material name="absent"/></visual>
    <visual><geometry><box/></geometry></visual>
    <collision><geometry><box/></geometry></collision>
    <collision><geometry><box size="1 1 1" colour="red"/></geometry></collision>
    <visual><geometry><mesh filename="absent.stl"/></geometry></visual>
    <collision><geometry><mesh filename="absent.stl"/></geometry></collision>
  </link>
  <transmission name="t"><type>x</type></transmission>
  <gazebo reference="base"><kp>1e5</kp><slip1>0.1</slip1><patch_radius>1</patch_radius>
    <collide_bitmask>2</collide_bitmask><collide_without_contact>1</collide_without_contact>
    <visual><cast_shadows>0</cast_shadows></visual></gazebo>
  <gazebo><plugin name="p" filename="libunknown.so"/></gazebo>
</robot>"""


@pytest.fixture(scope="module")
def of_urdf(tmp_path_factory):
    file = tmp_path_factory.mktemp("robot") / "r.urdf"
    file.write_text(URDF)
    return load_robot_model(str(file), PackageIndex(())).findings


@pytest.mark.parametrize(
    ("words", "weight"),
    [
        ("material 'absent' is not defined", Weight.LOOKS),
        ("a visual <box size=''> has no size", Weight.LOOKS),
        ("a collision <box size=''> has no size", Weight.MOVES),
        ("the visual mesh of link 'base' is left out", Weight.LOOKS),
        ("the collision mesh of link 'base' is left out", Weight.MOVES),
        ("<transmission>", Weight.LOOKS),
        ("<cast_shadows> in <visual>", Weight.LOOKS),
        ("kp of base: without effect", Weight.LOOKS),
        ("slip1 of base: without effect", Weight.MOVES),
        ("patch_radius of base: without effect", Weight.LOOKS),
        ("collide_bitmask, collide_without_contact of base: without effect", Weight.MOVES),
        ("Gazebo plugin p (libunknown.so)", Weight.MOVES),
    ],
)
def test_each_finding_about_a_urdf_has_its_weight(of_urdf, words, weight):
    assert [item.weight for item in of_urdf if words in item.what] == [weight]


def test_the_same_words_about_a_visual_and_a_collision_weigh_differently(of_urdf):
    about = [item for item in of_urdf if item.what == "the attribute colour of <box>"]
    assert sorted((item.weight, item.lines) for item in about) == [(Weight.LOOKS, (4,)), (Weight.MOVES, (7,))]


WORLD = """\
<sdf version="1.9"><world name="w">
  <scene><shadows>1</shadows><grid>false</grid></scene>
  <gui><camera name="c"/></gui>
  <plugin name="wind" filename="wind.so"/>
  <model name="m"><link name="l">
    <visual name="v"><geometry><mesh><uri>absent.stl</uri></mesh></geometry></visual>
    <collision name="c"><geometry><mesh><uri>absent.stl</uri></mesh></geometry></collision>
    <visual name="o"><geometry><box><size>1 1 1</size></box></geometry><odd/></visual>
    <odd/>
  </link></model>
</world></sdf>"""


def test_each_finding_about_a_world_has_its_weight(tmp_path):
    file = tmp_path / "w.sdf"
    file.write_text(WORLD)
    found = read_world(str(file), PackageIndex(())).findings
    assert sorted((item.what.partition(" with")[0], item.weight) for item in found) == [
        ("<grid> in <scene> of the world", Weight.LOOKS),
        ("<gui> of the world", Weight.LOOKS),
        ("m: <odd> is not used", Weight.LOOKS),
        ("m: <odd> is not used", Weight.MOVES),
        ("m: a collision is left out", Weight.MOVES),
        ("m: a visual is left out", Weight.LOOKS),
        ("the plugin wind of the world", Weight.MOVES),
    ]


def test_a_scenario_keeps_weights_and_one_of_an_older_version_is_read():
    findings = tuple(Finding(Kind.IGNORED, weight, weight=weight) for weight in Weight)
    scenario = Scenario(robots=(Robot("r", "/r.urdf"),), findings=findings)
    text = scenario_to_yaml(scenario)
    assert ScenarioFile(text, "s.yaml").scenario == scenario
    older = "".join(line for line in text.splitlines(keepends=True) if "weight:" not in line)
    assert older != text
    known = tuple(replace(item, weight=Weight.MOVES) for item in findings)
    assert ScenarioFile(older, "s.yaml").scenario == replace(scenario, findings=known)


def test_models_of_a_world_with_the_same_mesh_and_all_windows_are_one_line(tmp_path):
    link = "<link name='l'><collision name='c'><geometry><mesh><uri>{}.stl</uri></mesh></geometry></collision></link>"
    for name in ("desk", "lamp"):
        box = trimesh.creation.box((1, 1, 1))
        box.faces = np.vstack([box.faces, box.faces[:1, [0, 0, 1]]])  # a triangle without area
        (tmp_path / f"{name}.stl").write_bytes(trimesh.exchange.stl.export_stl(box))
    models = "".join(
        f"<model name='m{number}'><static>1</static>{link.format(mesh)}</model>\n"
        for number, mesh in enumerate(("desk", "desk", "lamp"))
    )
    (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'><gui/>\n{models}</world></sdf>")
    (tmp_path / "r.urdf").write_text("<robot name='r'><link name='world'/></robot>")
    twin = TwinBuilder(world=World(file=str(tmp_path / "w.sdf"))).robot("r", tmp_path / "r.urdf").build()
    what = "has 1 triangle without area: convex parts of it collide as solids, other faces as slabs"
    assert grouped([*twin.findings, Finding(Kind.WINDOW, "rviz2", cause="window", file="a.py", lines=(3,))]) == [
        (
            Kind.WARNING,
            f"m0, m1: collision mesh desk.stl {what} (w.sdf:2, 3); m2: collision mesh lamp.stl {what} (w.sdf:4)",
        ),
        (Kind.WINDOW, "<gui> of the world (w.sdf:1); rviz2 (a.py:3)"),
    ]
