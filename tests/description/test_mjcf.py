from pathlib import Path

import pytest
import trimesh
from bad_shapes import MESHES, write_mesh

from drake_twin import TwinBuilder
from drake_twin.description.mjcf import prepare_mjcf
from drake_twin.errors import InputError

ARM = """<mujoco model="arm"><compiler angle="degree"/><worldbody>
  <light pos="0 0 3"/><geom type="plane" size="1 1 .1"/>
  <body name="base" pos="0 0 0.5"><geom type="box" size=".1 .1 .1" mass="1"/>
    <body name="link" pos="0 0 .1"><joint name="j1" type="hinge" axis="0 1 0" range="-90 90"/>
      <geom type="capsule" fromto="0 0 0 .3 0 .5" size=".02" mass=".3"/></body></body>
</worldbody><actuator><motor joint="j1"/></actuator></mujoco>"""
BALL = """<mujoco model="ball"><worldbody><body name="b" pos="0 0 1"><freejoint/>
<geom type="sphere" size=".1" mass="2"/></body></worldbody></mujoco>"""


def twin_of(tmp_path, text, **options):
    (tmp_path / "robot.xml").write_text(text)
    return TwinBuilder().robot("r", tmp_path / "robot.xml", **options).build()


def test_a_robot_without_a_free_joint_is_fixed_where_it_is_spawned_and_driven_at_its_actuators(tmp_path):
    twin = twin_of(tmp_path, ARM.replace('<motor joint="j1"/>', '<velocity joint="j1" kv="200"/>'), xyz=(1, 2, 0))
    twin.publish("/r/forward_velocity_controller/commands", [0.5])
    twin.advance_to(1.0)
    state = twin.robot_state("r")
    assert state.joints == ("j1",)
    assert state.positions[0] == pytest.approx(0.5, abs=0.005)
    assert state.base_pose[:3] == pytest.approx((1, 2, 0))
    frames = {item.child_frame_id: item for item in twin.latest("/tf_static").transforms}
    assert frames["r/base"].transform.translation.z == pytest.approx(0.5)


def test_a_free_robot_falls_to_the_ground_of_the_twin(tmp_path):
    twin = twin_of(tmp_path, BALL, xyz=(0, 0, 0.5))
    twin.advance_to(2.0)
    assert twin.robot_state("r").base_pose[2] == pytest.approx(0.1, abs=0.002)


def test_meshes_are_found_in_the_compilers_folder_and_converted(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "assets").mkdir()
    trimesh.creation.box((0.2, 0.2, 0.2)).export(tmp_path / "assets" / "cube.stl")
    text = """<mujoco model="m"><compiler meshdir="assets"/>
    <asset><mesh name="cube" file="cube.stl"/></asset><worldbody>
    <body name="b"><freejoint/><geom type="mesh" mesh="cube" mass="1"/></body></worldbody></mujoco>"""
    twin = twin_of(tmp_path, text, xyz=(0, 0, 0.3))
    twin.advance_to(1.0)
    assert twin.robot_state("r").base_pose[2] == pytest.approx(0.1, abs=0.002)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("<mujoco/>", "an MJCF robot has a <worldbody>"),
        ("<mujoco><worldbody/></mujoco>", "it has no <body>"),
        (BALL.replace("</worldbody>", '<body name="c"/></worldbody>'), "a robot is one tree of bodies"),
    ],
)
def test_what_is_no_single_robot_is_refused(text, match):
    with pytest.raises(InputError, match=match):
        prepare_mjcf(text, Path("robot.xml"), None)


def test_an_actuator_can_do_no_more_than_its_file_says(tmp_path):
    text = ARM.replace('<motor joint="j1"/>', '<velocity joint="j1" kv="9" gear="10" forcerange="-0.05 0.05"/>')
    twin = twin_of(tmp_path, text)
    twin.publish("/r/forward_velocity_controller/commands", [0.5])
    twin.advance_to(0.5)
    assert abs(twin.robot_state("r").efforts[0]) <= 0.5 + 1e-9
    assert twin.robot_state("r").velocities[0] != pytest.approx(0.5, abs=0.01)  # gravity needs more than 0.5 N·m


