"""A robot of a hinge that nothing drives and, after it, one of 0.5 kg·m² that has a torque; axes along gravity."""

from math import cos, sin

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.scenario import World
from drake_twin.twin.state import hash_plain, read_robot_state

LINK = (
    '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="0.5" ixy="0" ixz="0" iyz="0"/>'
    "</inertial></link>"
)
JOINT = (
    '<joint name="{0}" type="continuous"><parent link="base"/><child link="{1}"/><axis xyz="0 0 1"/>'
    '<limit effort="10" velocity="10"/></joint>'
)
ROBOT = f"""<robot name="r">{"".join(map(LINK.format, ("base", "one", "two")))}{{mount}}
{JOINT.format("loose", "one")}{JOINT.format("driven", "two")}
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="driven"><command_interface name="effort"/></joint></ros2_control></robot>"""
MOUNT = '<link name="world"/><joint name="m" type="fixed"><parent link="world"/><child link="base"/></joint>'


@pytest.fixture
def make(tmp_path):
    def make(mount=MOUNT, **options):
        (tmp_path / "r.urdf").write_text(ROBOT.format(mount=mount))
        return TwinBuilder(world=World(ground=False)).robot("r", tmp_path / "r.urdf", **options).build()

    return make


def test_each_joint_has_its_own_position_velocity_and_effort(make):
    twin = make(initial_positions={"loose": 0.7})
    twin.publish("/r/forward_effort_controller/commands", [2.0])
    twin.advance_to(0.1)
    state = twin.robot_state("r")
    assert state.joints == ("loose", "driven")
    assert state.velocities == pytest.approx((0.0, 2.0 / 0.5 * 0.1), abs=1e-9)
    assert state.positions == pytest.approx((0.7, 0.5 * 2.0 / 0.5 * 0.1**2), abs=3e-4)  # a step of 1 ms ahead
    assert state.efforts == pytest.approx((0.0, 2.0))


def test_efforts_are_zero_unless_they_are_asked_for(make):
    twin = make()
    twin.publish("/r/forward_effort_controller/commands", [2.0])
    twin.step()
    read = [
        read_robot_state(twin._session.built, twin.context, twin.built.plans[0], with_efforts=e) for e in (False, True)
    ]
    assert read[0].efforts == (0.0, 0.0)
    assert read[1].efforts == pytest.approx((0.0, 2.0))
    assert read[0].velocities == read[1].velocities != (0.0, 0.0)


def test_the_base_pose_is_a_translation_and_a_quaternion_that_begins_with_its_real_part(make):
    state = make("", xyz=(1.0, 2.0, 3.0), rpy=(0.0, 0.0, 0.8)).robot_state("r")
    assert state.base_pose == pytest.approx((1.0, 2.0, 3.0, cos(0.4), 0.0, 0.0, sin(0.4)))


def test_equal_data_has_one_hash_whatever_the_order_of_its_entries():
    data = {"a": [1.0, {"b": True, "c": None}], "d": "text"}
    assert hash_plain(data) == hash_plain({"d": "text", "a": [1.0, {"c": None, "b": True}]})
    others = (
        {"a": [1.0, {"b": True, "c": None}]},
        [data],
        data | {"d": "Text"},
        data | {"a": [np.nextafter(1.0, 2.0)]},
    )
    assert len({hash_plain(data), *map(hash_plain, others)}) == 5
