"""Overlays of links and joints: their values against closed forms and against the file's own numbers."""

import numpy as np
import pytest
from conftest import rovers
from pydrake.geometry import Rgba, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from seeing_robot import seeing
from test_overlays import Drawn

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes
from drake_twin.cockpit.overlays.joint_axes import joint_range
from drake_twin.cockpit.scene import OVERLAYS, Scene

PENDULUM = """<robot name="pendulum"><link name="world"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.05 0.05 0.4"/></geometry></visual></link>
  <link name="lower"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"><inertial><mass value="0.5"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="world"/><child link="upper"/><origin xyz="0 0 1"/>
    <axis xyz="0 1 0"/><limit lower="-0.5" upper="1.2" effort="9" velocity="9"/></joint>
  <joint name="elbow" type="prismatic"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/>
    <axis xyz="0 0 1"/><limit lower="-0.1" upper="0.3" effort="9" velocity="9"/></joint>
  <joint name="hand" type="fixed"><parent link="upper"/><child link="tip"/>
    <origin xyz="0.1 0 -0.4" rpy="0 0 1"/></joint>
</robot>"""


@pytest.fixture
def pendulum(tmp_path):
    file = tmp_path / "pendulum.urdf"
    file.write_text(PENDULUM)
    with TwinBuilder().robot("pendulum", file).build() as twin:
        yield twin


def test_a_robots_center_of_mass_is_that_of_the_closed_form_and_is_sent_only_when_it_moves(pendulum):
    drawn = Drawn()
    masses = OVERLAY_KINDS["masses"].type(drawn, pendulum)
    for angle, out in ((0.0, 0.0), (0.7, -0.05)):
        pendulum.entities.set_joint_positions("pendulum", {"shoulder": angle, "elbow": out})
        masses.draw()
        swung = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
        parts = {2.0: (0, 0, -0.2), 1.0: (0, 0, -0.4 + out - 0.3), 0.5: (0.1, 0, -0.4)}
        center = sum(mass * (swung @ at) for mass, at in parts.items()) / 3.5 + (0, 0, 1)
        path = f"{OVERLAYS}/masses/robots/pendulum"
        assert drawn.transforms.pop(path).translation() == pytest.approx(center, abs=1e-9)
        masses.draw()
        assert path not in drawn.transforms
    assert drawn.objects[path].radius() == pytest.approx((3 * 3.5 / (4 * np.pi * 11340)) ** (1 / 3))


def test_the_ranges_of_joints_end_at_the_limits_of_the_file(pendulum):
    plant = pendulum.plant
    axis, ends, needle = joint_range(plant.GetJointByName("shoulder"), 0.1)
    assert axis == pytest.approx([0, 1, 0])
    arc = ends[:-4]  # the last two segments mark the limits
    zero = needle[1] / np.linalg.norm(needle[1])
    beside = np.cross(axis, zero)
    angles = np.arctan2(arc @ beside, arc @ zero)
    assert (angles.min(), angles.max()) == pytest.approx((-0.5, 1.2))
    assert np.linalg.norm(arc, axis=1) == pytest.approx(0.1)
    axis, ends, _ = joint_range(plant.GetJointByName("elbow"), 0.1)
    assert axis == pytest.approx([0, 0, 1])
    assert ends[0] == pytest.approx([0, 0, -0.1])
    assert ends[1] == pytest.approx([0, 0, 0.3])


def test_a_wheels_range_is_a_full_turn():
    twin = rovers(1).build()
    _, ends, _ = joint_range(twin.plant.GetJointByName("robot_1_rear_left_wheel_joint"), 0.1)
    assert len(ends) == 2 * 64
    assert ends[0] == pytest.approx(ends[-1], abs=1e-12)


def test_a_needle_turns_with_the_child_and_the_range_stays_with_the_parent(pendulum):
    drawn = Drawn()
    OVERLAY_KINDS["joints"].type(drawn, pendulum)
    number = int(pendulum.plant.GetJointByName("elbow").index())
    on = f"{OVERLAYS}/joints/on/pendulum/upper"
    assert drawn.transforms[f"{on}/limits/{number}"].translation() == pytest.approx([0, 0, -0.4])
    (needle,) = [path for path in drawn.lines if path.endswith(f"/limits/{number}needle")]
    lower = int(pendulum.plant.GetBodyByName("lower").index())
    assert needle.startswith(f"{OVERLAYS}/joints/{lower}/")  # nothing is drawn of it that a browser could follow


def test_shapes_on_bodies_that_are_not_drawn_are_in_their_place_and_sent_only_when_they_move(pendulum):
    plant, drawn = pendulum.plant, Drawn()
    tip, lower = (plant.GetBodyByName(name).index() for name in ("tip", "lower"))
    X_BS = RigidTransform([0.01, 0.02, 0.03])
    shapes = BodyShapes(drawn, pendulum, "/x", [BodyShape(b, X_BS, Sphere(0.1), Rgba(1, 0, 0)) for b in (tip, lower)])
    on_upper = drawn.transforms["/x/on/pendulum/upper/0"]  # the tip is welded to it
    assert on_upper.IsNearlyEqualTo(RigidTransform(RollPitchYaw(0, 0, 1), [0.1, 0, -0.4]) @ X_BS, 1e-9)
    shapes.draw()
    assert drawn.transforms.pop(f"/x/{int(lower)}").translation() == pytest.approx([0, 0, 0.6])
    shapes.draw()
    assert f"/x/{int(lower)}" not in drawn.transforms
    pendulum.entities.set_joint_positions("pendulum", {"elbow": 0.2})
    shapes.draw()
    assert drawn.transforms[f"/x/{int(lower)}"].translation() == pytest.approx([0, 0, 0.8])


@pytest.mark.parametrize("name", ["collision", "inertia", "joints"])
def test_what_moves_with_links_sends_nothing_while_the_robots_drive(name):
    twin = rovers(2).build()
    scene, sent = Scene(), []
    overlay = OVERLAY_KINDS[name].type(scene, twin)
    overlay.draw()
    scene.listen(sent.extend)
    twin.publish("/robot_1/forward_velocity_controller/commands", [5.0, 5.0, 5.0, 5.0])
    twin.advance_to(0.3)
    overlay.draw()
    assert sent == []


def test_what_sensors_see_begins_where_they_are(tmp_path):
    twin = seeing(tmp_path).build()
    drawn = Drawn()
    views = OVERLAY_KINDS["sensors"].type(drawn, twin)
    twin.entities.set_state("box_0", (0.3, 0.2, 0.5))
    views.draw()
    body = int(twin.plant.GetBodyByName("box").index())  # it has no visual
    own = [path for path in drawn.lines if path.startswith(f"{OVERLAYS}/sensors/{body}/")]
    assert len(own) == 2  # a lidar and a camera
    for path, sensor in zip(own, ("lidar", "camera"), strict=True):
        found = drawn.transforms[f"{OVERLAYS}/sensors/{body}"] @ drawn.transforms[path]
        assert found.IsNearlyEqualTo(twin.sensor("box_0", sensor).pose, 1e-9)
