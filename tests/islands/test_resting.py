"""What is still is not stepped, and nobody sees a difference."""

from math import atan, cos, sin

import numpy as np
import pytest
from crates import archipelago, crates, drive, groups, model, pose, resting, state, with_rovers

FRICTION = 0.5


def slope(folder, tilt, islands=1):
    """A crate on a slope, at an angle (rad)."""
    up = np.array([sin(tilt), 0.0, cos(tilt)])
    ramp = model("ramp", -0.05 * up, (0, tilt, 0), size=(40, 4, 0.1), mass=0, mu=FRICTION)
    crate = model("crate", 0.1 * up, (0, tilt, 0), size=(0.4, 0.4, 0.2), mu=FRICTION)
    return crates(folder, ramp, crate, ground=False, islands=islands, threads=1).build()


def test_a_crate_on_a_slope_of_much_less_than_its_friction_rests(tmp_path):
    """What sticks creeps at v = 1e-5 m/s · r / √(1 - r²), with r the part of its friction that it needs."""
    twin = slope(tmp_path, atan(0.6 * FRICTION))
    start = pose(twin, "crate")
    twin.advance_to(2.0)
    assert resting(twin) == {"crate"}
    assert groups(twin) == []
    before = pose(twin, "crate")
    twin.advance_to(20.0)
    assert (pose(twin, "crate") == before).all()
    assert before[:3] == pytest.approx(start[:3], abs=2e-3)


def test_a_crate_on_a_slope_of_little_less_than_its_friction_creeps_as_in_one_plant(tmp_path):
    twins = [slope(tmp_path, atan(0.95 * FRICTION), islands) for islands in (1, 0)]
    for twin in twins:
        twin.advance_to(2.0)
    assert resting(twins[0]) == set()
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-9)


@pytest.mark.parametrize("more", [0.003, 0.03])
def test_a_crate_on_a_slope_of_more_than_its_friction_slides_on(tmp_path, more):
    twins = [slope(tmp_path, atan(FRICTION) + more, islands) for islands in (1, 0)]
    for _ in range(8):
        for twin in twins:
            twin.advance_to(twin.time + 0.25)
        assert resting(twins[0]) == set()
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-6)
    assert np.linalg.norm(twins[0].entities.state("crate").linear) > 0.01


def test_all_that_is_at_rest_stops_after_half_a_second_of_stillness(tmp_path):
    twin = with_rovers(crates(tmp_path, model("crate", (0, 0, 0.2)), islands=1, threads=1), (3, 0, 0)).build()
    twin.advance_to(0.46)
    assert resting(twin) == set()
    twin.advance_to(2.0)
    assert resting(twin) == {"r0", "crate"}
    assert (state(twin)[twin.plant.num_positions() :] == 0).all()
    still = state(twin)
    twin.advance_to(5.0)
    assert (state(twin) == still).all()


def test_what_hangs_in_the_air_falls_and_what_floats_rests(tmp_path):
    falling = crates(tmp_path, model("crate", (0, 0, 50)), islands=1, threads=1).build()
    falling.advance_to(1.0)
    assert falling.entities.state("crate").linear[2] == pytest.approx(-9.81, rel=1e-3)
    floating = crates(tmp_path, model("crate", (0, 0, 50)), gravity=0, islands=1, threads=1).build()
    floating.advance_to(1.0)
    assert resting(floating) == {"crate"}


def test_a_stack_wakes_when_its_lowest_is_pushed_and_moves_as_in_one_plant(tmp_path):
    stack = [model(f"s{index}", (0, 0, 0.2 + 0.4 * index)) for index in range(3)]
    twins = [crates(tmp_path, *stack, islands=count, threads=1).build() for count in (1, 0)]
    for twin in twins:
        twin.advance_to(2.0)
    assert resting(twins[0]) == {"s0", "s1", "s2"}
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-5)
    for twin in twins:
        twin.entities.apply_wrench("s0", force=(120, 0, 0), duration=0.2)
        twin.step()
    assert groups(twins[0]) == [("s0", "s1", "s2")]
    for _ in range(10):
        for twin in twins:
            twin.advance_to(twin.time + 0.1)
        for name in ("s0", "s1", "s2"):
            assert pose(twins[0], name) == pytest.approx(pose(twins[1], name), abs=1e-3)
    assert pose(twins[0], "s0")[0] > 0.3


def test_a_stack_falls_when_its_lowest_is_taken_away(tmp_path):
    stack = [model(f"s{index}", (0, 0, 0.2 + 0.4 * index)) for index in range(3)]
    twin = crates(tmp_path, *stack, islands=1, threads=1).build()
    twin.advance_to(2.0)
    twin.entities.set_state("s0", position=(5, 0, 0.2))
    twin.advance_to(4.0)
    assert pose(twin, "s1")[2] == pytest.approx(0.2, abs=0.01)
    assert pose(twin, "s2")[2] == pytest.approx(0.6, abs=0.01)


