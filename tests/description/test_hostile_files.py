"""Files that would end the program, hold it up, or fill the memory: one sentence each, or they simply work."""

import json
import os

import pytest
from lxml import etree

from drake_twin import TwinBuilder, World
from drake_twin.description import xacro_expressions
from drake_twin.description.sdf_shapes import plane_normal, turned_to
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.twin.snapshot import Snapshot

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def built(file):
    twin = TwinBuilder().robot("r", file).build()
    twin.step()
    return twin


def meshed(folder, name):
    geometry = f'<geometry><mesh filename="{folder / name}"/></geometry>'
    file = folder / "robot.urdf"
    file.write_text(
        f'<robot name="r"><link name="a">{INERTIAL}<visual>{geometry}</visual><collision>{geometry}</collision></link>'
        "</robot>"
    )
    return file


@pytest.mark.parametrize("encoding", ["UTF-16", "ISO-8859-1", "UTF-8", "windows-1252"])
@pytest.mark.parametrize("suffix", ["urdf", "sdf"])
def test_xml_in_any_encoding_is_read(tmp_path, encoding, suffix):
    root = f'<robot name="é"><link name="a">{INERTIAL}</link></robot>'
    if suffix == "sdf":
        root = '<sdf version="1.7"><model name="é"><link name="a"/></model></sdf>'
    file = tmp_path / f"robot.{suffix}"
    file.write_bytes(f'<?xml version="1.0" encoding="{encoding}"?>{root}'.encode(encoding))
    assert built(file).built.plans[0].description.name == "é"


def test_xacro_reads_utf_8_as_in_ros(tmp_path):
    text = f'<?xml version="1.0" encoding="ISO-8859-1"?><robot name="é" {XACRO}><link name="a"/></robot>'
    (tmp_path / "r.xacro").write_bytes(text.encode("ISO-8859-1"))
    with pytest.raises(InputError, match="'utf-8' codec can't decode"):
        built(tmp_path / "r.xacro")


def test_an_encoding_that_is_none_is_said(tmp_path):
    (tmp_path / "robot.urdf").write_bytes(b'<?xml version="1.0" encoding="UTF-99"?><robot name="r"/>')
    with pytest.raises(InputError, match="the robot file is not UTF-99 text"):
        built(tmp_path / "robot.urdf")


@pytest.mark.parametrize("name", ["zero.obj", "zero.stl", "zero.dae", "pipe.obj", "pipe.stl"])
def test_a_mesh_that_is_a_device_or_a_pipe_is_left_out(tmp_path, name):
    if name.startswith("zero"):
        (tmp_path / name).symlink_to("/dev/zero")
    else:
        os.mkfifo(tmp_path / name)
    twin = built(meshed(tmp_path, name))
    said = [finding.what for finding in twin.findings if finding.kind is Kind.MENDED]
    assert len(said) == 2
    assert all("a device or a pipe" in text for text in said)


def test_a_scenario_a_parameters_file_and_a_state_that_are_devices_are_refused(tmp_path):
    (tmp_path / "endless").symlink_to("/dev/zero")
    (tmp_path / "robot.urdf").write_text(f'<robot name="r"><link name="a">{INERTIAL}</link></robot>')
    builder = TwinBuilder().robot("r", tmp_path / "robot.urdf", controllers=[tmp_path / "endless"])
    for read in (
        builder.build,
        lambda: ScenarioFile.read(tmp_path / "endless"),
        lambda: Snapshot.load(tmp_path / "endless"),
    ):
        with pytest.raises(InputError, match="a device or a pipe"):
            read()


def test_a_mesh_that_counts_further_than_it_goes_is_left_out(tmp_path):
    accessors = [
        {
            "bufferView": 0,
            "componentType": 5126,
            "count": 4_000_000_000,
            "type": "VEC3",
            "min": [0] * 3,
            "max": [1] * 3,
        },
        {"bufferView": 0, "componentType": 5125, "count": 4_000_000_000, "type": "SCALAR"},
    ]
    mesh = {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}
    data = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [mesh],
        "accessors": accessors,
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAA"}],
    }
    (tmp_path / "m.gltf").write_text(json.dumps(data))
    twin = built(meshed(tmp_path, "m.gltf"))
    assert [finding for finding in twin.findings if finding.kind is Kind.MENDED]


