"""Prefixes that no file declares: urdfdom's, sdformat's and MuJoCo's readers (tinyxml2) know no namespaces."""

import pytest
from hinge import create, launched, publisher

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.source_file import with_prefixes
from drake_twin.errors import InputError

LINK = """<link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"""
FDIR1 = '<gazebo reference="base"><fdir1 gz:expressed_in="base">1 0 0</fdir1></gazebo>'


@pytest.mark.parametrize(
    ("text", "declared"),
    [
        ('<sdf version="1.9"><a gz:expressed_in="b"/></sdf>', '<sdf xmlns:gz="gz" version="1.9">'),
        ("<robot><drake:joint/></robot>", '<robot xmlns:drake="drake">'),
        ("<robot><!-- a:b --><a b:c = 'd'/></robot>", '<robot xmlns:b="b">'),
        ('<robot xmlns:gz="http://x"><a gz:b="c"/></robot>', '<robot xmlns:gz="http://x">'),
        ('<robot><a b="package://c:d"/>e:f</robot>', "<robot>"),
        ('<?xml version="1.0"?>\n<robot\n name="r"><a xml:space="preserve"/></robot>', "<robot\n"),
        ('<robot><xacro:arg name="a"/></robot>', "<robot>"),
        ('<!-- <robot a="b"> --> <robot><a gz:b="c"/></robot>', '<robot xmlns:gz="gz"><a'),
        ('<robot xmlns:gzz="http://x"><a gz:b="c"/></robot>', '<robot xmlns:gz="gz" xmlns:gzz'),
    ],
)
def test_undeclared_prefixes_are_declared_in_the_outermost_tag(text, declared):
    assert declared in with_prefixes(text)
    assert with_prefixes(text).count("\n") == text.count("\n")


def test_a_robot_with_an_undeclared_prefix_loads(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(f'<robot name="r">{LINK}{FDIR1}</robot>')
    assert load_robot_model(str(file), PackageIndex()).description.links == ("base",)


def test_xacros_own_prefix_has_to_be_declared(tmp_path):
    file = tmp_path / "robot.urdf.xacro"
    file.write_text(f'<robot name="r">{LINK}<xacro:property name="a" value="1"/></robot>')
    with pytest.raises(InputError, match="xacro"):
        load_robot_model(str(file), PackageIndex())


@pytest.mark.parametrize("form", ["file", "topic"])
def test_a_launched_model_with_an_undeclared_prefix_is_spawned(tmp_path, form):
    """As ``<sensor type="custom" gz:type="dvl">`` of underwater vehicles."""
    inertial = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
    sensor = '<sensor name="s" type="custom" gz:type="x"/>'
    file = tmp_path / "m.sdf"
    file.write_text(f'<sdf version="1.9"><model name="m"><link name="l">{inertial}{sensor}</link></model></sdf>')
    given = ("-file", file) if form == "file" else ("-topic", "robot_description")
    launch = launched(tmp_path, publisher(file), create(*given, "-name", "r"))
    assert [robot.name for robot in launch.scenario.robots] == ["r"]
