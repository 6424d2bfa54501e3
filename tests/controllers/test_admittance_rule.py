"""The assertions of ros2_controllers' test_admittance_rule_impl.cpp, cited by line, and closed forms."""

from dataclasses import dataclass, field
from math import pi

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

from drake_twin.controllers.admittance_rule import AdmittanceRule, AdmittanceState

DT = 0.01
AT_START, AT_REFERENCE = np.zeros(6), np.ones(6)
TURNED = RotationMatrix.MakeYRotation(pi / 2)  # the control frame's z is the base's x
FORCE = np.array([5.0, 0.0, 0.0, 0.0, 0.0, 0.0])


@dataclass
class Mock:
    """Kinematics whose joints are the six components, as upstream's mock; with the poses of some links."""

    links: dict = field(default_factory=dict)

    def pose(self, positions, link):
        return self.links.get(f"{link}@reference" if positions is AT_REFERENCE else link, RigidTransform())

    def joint_deltas(self, positions, deltas, link):
        return deltas

    def cartesian_deltas(self, positions, deltas, link):
        return deltas


def six(x, y, z, turn=0.1):
    return np.array([x, y, z, turn, turn, turn])


def rule(links=None, **more):
    given = {
        "kinematics": Mock(links or {}),
        "sensor_frame": "link_6",
        "control_frame": "tool0",
        "world_frame": "world",
        "gravity_frame": "gravity",
        "center_of_gravity": np.zeros(3),
        "weight": 0.0,
        "filter_coefficient": 1.0,
        "selected_axes": np.ones(6),
        "mass": six(1.0, 1.0, 1.0),
        "damping": six(10.0, 10.0, 10.0),
        "stiffness": six(50.0, 50.0, 50.0),
        "joint_damping": 5.0,
    }
    return AdmittanceRule(**{**given, **more})


def step(dut, wrench=FORCE, state=None, dt=DT):
    return dut.update(state or AdmittanceState.at_rest(6), AT_START, AT_REFERENCE, np.asarray(wrench, dtype=float), dt)


@pytest.mark.parametrize("mass", [1.0, 100.0])
def test_a_force_moves_the_joints_in_a_turned_control_frame(mass):
    control = {"tool0": RigidTransform(TURNED, np.zeros(3))}
    state = step(rule(control, mass=six(1.0, 1.0, mass)))
    assert np.linalg.norm(state.joint_positions) > 0.0  # :308, :309, :389, :390, :429, :436, :451, :452
    # the mass is along the axes of the base, so that it has no effect here: :398, :444
    np.testing.assert_allclose(state.joint_positions, np.array([5.0, 0, 0, 0, 0, 0]) * DT * DT, atol=1e-15)


def test_the_offset_is_none_at_first():
    assert AdmittanceState.at_rest(6).offset == (0, 0, 0, 1, 0, 0, 0)  # :316


def test_the_offset_is_from_the_reference_to_the_measured_pose():
    reference = RigidTransform(RotationMatrix.MakeYRotation(-pi / 6), [-0.4, 0.5, 0.2])
    desired = RigidTransform(RotationMatrix.MakeZRotation(pi / 4), [0.1, -0.2, 0.3])
    links = {"link_6": desired, "link_6@reference": reference}
    zero = np.zeros(6)
    state = step(rule(links, mass=np.ones(6), stiffness=zero, damping=zero), zero)
    expected = desired.rotation() @ reference.rotation().inverse()
    np.testing.assert_allclose(state.offset[:3], [0.5, -0.7, 0.1])  # :353
    np.testing.assert_allclose(state.offset[3:], expected.ToQuaternion().wxyz())  # :353
    np.testing.assert_allclose(state.reference[:3], [-0.4, 0.5, 0.2])


def test_a_spring_pulls_back_along_and_about_its_axes():
    links = {"link_6": RigidTransform(RollPitchYaw(0.0, 0.0, 0.2), [0.1, 0.0, 0.0])}
    stiffness = np.array([10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    state = step(rule(links, stiffness=stiffness, mass=np.ones(6)), np.zeros(6))
    np.testing.assert_allclose(state.joint_accelerations, [-1.0, 0, 0, 0, 0, -0.2 * 60.0], atol=1e-12)
    turned = {**links, "tool0": RigidTransform(TURNED, np.zeros(3))}  # its z is the base's x, its x is the base's -z
    state = step(rule(turned, stiffness=stiffness, mass=np.ones(6)), np.zeros(6))
    np.testing.assert_allclose(state.joint_accelerations, [-3.0, 0, 0, 0, 0, -0.2 * 40.0], atol=1e-12)


def test_a_wrench_has_an_effect_in_the_selected_axes_of_the_control_frame():
    control = {"tool0": RigidTransform(TURNED, np.zeros(3))}
    wrench = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    state = step(rule(control, selected_axes=np.array([0, 0, 1, 1, 0, 0]), mass=np.ones(6)), wrench)
    np.testing.assert_allclose(state.joint_accelerations, [1.0, 0, 0, 0, 0, 6.0], atol=1e-12)
    np.testing.assert_allclose(state.wrench_base, wrench)


def test_damping_is_of_the_last_velocity():
    state = AdmittanceState((0.0,) * 6, (2.0,) * 6, (0.0,) * 6, velocity=(1.0,) * 6)
    after = step(rule(damping=np.arange(1.0, 7.0), mass=np.ones(6)), np.zeros(6), state)
    accelerations = -np.arange(1.0, 7.0) - 5.0 * 2.0
    np.testing.assert_allclose(after.joint_accelerations, accelerations)
    np.testing.assert_allclose(after.joint_velocities, 2.0 + accelerations * DT)
    np.testing.assert_allclose(after.joint_positions, (2.0 + accelerations * DT) * DT)
    np.testing.assert_allclose(after.velocity, after.joint_velocities)
    np.testing.assert_allclose(after.acceleration, after.joint_accelerations)


def test_the_wrench_is_smoothed_exponentially():
    dut, state = rule(filter_coefficient=0.25), None
    for count in range(1, 5):
        state = step(dut, FORCE, state)
        assert state.wrench_base[0] == pytest.approx(5.0 * (1 - 0.75**count))


@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.3, -0.8, 1.2)])
def test_the_weight_of_the_end_effector_is_taken_off(rpy):
    """However sensor, base and world are turned: the sensor feels the weight at the centre of gravity, and no more."""
    R_world_base = RotationMatrix(RollPitchYaw(*rpy))
    R_base_sensor = RotationMatrix(RollPitchYaw(0.5, 0.6, -0.7))
    center = np.array([0.1, -0.2, 0.3])
    links = {
        "world": RigidTransform(R_world_base.inverse(), [1.0, 2.0, 3.0]),
        "link_6": RigidTransform(R_base_sensor, [0.4, 0.5, 0.6]),
        "link_6@reference": RigidTransform(R_base_sensor, [0.4, 0.5, 0.6]),
        "gravity": RigidTransform(R_base_sensor, [0.4, 0.5, 0.6]),
    }
    weight = (R_world_base @ R_base_sensor).inverse().matrix() @ [0.0, 0.0, -23.0]
    felt = np.concatenate([weight, np.cross(center, weight)])
    state = step(rule(links, center_of_gravity=center, weight=23.0), felt)
    np.testing.assert_allclose(state.wrench_base, np.zeros(6), atol=1e-12)
    push = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    pushed = step(rule(links, center_of_gravity=center, weight=23.0), felt + push)
    R = R_base_sensor.matrix()
    np.testing.assert_allclose(pushed.wrench_base, np.concatenate([R @ push[:3], R @ push[3:]]), atol=1e-12)