def test_an_mjcf_file_that_includes_itself_is_refused(tmp_path):
    body = '<worldbody><body name="b"><freejoint/><geom type="box" size="1 1 1"/></body></worldbody>'
    (tmp_path / "a.xml").write_text(f'<mujoco model="m"><include file="b.xml"/>{body}</mujoco>')
    (tmp_path / "b.xml").write_text('<mujoco><include file="a.xml"/></mujoco>')
    with pytest.raises(InputError, match=r"includes itself: a\.xml → b\.xml → a\.xml"):
        built(tmp_path / "a.xml")


@pytest.mark.parametrize("bounds", ["", "1", "1 2 3"])
def test_an_mjcf_actuator_with_no_range_is_refused(tmp_path, bounds):
    body = '<worldbody><body name="b"><joint name="j" type="hinge"/><geom type="box" size="1 1 1"/></body></worldbody>'
    motor = f'<actuator><motor joint="j" forcerange=" {bounds}"/></actuator>'
    (tmp_path / "a.xml").write_text(f'<mujoco model="m">{body}{motor}</mujoco>')
    with pytest.raises(InputError, match="where two numbers are needed"):
        built(tmp_path / "a.xml")


@pytest.mark.parametrize("scheme", ["", "model://", "file://"])
def test_a_mesh_whose_name_no_file_can_have_is_a_missing_one(tmp_path, scheme):
    mesh = f"<geometry><mesh><uri>{scheme}{'a' * 300}.stl</uri></mesh></geometry>"
    link = f'<link name="a"><visual name="v">{mesh}</visual></link>'
    (tmp_path / "a.sdf").write_text(f'<sdf version="1.9"><model name="m">{link}</model></sdf>')
    assert any("aaaa" in str(finding) for finding in built(tmp_path / "a.sdf").findings)


def test_a_file_whose_name_no_file_can_have_does_not_exist(tmp_path):
    name = "a" * 300
    (tmp_path / "a.xml").write_text(f'<mujoco model="m"><include file="{name}.xml"/></mujoco>')
    (tmp_path / "a.urdf").write_text(f'<robot name="r"><link name="a">{INERTIAL}</link></robot>')
    for twin in (
        TwinBuilder().robot("r", tmp_path / "a.xml"),
        TwinBuilder(world=World(file=name)).robot("r", tmp_path / "a.urdf"),
    ):
        with pytest.raises(InputError, match="aaaa"):
            twin.build()


def test_a_plane_that_faces_absurdly_far_has_a_direction():
    plane = etree.fromstring("<plane><normal>0 1e308 1e308</normal></plane>")
    assert turned_to(plane_normal(plane))[:, 2] == pytest.approx([0, 0.5**0.5, 0.5**0.5])


def test_a_version_of_sdf_that_nobody_counts_to_is_refused(tmp_path):
    version = "9" * 4000
    (tmp_path / "a.sdf").write_text(f'<sdf version="{version}"><model name="m"><link name="a"/></model></sdf>')
    with pytest.raises(InputError):
        built(tmp_path / "a.sdf")


@pytest.mark.parametrize(
    "expression", ["9**9**9", "1 &lt;&lt; 10**12", "'a' * 10**12", "[0] * 10**12", "[x**9**9 for x in [9]][0]"]
)
def test_an_expression_without_end_is_refused(tmp_path, expression):
    (tmp_path / "r.xacro").write_text(f'<robot name="r" {XACRO}><link name="a${{{expression}}}"/></robot>')
    with pytest.raises(InputError, match=r"too many|too many digits"):
        built(tmp_path / "r.xacro")


def test_expressions_keep_their_meaning(tmp_path):
    text = f"""<robot name="r" {XACRO}><xacro:property name="n" value="3"/>
      <link name="a${{n**2}}_${{1&lt;&lt;n}}_${{2*n}}_${{'ab'*n}}_${{[i*n for i in [1, 2]]}}_${{2.0**0.5}}"/></robot>"""
    (tmp_path / "r.xacro").write_text(text)
    (link,) = built(tmp_path / "r.xacro").built.plans[0].description.links
    assert link == f"a9_8_6_ababab_[3, 6]_{2.0**0.5}"