def test_what_belongs_to_the_world_and_sensors_are_findings_with_their_lines(tmp_path):
    file = tmp_path / "robot.xml"
    file.write_text(
        '<mujoco model="m"><worldbody>\n<geom name="floor" type="plane" size="1 1 1"/>\n<body name="b"><freejoint/>'
        '<geom type="box" size="1 1 1"/></body></worldbody>\n<sensor><gyro site="s"/>\n<gyro site="t"/></sensor>'
        "</mujoco>"
    )
    found = [str(item) for item in prepare_mjcf(file.read_text(), file, None).findings]
    assert found == ["<geom> of the world (robot.xml:2)", "<gyro> of <sensor> (robot.xml:4, 5)"]


def test_what_drakes_parser_leaves_out_in_silence_is_a_finding(tmp_path):
    file = tmp_path / "robot.xml"
    file.write_text(
        '<mujoco model="m"><asset>\n<model name="x" file="x.xml"/></asset><worldbody><body name="b"><freejoint/>'
        '<geom type="box" size="1 1 1"/>\n<replicate count="3"><geom size="1"/></replicate></body></worldbody></mujoco>'
    )
    found = [str(item) for item in prepare_mjcf(file.read_text(), file, None).findings]
    assert found == ["<replicate> (robot.xml:3)", "<model> (robot.xml:2)"]


def test_a_motor_without_commands_is_limp(tmp_path):
    twin = twin_of(tmp_path, ARM)
    twin.advance_to(1.0)
    assert twin.robot_state("r").positions[0] > 0.5  # the arm falls to its heavier side


@pytest.mark.parametrize(
    ("actuator", "message"),
    [
        ('<motor joint="j9"/>', "joint is 'j9', which is not a hinge or slide of the robot; it has: j1"),
        ('<position joint="j1" kp="-3"/>', "kp is -3, and it cannot be negative"),
        ('<velocity joint="j1" kv="-1"/>', "kv is -1, and it cannot be negative"),
        ('<position joint="j1" kp="much"/>', "kp is 'much'"),
        ('<motor joint="j1" gear="x"/>', "gear is 'x'"),
        ('<motor joint="j1" ctrlrange="2 1"/>', "the first must be less than the second"),
        ('<motor joint="j1" forcerange="1"/>', "forcerange is '1'"),
    ],
)
def test_an_actuator_that_cannot_be_is_refused_with_its_line(actuator, message):
    with pytest.raises(InputError) as caught:
        prepare_mjcf(ARM.replace('<motor joint="j1"/>', actuator), Path("robot.xml"), None)
    assert message in str(caught.value)
    assert "robot.xml:6" in str(caught.value)


@pytest.mark.parametrize(
    ("actuator", "finding"),
    [
        ('<muscle joint="j1"/>', "<muscle> of <actuator>"),
        ('<motor tendon="t"/>', "<motor> that drives a tendon"),
        ('<motor joint="j1"/><velocity joint="j1"/>', "second actuator of a joint"),
        ('<position joint="j1" dampratio="1"/>', "dampratio of <position>"),
        ('<position joint="j1" forcerange="-1 2"/>', "difference of the two ends of forcerange of <position>"),
        ('<general joint="j1" dyntype="filter"/>', "<general> with activation dynamics"),
        ('<motor joint="j1" gear="0"/>', "<motor> without an effect: its gain or gear is 0"),
        ('<general joint="j1" biastype="affine" biasprm="0 0 -3"/>', "<general> whose bias is neither"),
    ],
)
def test_what_an_actuator_cannot_have_is_a_finding_with_its_line(actuator, finding):
    prepared = prepare_mjcf(ARM.replace('<motor joint="j1"/>', actuator), Path("robot.xml"), None)
    assert any(str(item).startswith(finding) and "robot.xml:6" in str(item) for item in prepared.findings)


