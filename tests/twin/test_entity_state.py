"""Entities: where they are, put elsewhere, pushed."""

import numpy as np
import pytest
from conftest import ARM, rovers
from scipy.spatial.transform import Rotation

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import World

BOX = """<robot name="box"><link name="base"><inertial><mass value="2"/>
  <inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="flag"/><joint name="pole" type="fixed"><parent link="base"/><child link="flag"/>
  <origin xyz="0 0 1"/></joint></robot>"""


@pytest.fixture
def boxes(tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    builder = TwinBuilder(world=World(gravity=(0, 0, 0), ground=False))
    for index in range(2):
        builder.robot(f"box_{index + 1}", tmp_path / "box.urdf", xyz=(0, 3 * index, 5))
    return builder.build()


def turned(axis, angle):
    x, y, z, w = Rotation.from_rotvec(np.array(axis) * angle).as_quat()
    return (w, x, y, z)


def test_a_force_for_a_second_gives_the_velocity_that_newton_says_and_nothing_to_the_other(boxes):
    boxes.entities.apply_wrench("box_1", force=(4, 0, 0), torque=(0, 0, 0.5), duration=1.0)
    boxes.advance_to(0.5)
    assert boxes.entities.state("box_1").linear == pytest.approx((1, 0, 0), abs=1e-9)
    boxes.advance_to(2.0)
    state = boxes.entities.state("box_1")
    assert state.linear == pytest.approx((2, 0, 0), abs=1e-9)
    assert state.angular == pytest.approx((0, 0, 1), abs=1e-9)
    assert boxes.entities.state("box_2").position == (0, 3, 5)


def test_two_wrenches_add_up_and_one_may_be_in_the_axes_of_an_entity(boxes):
    boxes.entities.set_state("box_2", orientation=turned((0, 0, 1), np.pi / 2))
    boxes.entities.apply_wrench("box_1", force=(2, 0, 0), duration=1.0, reference="box_2")
    boxes.entities.apply_wrench("box_1", force=(0, 0, 2), duration=0.5)
    boxes.advance_to(1.0)
    assert boxes.entities.state("box_1").linear == pytest.approx((0, 1, 0.5), abs=1e-9)


def test_a_pose_and_a_twist_are_set_in_the_world_and_in_another_entitys_frame(boxes):
    boxes.entities.set_state("box_1", (1, 2, 3), turned((0, 0, 1), np.pi / 2), (0.1, 0, 0), (0, 0, 0.2))
    state = boxes.entities.state("box_1")
    assert (*state.position, *state.linear, *state.angular) == pytest.approx((1, 2, 3, 0.1, 0, 0, 0, 0, 0.2))
    boxes.entities.set_state("box_2", position=(1, 0, 0), linear=(0, 0, 0), angular=(0, 0, 0), reference="box_1")
    other = boxes.entities.state("box_2")
    assert other.position == pytest.approx((1, 3, 3))  # one ahead of the other, which looks along y
    assert other.linear == pytest.approx((0.1 - 0.2 * 1.0, 0, 0))  # carried by its turning
    assert boxes.entities.state("box_2", "box_1").linear == pytest.approx((0, 0, 0), abs=1e-12)


def test_a_links_state_is_its_own_and_relative_ones_agree_with_tf():
    twin = TwinBuilder().robot("arm", ARM).build()
    twin.entities.set_joint_positions("arm", {"joint_1": 0.4, "joint_2": -0.3, "joint_3": 0.7})
    link = twin.built.plans[0].description.joints_by_name["joint_3"].child
    parent = twin.built.plans[0].description.joints_by_name["joint_3"].parent
    (transform,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id == f"arm/{link}"]
    state = twin.entities.state(f"arm::{link}", f"arm::{parent}")
    place, turn = transform.transform.translation, transform.transform.rotation
    assert state.position == pytest.approx((place.x, place.y, place.z), abs=1e-12)
    assert state.orientation == pytest.approx((turn.w, turn.x, turn.y, turn.z), abs=1e-12)


def test_joints_that_mimic_one_that_is_set_follow_it_at_once():
    twin = TwinBuilder().robot("arm", ARM).build()
    twin.entities.set_joint_positions("arm", {"joint_4": 0.3})
    assert twin.robot_state("arm").positions == pytest.approx((0, 0, 0, 0.3, -0.3))
    twin.entities.set_joint_positions("arm", {"joint_4": 0.2, "joint_5": 0.1})  # where it is named it is set, too
    assert twin.robot_state("arm").positions == pytest.approx((0, 0, 0, 0.2, 0.1))


def test_model_and_link_states_are_topics(boxes):
    boxes.entities.set_state("box_2", (7, 8, 9), linear=(1, 0, 0))
    models, links = boxes.latest("/model_states"), boxes.latest("/link_states")
    assert models.name == ["box_1", "box_2"]
    assert (models.pose[1].position.x, models.twist[1].linear.x) == pytest.approx((7, 1))
    assert links.name == ["box_1::base", "box_1::flag", "box_2::base", "box_2::flag"]
    assert links.pose[3].position.z == pytest.approx(10)


def test_a_rover_is_put_elsewhere_and_drives_on():
    twin = rovers(1).build()
    twin.publish("/robot_1/forward_velocity_controller/commands", [2, 2, 2, 2])
    twin.advance_to(1.0)
    x, _, z = twin.entities.state("robot_1").position
    twin.entities.set_state("robot_1", (10, 5, z))
    twin.advance_to(2.0)
    assert twin.entities.state("robot_1").position == pytest.approx((10 + x, 5, z), abs=0.03)


def test_wrenches_are_in_a_snapshot_and_end_with_a_reset(boxes):
    boxes.entities.apply_wrench("box_1::base", force=(4, 0, 0), duration=1.0)
    boxes.advance_to(0.3)
    snapshot = boxes.snapshot()
    boxes.advance_to(2.0)
    first = boxes.state_sha256()
    boxes.restore(snapshot)
    boxes.advance_to(2.0)
    assert boxes.state_sha256() == first
    boxes.restore(snapshot)
    boxes.reset()
    boxes.advance_to(1.0)
    assert boxes.entities.state("box_1").linear == (0, 0, 0)


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda twin: twin.entities.state("box_9"), r"Entity \[box_9\] does not exist\..*box_1"),
        (lambda twin: twin.entities.state("box_1::nose"), "robot 'box_1' has no link 'nose'.*base, flag"),
        (lambda twin: twin.entities.set_state("box_1", (1, 2)), "3 finite numbers"),
        (lambda twin: twin.entities.set_state("box_1", orientation=(0, 0, 0, 0)), "which is not a rotation"),
        (lambda twin: twin.entities.set_state("box_1::flag", (1, 2, 3)), "cannot be moved"),
        (lambda twin: twin.entities.apply_wrench("box_1", "up"), "is not a list of numbers"),
        (lambda twin: twin.entities.apply_wrench("box_1", (1, 0, float("nan"))), "3 finite numbers"),
        (lambda twin: twin.entities.apply_wrench("box_1", duration=-1), "invalid duration"),
    ],
)
def test_what_cannot_be_is_said(boxes, call, reason):
    before = boxes.state_sha256()
    with pytest.raises(InputError, match=reason):
        call(boxes)
    assert boxes.state_sha256() == before


@pytest.mark.parametrize("value", [[10**400, 0, 0], "abc", [[1, 2, 3]], None])
def test_forces_that_are_no_numbers_are_refused(value):
    with pytest.raises(InputError, match=r"the force .* is not"):
        rovers(1).build().entities.apply_wrench("robot_1", force=value)


def test_a_quaternion_of_huge_numbers_is_one():
    twin = rovers(1).build()
    twin.entities.set_state("robot_1", orientation=[1e200, 0, 0, 1e200])
    assert twin.entities.state("robot_1").orientation == pytest.approx((0.5**0.5, 0, 0, 0.5**0.5))