def test_macros_without_end_are_refused_after_a_while(tmp_path, monkeypatch):
    monkeypatch.setattr(xacro_expressions, "_LONGEST", 0.2)
    twice = '<xacro:twice n="${n - 1}"/>'
    text = f"""<robot name="r" {XACRO}><xacro:macro name="twice" params="n"><xacro:if value="${{n > 0}}">
      {twice}{twice}</xacro:if></xacro:macro><xacro:twice n="30"/></robot>"""
    (tmp_path / "r.xacro").write_text(text)
    with pytest.raises(InputError, match=r"take longer than 0\.2 s"):
        built(tmp_path / "r.xacro")


def test_macros_of_too_many_expressions_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(xacro_expressions, "_MOST_EVALUATED", 1_000)
    twice = '<xacro:twice n="${n - 1}"/>'
    text = f"""<robot name="r" {XACRO}><xacro:macro name="twice" params="n"><xacro:if value="${{n > 0}}">
      {twice}{twice}</xacro:if></xacro:macro><xacro:twice n="30"/></robot>"""
    (tmp_path / "r.xacro").write_text(text)
    with pytest.raises(InputError, match="its macros evaluate more than 1,000 expressions") as refusal:
        built(tmp_path / "r.xacro")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("joint", ["continuous", "fixed"])
@pytest.mark.parametrize(("count", "is_refused"), [(1001, True), (1000, False)])
def test_a_chain_without_end_is_refused(tmp_path, joint, count, is_refused):
    links = "".join(f'<link name="l{number}">{INERTIAL}</link>' for number in range(count))
    joints = "".join(
        f'<joint name="j{number}" type="{joint}"><parent link="l{number - 1}"/><child link="l{number}"/></joint>'
        for number in range(1, count)
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    if not is_refused:
        TwinBuilder().robot("r", tmp_path / "r.urdf").build()
        return
    with pytest.raises(InputError, match="the robot has 1,001 links, and 1,000 are the most"):
        TwinBuilder().robot("r", tmp_path / "r.urdf").build()


def test_a_joint_may_have_a_slash_in_its_name(tmp_path):
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r"><link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link><joint name="robot1/wheel"'
        ' type="continuous"><parent link="a"/><child link="b"/></joint><ros2_control name="s" type="system">'
        '<joint name="robot1/wheel"><command_interface name="velocity"/><state_interface name="velocity"/></joint>'
        "</ros2_control></robot>"
    )
    (tmp_path / "c.yaml").write_text(
        "controller_manager:\n  ros__parameters:\n    c:\n"
        "      type: forward_command_controller/ForwardCommandController\n"
        "c:\n  ros__parameters:\n    joints: [robot1/wheel]\n    interface_name: velocity\n"
    )
    twin = TwinBuilder().robot("r", tmp_path / "r.urdf", controllers=[tmp_path / "c.yaml"]).build()
    twin.publish("/r/c/commands", [2.0])
    twin.advance_to(1.0)
    assert twin.robot_state("r").velocities == pytest.approx((2.0,), abs=1e-3)


def test_a_zero_byte_is_one_line(tmp_path):
    (tmp_path / "r.urdf").write_bytes(b'<robot name="r"><link name="a"/>\0</robot>')
    with pytest.raises(InputError, match=r"not well-formed XML: .*0x0") as refusal:
        built(tmp_path / "r.urdf")
    assert "\n" not in str(refusal.value)


def test_a_loose_box_that_is_as_thin_as_nothing_stands_or_is_refused(tmp_path):
    """Drake 1.58 computes its pressure, and older ones do not."""
    shape = "<collision><geometry><box size='1e-300 0.5 0.7'/></geometry></collision>"
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="a">{INERTIAL}{shape}</link></robot>')
    refusal = "non-positive volume"
    try:
        built(tmp_path / "r.urdf")
    except InputError as error:
        refusal = str(error)
    assert "non-positive volume" in refusal


def test_a_link_of_sdf_too_far_away_is_refused(tmp_path):
    pose = '<pose relative_to="__model__">0.6 -0.6 -1e308 0.8 -0.1 0.1</pose>'
    inertia = "<mass>1.6</mass><inertia><ixx>0.04</ixx><iyy>0.03</iyy><izz>0.02</izz></inertia>"
    link = f'<link name="l">{pose}<inertial>{inertia}</inertial></link>'
    (tmp_path / "r.sdf").write_text(f'<sdf version="1.9"><model name="m">{link}</model></sdf>')
    with pytest.raises(InputError, match="the inertia of r::l is not finite"):
        built(tmp_path / "r.sdf")
