"""Prefixes that no file declares: urdfdom's, sdformat's and MuJoCo's readers (tinyxml2) know no namespaces."""

import pytest

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
