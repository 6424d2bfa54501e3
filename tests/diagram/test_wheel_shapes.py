"""Which cylinders and meshes are wheels: round about their own axis on a joint that turns without a limit."""

from math import cos, inf, pi, radians, sin

import numpy as np
import pytest
from pydrake.geometry import Box, Convex, Cylinder, Ellipsoid, Sphere
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PrismaticJoint, RevoluteJoint, SpatialInertia

from drake_twin.diagram.wheels import WheelFinder

RADIUS, WIDTH = 0.1, 0.05
LYING = RotationMatrix.MakeXRotation(pi / 2)  # a cylinder's axis along y


def found(shape=None, *, limits=(-inf, inf), axis=(0, 1, 0), X_BG=None, X_WB=None, weld=None, joint=RevoluteJoint):
    """The wheel that is found for a shape on a body that a joint turns against a floating base."""
    plant = MultibodyPlant(0.001)
    inertia = SpatialInertia.SolidSphereWithMass(1.0, 0.1)
    base, body = plant.AddRigidBody("base", inertia), plant.AddRigidBody("body", inertia)
    plant.AddJoint(joint("joint", base.body_frame(), body.body_frame(), axis, *limits))
    if weld is not None:
        rim = plant.AddRigidBody("rim", inertia)
        plant.WeldFrames(body.body_frame(), rim.body_frame(), weld)
        body = rim
    if X_WB is not None:
        plant.SetDefaultFloatingBaseBodyPose(base, X_WB)
    shape = shape or Cylinder(RADIUS, WIDTH)
    return WheelFinder(plant, {}).wheel(body, shape, X_BG or RigidTransform(LYING, [0, 0, 0]))


def regular(corners, radius=RADIUS, width=WIDTH):
    """The hull of a prism about the y axis."""
    angles = np.linspace(0, 2 * pi, corners, endpoint=False)
    ring = [(radius * cos(a), side * width / 2, radius * sin(a)) for a in angles for side in (-1, 1)]
    return Convex(np.ascontiguousarray(np.array(ring).T), "prism")


def test_a_cylinder_about_its_joints_axis_is_an_ellipsoid_of_its_measures():
    wheel = found(X_BG=RigidTransform(LYING, [0, 0.03, 0]))
    assert (wheel.shape.a(), wheel.shape.b(), wheel.shape.c()) == pytest.approx((RADIUS, RADIUS, WIDTH / 2))
    assert wheel.X_BE.translation() == pytest.approx([0, 0.03, 0])
    assert abs(wheel.X_BE.rotation().matrix()[:, 2]) == pytest.approx([0, 1, 0])
    assert not wheel.is_roller


@pytest.mark.parametrize(
    ("limits", "is_wheel"),
    [
        ((-inf, inf), True),
        ((0.0, inf), True),
        ((-2 * pi, 2 * pi), False),  # two turns
        ((-2 * pi, 2 * pi * (1 + 1e-6)), True),  # and a little more
        ((0.0, 4 * pi + 1e-6), True),
        ((-pi, pi), False),
    ],
)
def test_a_joint_of_more_than_two_turns_has_no_limit(limits, is_wheel):
    assert (found(limits=limits) is not None) is is_wheel


@pytest.mark.parametrize(
    ("angle", "off", "is_wheel"), [(0.9, 0.0, True), (1.1, 0.0, False), (0, 0.019, True), (0, 0.021, False)]
)
def test_it_is_about_the_joints_axis_but_for_a_degree_and_a_fiftieth_of_its_radius(angle, off, is_wheel):
    X_BG = RigidTransform(RotationMatrix.MakeXRotation(pi / 2 + radians(angle)), [0, 0, off * RADIUS])
    assert (found(X_BG=X_BG) is not None) is is_wheel


@pytest.mark.parametrize(
    ("shape", "is_wheel"),
    [
        (Cylinder(RADIUS, 3.99 * RADIUS), True),
        (Cylinder(RADIUS, 4.01 * RADIUS), False),  # wider than twice its diameter: a roller of a belt
        (regular(12), True),
        (regular(8), False),  # its sides are 0.92 of its corners from the axis
        (regular(48, width=1.99 * RADIUS), True),
        (regular(48, width=2.01 * RADIUS), False),
        (Sphere(RADIUS), False),
        (Box(RADIUS, RADIUS, RADIUS), False),
    ],
)
def test_wheels_are_cylinders_and_round_meshes_that_are_not_too_wide(shape, is_wheel):
    X_BG = RigidTransform(LYING, [0, 0, 0]) if isinstance(shape, Cylinder) else RigidTransform()
    assert (found(shape, X_BG=X_BG) is not None) is is_wheel


def test_a_mesh_beside_its_origin_is_an_ellipsoid_about_its_middle():
    wheel = found(regular(48), X_BG=RigidTransform([0, 0.02, 0]))
    assert wheel.X_BE.translation() == pytest.approx([0, 0.02, 0])
    assert (wheel.shape.a(), wheel.shape.c()) == pytest.approx((RADIUS, WIDTH / 2), rel=1e-6)


@pytest.mark.parametrize(
    ("tilt", "is_wheel"), [(0, True), (44, True), (46, False), (90, False), (134, False), (136, True)]
)
def test_what_turns_about_a_steep_axis_is_a_turntable(tilt, is_wheel):
    """Whether the axis is steep by the base's pose at the start, or by the joint."""
    X_WB = RigidTransform(RollPitchYaw(radians(tilt), 0, 0), [0, 0, 0])
    assert (found(X_WB=X_WB) is not None) is is_wheel
    axis = np.array([0, cos(radians(tilt)), sin(radians(tilt))])
    X_BG = RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), [0, 0, 0])
    assert (found(axis=axis, X_BG=X_BG) is not None) is is_wheel


def test_what_is_welded_to_a_turning_body_is_a_wheel_and_what_slides_is_none():
    weld = RigidTransform(RotationMatrix.MakeYRotation(0.5), [0, 0.04, 0])
    wheel = found(weld=weld)
    assert isinstance(wheel.shape, Ellipsoid)
    assert weld.translation() + weld.rotation() @ wheel.X_BE.translation() == pytest.approx([0, 0.04, 0])
    assert found(weld=RigidTransform([0.01, 0, 0])) is None  # off the axis
    assert found(joint=PrismaticJoint) is None
