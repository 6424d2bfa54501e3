"""A pair's friction is Gazebo's: the smaller coefficient of the two, whatever they are and whatever moves."""

import numpy as np
import pytest
from hands import CONTROLLERS, hand
from scenes import G, Scene, box, every_engine, plane, position, sphere, static_box, static_mesh, velocity

BOX = (0.2, 0.3, 0.1)
SPEED = 2.0


def deceleration(twin, name, start):
    """Of what slides from a time on (m/s²), over the middle of its way."""
    speeds = []
    for time in (0.1, 0.3):
        twin.advance_to(start + time)
        speeds.append(velocity(twin, name)[0])
    return (speeds[0] - speeds[1]) / 0.2


@every_engine
@pytest.mark.parametrize("ground", ["plane", "box", "mesh", "slab"])
@pytest.mark.parametrize(("own", "others"), [(0.2, 1.0), (1.0, 0.2), (0.5, 0.3), (0.3, None)])
def test_the_smaller_friction_of_two_brakes(figure, tmp_path, engine, ground, own, others):
    of_floor = 1.0 if others is None else others
    floors = {
        "plane": lambda: plane(friction=of_floor),
        "box": lambda: static_box(friction=of_floor),
        "mesh": lambda: static_mesh(tmp_path / "terrain.obj", friction=of_floor),
        "slab": lambda: plane(friction=100.0),
    }
    floor = None if others is None and ground == "plane" else floors[ground]()  # None: the ground that is always there
    scene = Scene(tmp_path, engine, floor)
    top = 0.0
    if ground == "slab":
        top = 0.1
        scene.add("slab", box((30.0, 4.0, top), 400.0, friction=of_floor), (10, 0, top / 2))
    scene.add("crate", box(BOX, friction=own), (0, 0, top + BOX[2] / 2))
    twin = scene.build()
    twin.advance_to(0.2)
    twin.entities.set_state("crate", linear=(SPEED, 0, 0))
    ratio = deceleration(twin, "crate", 0.2) / (min(own, of_floor) * G)
    assert figure("two coefficients: deceleration ÷ smaller one g", ratio) == pytest.approx(1.0, abs=0.03)


@every_engine
def test_a_ball_that_slides_is_braked_by_the_smaller_friction_until_it_rolls(tmp_path, engine):
    scene = Scene(tmp_path, engine, plane(friction=1.0)).add("ball", sphere(0.1, friction=0.2), (0, 0, 0.1))
    twin = scene.build()
    twin.advance_to(0.2)
    twin.entities.set_state("ball", linear=(SPEED, 0, 0), angular=(0, 0, 0))
    # It rolls after 2 v / (7 µ g) = 0.29 s; then 5/7 of its speed is left.
    twin.advance_to(0.3)
    early = velocity(twin, "ball")[0]
    twin.advance_to(0.4)
    assert (early - velocity(twin, "ball")[0]) / 0.1 == pytest.approx(0.2 * G, rel=0.03)
    twin.advance_to(0.8)
    assert velocity(twin, "ball")[0] == pytest.approx(SPEED * 5 / 7, rel=0.01)


PAD = """<link name="{name}"><inertial><mass value="0.1"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.06 0.02 0.06"/></geometry></collision></link>
<joint name="{name}_joint" type="prismatic"><parent link="hand"/><child link="{name}"/><axis xyz="0 {inwards} 0"/>
<origin xyz="0 {y} 0"/><limit lower="0" upper="0.1" effort="100" velocity="1"/></joint>
<gazebo reference="{name}"><mu1>{friction}</mu1><mu2>{friction}</mu2></gazebo>"""


def gripper(friction):
    pads = [
        PAD.format(name=name, y=side * 0.062, inwards=-side, friction=friction)
        for name, side in (("left", 1), ("right", -1))
    ]
    return hand("".join(pads), z=0.15)


@every_engine
@pytest.mark.parametrize("friction", [0.5, 1.0])
def test_two_pads_hold_a_box_by_friction_while_they_move_and_drop_it_where_the_force_is_too_small(
    figure, tmp_path, engine, friction
):
    (tmp_path / "controllers.yaml").write_text(CONTROLLERS)
    scene = Scene(tmp_path, engine)
    scene.add("gripper", gripper(friction), (0, 0, 0), controllers=tmp_path / "controllers.yaml")
    scene.add("crate", box((0.1, 0.1, 0.3), 1.0), (0, 0, 0.15))
    twin = scene.build()
    needed = 1.0 * G / (2 * friction)

    def grip(share):
        twin.publish("/gripper/grip/commands", [share * needed] * 2)

    def lift(to, seconds):
        """Changes the speed by 0.1 m/s²."""
        was = lift.speed
        for step in range(1, round(seconds * 100) + 1):
            lift.speed = was + (to - was) * step / (seconds * 100)
            twin.publish("/gripper/lift/commands", [lift.speed])
            twin.advance_to(twin.time + 0.01)

    def slipped():
        pads = twin.robot_state("gripper").positions[0]
        return position(twin, "crate")[2] - 0.15 - pads

    lift.speed = 0.0
    grip(1.5)
    twin.advance_to(1.0)
    before = slipped()
    lift(0.1, 1.0)
    grip(1.05)
    lift(0.1, 1.0)
    lift(0.0, 1.0)
    twin.advance_to(twin.time + 2.0)
    assert position(twin, "crate")[2] == pytest.approx(0.35, abs=5e-3)
    assert abs(figure("gripper at 1.05 of the force: slips (mm)", 1e3 * (slipped() - before))) < 1.0
    grip(0.8)
    twin.advance_to(twin.time + 0.05)
    start, height, v1 = twin.time, position(twin, "crate")[2], velocity(twin, "crate")[2]
    twin.advance_to(start + 0.2)
    v2 = velocity(twin, "crate")[2]
    falls = figure("gripper at 0.8 of the force: acceleration ÷ 0.2 g", (v1 - v2) / 0.2 / (0.2 * G))
    assert falls == pytest.approx(1.0, abs=0.1)
    assert position(twin, "crate")[2] < height - 0.02


@every_engine
def test_a_box_that_a_rover_pushes_moves_with_it(tmp_path, engine):
    from bases import RADIUS, four_wheels

    scene = Scene(tmp_path, engine).add("base", four_wheels(), (0, 0, RADIUS))
    scene.add("crate", box((0.2, 0.4, 0.2), 1.0, friction=0.4), (-0.46, 0.0, 0.1))
    twin = scene.build()
    twin.advance_to(0.5)
    speeds = [3.0] * 4
    twin.publish("/base/forward_velocity_controller/commands", speeds)
    twin.advance_to(2.5)
    apart = position(twin, "base") - position(twin, "crate")
    start = position(twin, "base")
    twin.advance_to(5.5)
    way = position(twin, "base") - start
    assert np.linalg.norm(way) == pytest.approx(3.0 * RADIUS * 3.0, rel=0.02)
    assert position(twin, "base") - position(twin, "crate") == pytest.approx(apart, abs=2e-3)