def test_a_resting_rover_answers_a_command_as_one_that_is_awake(tmp_path):
    """The one that is awake is alike, and was lightly touched before."""
    sleepy, awake = (with_rovers(crates(tmp_path, islands=1, threads=1), (0, 0, 0)).build() for _ in range(2))
    sleepy.advance_to(2.0)
    awake.advance_to(1.7)
    awake.entities.apply_wrench("r0", force=(1e-9, 0, 0), duration=0.1)
    awake.advance_to(2.0)
    assert (resting(sleepy), resting(awake)) == ({"r0"}, set())
    start = sleepy.robot_state("r0").positions
    for twin in (sleepy, awake):
        drive(twin, "r0", 5.0)
    moved = []
    for _ in range(30):
        for twin in (sleepy, awake):
            twin.step()
        one, other = (twin.robot_state("r0", with_efforts=False) for twin in (sleepy, awake))
        assert one.positions == pytest.approx(other.positions, abs=1e-6)
        assert one.base_pose == pytest.approx(other.base_pose, abs=1e-6)
        moved.append(one.positions[0] - start[0])
    assert moved[-1] > 1e-2
    assert moved[9] > 0


def test_a_resting_crate_that_is_moved_falls(tmp_path):
    twins = [crates(tmp_path, model("crate", (0, 0, 0.2)), islands=count, threads=1).build() for count in (1, 0)]
    for twin in twins:
        twin.advance_to(2.0)
        twin.entities.set_state("crate", position=(0, 0, 2.0))
        twin.step()
        assert twin.entities.state("crate").linear[2] == pytest.approx(-9.81 * 0.002, rel=0.01)
        twin.advance_to(2.4)
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-5)


def test_a_resting_crate_that_is_given_a_velocity_slides(tmp_path):
    twin = crates(tmp_path, model("crate", (0, 0, 0.2)), islands=1, threads=1).build()
    twin.advance_to(2.0)
    twin.entities.set_state("crate", linear=(1, 0, 0))
    twin.advance_to(2.1)
    assert pose(twin, "crate")[0] > 0.03


FEELER = """<robot name="feeler"><link name="box"><inertial><mass value="2"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>
<link name="arm"><inertial><origin xyz=".3 0 0"/><mass value="1"/>
<inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift" type="revolute"><parent link="box"/><child link="arm"/><axis xyz="0 1 0"/><origin xyz="0 0 .2"/>
<limit lower="-1" upper="1" effort="50" velocity="5"/></joint>
<ros2_control name="c" type="system"><joint name="lift"><command_interface name="position"/>
<state_interface name="position"/><state_interface name="velocity"/><state_interface name="effort"/></joint>
</ros2_control>
<gazebo reference="box"><sensor name="s" type="contact"><contact><collision>box_collision</collision></contact>
</sensor><sensor name="i" type="imu"/></gazebo></robot>"""


def test_a_resting_robot_publishes_the_same_as_in_one_plant(tmp_path):
    (tmp_path / "feeler.urdf").write_text(FEELER, encoding="utf-8")
    found = []
    for count in (1, 0):
        builder = crates(tmp_path, model("crate", (0, 0, 0.5), mass=1.0), islands=count, threads=1)
        twin = builder.robot("feeler", tmp_path / "feeler.urdf", xyz=(0, 0, 0.1)).build()
        twin.advance_to(6.0)
        if count:
            assert "feeler" in resting(twin)
        joints, contact = twin.robot_state("feeler"), twin.latest("/feeler/s/contact")
        forces = sorted(
            (item.collision1.name, item.collision2.name, wrench.body_1_wrench.force.z)
            for item in contact.contacts
            for wrench in item.wrenches
        )
        found.append((joints, forces, twin))
    (one, forces, twin), (other, expected, _) = found
    assert one.positions == pytest.approx(other.positions, abs=1e-6)
    assert one.velocities == pytest.approx(other.velocities, abs=2e-5)
    assert one.efforts == pytest.approx(other.efforts, rel=3e-6)
    assert abs(one.efforts[0]) == pytest.approx(0.3 * 9.81 * cos(one.positions[0]), rel=0.01)
    assert [item[:2] for item in forces] == [item[:2] for item in expected]
    assert [item[2] for item in forces] == pytest.approx([item[2] for item in expected], rel=1e-3, abs=1e-3)
    assert archipelago(twin).islands == []


def test_a_rover_that_drives_into_a_resting_crate_pushes_it_as_in_one_plant(tmp_path):
    crate = model("crate", (1.0, 0, 0.15), size=(0.3, 0.6, 0.3), mass=0.5)
    twins = [with_rovers(crates(tmp_path, crate, islands=n, threads=1), (-0.5, 0, 0)).build() for n in (1, 0)]
    for twin in twins:
        twin.advance_to(2.0)
        drive(twin, "r0", 6.0)
        twin.advance_to(3.0)
    assert resting(twins[0]) == {"crate"}
    before = pose(twins[0], "crate")
    for _ in range(12):
        for twin in twins:
            twin.advance_to(twin.time + 0.25)
        for name in ("crate", "r0"):
            assert pose(twins[0], name) == pytest.approx(pose(twins[1], name), abs=5e-3)
    assert pose(twins[0], "crate")[0] - before[0] > 0.3
