"""Contact sensors and bumpers against the weight that they bear."""

import numpy as np
import pytest
from rig import START_HEIGHT, on_box, twin_with, xyz

G = 9.81


def contact(name="box_collision", more=""):
    return on_box("contact", f"<contact><collision>{name}</collision></contact>{more}")


@pytest.mark.parametrize("style", ["faces", "point"])
def test_the_forces_on_a_resting_box_sum_to_its_weight(tmp_path, style):
    twin = twin_with(tmp_path, contact(), contact=style.replace("faces", "hydroelastic"))
    twin.advance_to(2.0)
    message = twin.latest("/box/s/contact")
    assert {item.collision1.name for item in message.contacts} == {"box::box::box_collision"}
    forces = [wrench.body_1_wrench.force for item in message.contacts for wrench in item.wrenches]
    assert np.sum([xyz(force) for force in forces], axis=0) == pytest.approx([0, 0, 2 * G], abs=2 * G * 1e-3)
    against = [xyz(wrench.body_2_wrench.force) for item in message.contacts for wrench in item.wrenches]
    assert np.sum(against, axis=0) == pytest.approx([0, 0, -2 * G], abs=2 * G * 1e-3)
    normals = [xyz(normal) for item in message.contacts for normal in item.normals]
    assert normals == pytest.approx(np.array([[0, 0, 1]] * len(normals)), abs=1e-6)
    depths = [depth for item in message.contacts for depth in item.depths]
    sunk = START_HEIGHT - twin.entities.state("box").position[2]
    assert max(depths) == pytest.approx(sunk, rel=0.02)
    positions = [position.z for item in message.contacts for position in item.positions]
    assert max(map(abs, positions)) < 1e-3


def test_gazebo_publishes_no_contact_while_nothing_touches_and_classic_an_empty_one(tmp_path):
    twin = twin_with(tmp_path, contact(), xyz=(0, 0, 50))
    assert twin.latest("/box/s/contact") is None
    bumper = '<update_rate>10</update_rate><plugin name="b" filename="libgazebo_ros_bumper.so"/>'
    twin = twin_with(tmp_path, contact(more=bumper), xyz=(0, 0, 50))
    state = twin.latest("/box/bumper_states")
    assert (state.states, state.header.frame_id) == ([], "world")


def test_a_bumper_sums_the_forces_of_each_pair(tmp_path):
    bumper = '<plugin name="b" filename="libgazebo_ros_bumper.so"/>'
    twin = twin_with(tmp_path, contact(more=bumper))
    twin.advance_to(2.0)
    (state,) = twin.latest("/box/bumper_states").states
    assert state.collision1_name == "box::box::box_collision"
    assert xyz(state.total_wrench.force) == pytest.approx([0, 0, 2 * G], abs=2 * G * 1e-3)
    assert np.sum([xyz(item.force) for item in state.wrenches], axis=0) == pytest.approx(xyz(state.total_wrench.force))
    assert len(state.wrenches) == len(state.contact_positions) == len(state.contact_normals) == len(state.depths)


FOLDED = """<robot name="box"><link name="box"><inertial><mass value="2"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 1"/><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <link name="skid"><collision name="shoe"><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <joint name="j" type="fixed"><parent link="box"/><child link="skid"/></joint>{}</robot>"""


@pytest.mark.parametrize(
    ("name", "heard"),
    [
        ("box_fixed_joint_lump__shoe_collision_1", True),
        ("box_fixed_joint_lump__shoe_collision", True),
        ("shoe_collision_1", True),
        ("shoe_collision", True),
        ("shoe", True),
        ("box_collision", False),
    ],
)
def test_a_shape_of_a_folded_link_has_the_name_that_gazebo_gives_it(tmp_path, name, heard):
    twin = twin_with(tmp_path, contact(name), body=FOLDED)
    twin.advance_to(0.5)
    message = twin.latest("/box/s/contact")
    assert (message is not None) == heard
    if heard:
        assert message.contacts[0].collision1.name == "box::box::box_fixed_joint_lump__shoe_collision_1"


def test_a_shape_with_a_name_of_its_own_is_found_by_both_names(tmp_path):
    """Gazebo's reader takes each name that does not begin with the link's for that of a folded link's shape."""
    body = FOLDED.replace('<collision><origin xyz="0 0 1"/>', '<collision name="roof"><origin xyz="0 0 1"/>')
    for name in ("box_fixed_joint_lump__roof_collision", "roof_collision", "roof"):
        assert not any(
            "collision shape" in text for text in twin_with(tmp_path, contact(name), body=body).findings.warnings
        )


def test_a_shape_that_the_link_lacks_is_a_warning_with_those_that_it_has(tmp_path):
    (warning,) = [
        text for text in twin_with(tmp_path, contact("roof"), body=FOLDED).findings.warnings if "roof" in text
    ]
    assert "it has box_collision, box_fixed_joint_lump__shoe_collision_1" in warning