def test_values_come_from_the_default_classes_as_in_mujoco():
    mujoco = pytest.importorskip("mujoco")
    text = ARM.replace(
        "<worldbody>",
        '<default><position kp="7"/><joint armature="0.2"/><default class="a"><motor forcerange="-4 4"/>'
        '<joint frictionloss="0.3"/><default class="b"><position kv="3" gear="2"/><joint stiffness="5" springref="90"/>'
        "</default></default></default><worldbody>",
    ).replace('name="link" pos', 'name="link" childclass="b" pos')
    text = text.replace('<motor joint="j1"/>', '<position class="b" joint="j1"/>')
    model = mujoco.MjModel.from_xml_string(text)
    actuators = prepare_mjcf(text, Path("robot.xml"), None).actuators
    joint, gear = actuators.joints["j1"], model.actuator_gear[0, 0]
    (controlled,) = actuators.systems[0].joints
    assert float(controlled.parameters["kp"]) == pytest.approx(gear**2 * model.actuator_gainprm[0, 0])
    assert float(controlled.parameters["kv"]) == pytest.approx(-(gear**2) * model.actuator_biasprm[0, 2])
    assert actuators.efforts["j1"] == pytest.approx(gear * model.actuator_forcerange[0, 1])
    assert (joint.armature, joint.friction) == pytest.approx((model.dof_armature[0], model.dof_frictionloss[0]))
    assert (joint.stiffness, joint.rest) == pytest.approx((model.jnt_stiffness[0], model.qpos_spring[0]))


@pytest.mark.parametrize(
    ("joint", "what"),
    [
        ('<joint frictionloss="2"/>', "frictionloss of a <joint> without a name"),
        ('<joint axis="0 1 0" stiffness="3"/>', "stiffness of a <joint> without a name"),
        ('<joint name="b" type="ball" stiffness="3"/>', "stiffness of a ball <joint>"),
    ],
)
def test_what_is_lost_of_a_joint_is_said(tmp_path, joint, what):
    text = f'<mujoco><worldbody><body name="a">{joint}<geom size=".1" mass="1"/></body></worldbody></mujoco>'
    (finding,) = prepare_mjcf(text, tmp_path / "robot.xml", None).findings
    assert (finding.what, finding.lines) == (what, (1,))


def robot_of(name: str, folder: Path) -> Path:
    """An MJCF robot that is one of the bad meshes."""
    write_mesh(MESHES[name], folder / "m.binary.stl")
    file = folder / "thing.xml"
    file.write_text("""<mujoco model="thing"><asset><mesh name="m" file="m.binary.stl"/></asset><worldbody>
<body name="body"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia=".01 .01 .01"/>
<geom type="mesh" mesh="m"/></body></worldbody></mujoco>""")
    return file


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("sound", None),
        ("open", None),
        ("inside out", "triangles that face inwards: where it collides, its convex hull does"),
        ("flat", "all corners in one plane: where it collides, its convex hull does, a thousandth of its size thick"),
        ("line", "all corners on one line: where it collides, its convex hull does, a thousandth of its size thick"),
        ("infinite", "1 triangle with corners that are not finite numbers: where it collides, its convex hull does"),
    ],
)
def test_a_bad_mesh_is_a_finding_and_the_robot_runs(tmp_path, monkeypatch, name, what):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    twin = TwinBuilder().robot("thing", robot_of(name, tmp_path), xyz=(0, 0, 1)).build()
    twin.advance_to(0.01)
    expected = () if what is None else (f"thing: mesh m.binary.stl has {what} (thing.xml:1)",)
    assert tuple(warning for warning in twin.findings.warnings if "point: Drake" not in warning) == expected


def test_a_mesh_that_is_a_point_is_refused(tmp_path):
    file = robot_of("point", tmp_path)
    with pytest.raises(InputError, match=r"m\.binary\.stl: all corners of the mesh are in one point\.$"):
        TwinBuilder().robot("thing", file).build()
