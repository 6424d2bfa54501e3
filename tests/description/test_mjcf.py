from pathlib import Path

import pytest
import trimesh

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
    twin = twin_of(tmp_path, ARM, xyz=(1, 2, 0))
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
    text = ARM.replace('<motor joint="j1"/>', '<motor joint="j1" gear="10" forcerange="-0.05 0.05"/>')
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
