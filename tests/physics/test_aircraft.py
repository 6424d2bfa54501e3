"""Bodies with gz-sim's AdvancedLiftDrag in a twin: what the formulas of flight say, at steps of 1 and 10 ms."""

from math import asin, atan2, cos, degrees, exp, hypot, pi, sin, sqrt

import numpy as np
import pytest
from flyers import FLAP, RHO, STEPS, G, deflect, flyer, plugin
from repeated_runs import goes_on_to_the_same_bits

from drake_twin.errors import RunError

# A wing of 3 m and a chord of 0.2 m that stalls late, so that nothing of its flow has left it at small angles.
WING = {"AR": 15, "eff": 0.8, "area": 0.6, "alpha_stall": 1.4}
SPAN, CHORD = 3.0, 0.2


@pytest.fixture
def fly(tmp_path):
    """Builds a twin of a body of 2 kg with the wing and more elements; gravity in m/s² downwards."""

    def build(elements, **more):
        return flyer(tmp_path, plugin("AdvancedLiftDrag", {**WING, **elements}), **more)

    return build


def changes(twin, linear, angular=(0.0, 0.0, 0.0)):
    """Accelerations in the first step: of the place (m/s²) and of the orientation (rad/s²)."""
    twin.entities.set_state("flyer", linear=linear, angular=angular)
    step = twin.scenario.time_step
    twin.advance_to(step)
    state = twin.entities.state("flyer")
    return np.subtract(state.linear, linear) / step, np.subtract(state.angular, angular) / step


@STEPS
@pytest.mark.parametrize("angle", [-0.1, 0.1, 0.25])
def test_lift_and_drag_before_stall(fly, time_step, angle):
    """C_L = C_L0 + C_La α, and C_D = C_D0 + C_L² / (π AR e)."""
    twin, speed = fly({"CL0": 0.2, "CLa": 4.5, "CD0": 0.03}, time_step=time_step), 12.0
    linear, angular = changes(twin, (speed * cos(angle), 0.0, -speed * sin(angle)))
    lift = 0.2 + 4.5 * angle
    drag, size = 0.03 + lift**2 / (pi * 15 * 0.8), 0.5 * RHO * speed**2 * 0.6 / 2.0
    along, across = np.array([cos(angle), 0.0, -sin(angle)]), np.array([sin(angle), 0.0, cos(angle)])
    assert linear == pytest.approx(size * (lift * across - drag * along), abs=1e-5)
    assert angular == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@STEPS
@pytest.mark.parametrize("angle", [-1.1, 0.9])
def test_a_stalled_wing_is_a_flat_plate(fly, time_step, angle):
    """C_L = 2 sin² α cos α, and C_D as of the plate; all but a thousandth of the flow has left it there."""
    twin, speed = fly({"CLa": 4.5, "CD0": 0.03, "alpha_stall": 0.3}, time_step=time_step), 12.0
    linear, _ = changes(twin, (speed * cos(angle), 0.0, -speed * sin(angle)))
    lift = 2.0 * sin(angle) ** 2 * cos(angle) * np.sign(angle)
    drag = 2.0 / (1.0 + exp(-0.224 - 0.115 * 15)) * sin(angle) ** 2
    along, across = np.array([cos(angle), 0.0, -sin(angle)]), np.array([sin(angle), 0.0, cos(angle)])
    size = 0.5 * RHO * speed**2 * 0.6 / 2.0
    assert linear == pytest.approx(size * (lift * across - drag * along), abs=1e-3 * size)


@STEPS
def test_sideslip_makes_a_side_force_and_moments_at_the_reference_point(fly, time_step):
    values = {"CYb": -0.3, "Cellb": -0.04, "Cemb": 0.05, "Cenb": 0.1, "cp": "-0.2 0 0"}
    slip = 0.15  # it flies to the left of its nose, which is a sideslip below zero: the right is -y
    linear, angular = changes(fly(values, time_step=time_step), (10 * cos(slip), 10 * sin(slip), 0.0))
    size = 0.5 * RHO * (10 * cos(slip)) ** 2 * 0.6
    side = size * -0.3 * -slip  # to the right
    assert linear == pytest.approx((0.0, -side / 2.0, 0.0), abs=1e-9)
    roll, pitch, yaw = size * SPAN * -0.04 * -slip, size * CHORD * 0.05 * -slip, size * SPAN * 0.1 * -slip
    # About the axes x, -y and -z; the side force acts 0.2 m behind.
    assert angular == pytest.approx((roll / 0.5, -pitch / 0.8, (-yaw + 0.2 * side) / 1.2), abs=1e-9)


@STEPS
def test_a_roll_dies_away(fly, time_step):
    """I p' = ½ ρ V S b C_lp p b / 2, in a flight along x that nothing slows."""
    twin = fly({"Cellp": -0.02}, time_step=time_step)
    twin.entities.set_state("flyer", linear=(10.0, 0.0, 0.0), angular=(0.8, 0.0, 0.0))
    rate = 0.5 * RHO * 10.0 * 0.6 * SPAN**2 / 2 * 0.02 / 0.5
    for time in (0.5, 1.5):
        twin.advance_to(time)
        assert twin.entities.state("flyer").angular[0] == pytest.approx(0.8 * exp(-rate * time), rel=0.01)


@STEPS
def test_a_fin_turns_the_nose_into_the_wind_as_a_pendulum(fly, time_step):
    """I ψ'' = -½ ρ V² S b C_nb ψ for small angles: the nose passes the way of flight after a quarter of the period."""
    twin, speed, start = fly({"Cenb": 0.02}, time_step=time_step, inertia=(1.2, 1.2, 1.2)), 10.0, 0.03
    twin.entities.set_state("flyer", linear=(speed * cos(start), speed * sin(start), 0.0))
    frequency = sqrt(0.5 * RHO * speed**2 * 0.6 * SPAN * 0.02 / 1.2)
    for part in (0.25, 0.5, 1.0):
        twin.advance_to(round(2 * pi / frequency * part / 0.01) * 0.01)
        turned = twin.entities.state("flyer").orientation
        yaw = 2 * atan2(turned[3], turned[0])
        assert yaw == pytest.approx(start * (1 - cos(frequency * twin.time)), abs=0.02 * start)


@STEPS
def test_pitching_and_control_surfaces_make_forces(fly, time_step):
    """A pitch rate is nose up, -y; a surface acts by its degrees."""
    surface = "<name>hinge</name><direction>-1</direction>" + "".join(
        f"<{name}_ctrl>{value}</{name}_ctrl>"
        for name, value in {"CL": 0.01, "CD": 0.002, "CY": 0, "Cell": 0, "Cem": -0.02, "Cen": 0}.items()
    )
    values = {"CLq": 6.0, "Cemq": -9.0, "num_ctrl_surfaces": 1, "control_surface": surface, "eff": 1e9}
    twin, rate, deflection = fly(values, more=FLAP, time_step=time_step), 0.6, -0.1
    deflect(twin, deflection)
    linear, angular = changes(twin, (10.0, 0.0, 0.0), (0.0, -rate, 0.0))
    size, turned = 0.5 * RHO * 100 * 0.6, degrees(-deflection)
    reduced = rate * CHORD / 2 / 10.0
    assert linear[2] == pytest.approx(size * (6.0 * reduced + 0.01 * turned) / 2.001, rel=1e-3)
    assert linear[0] == pytest.approx(-size * 0.002 * turned / 2.001, rel=1e-3)
    assert angular[1] == pytest.approx(-size * CHORD * (-9.0 * reduced - 0.02 * turned) / 0.8, rel=1e-3)


@STEPS
def test_it_glides_at_the_ratio_of_lift_to_drag(fly, time_step):
    """A body that does not turn sinks at the angle whose tangent is C_D / C_L, with the speed that carries it."""
    lift0, slope, drag0, path = 0.1, 4.0, 0.2, 0.3
    for _ in range(60):  # C_D(α) = tan α · C_L(α), by a fixed point
        lift = lift0 + slope * path
        path = asin((drag0 + lift**2 / (pi * 15 * 0.8)) / hypot(lift, drag0 + lift**2 / (pi * 15 * 0.8)))
    drag = drag0 + lift**2 / (pi * 15 * 0.8)
    speed = sqrt(2 * 2.0 * G / (RHO * 0.6 * hypot(lift, drag)))
    values = {"CL0": lift0, "CLa": slope, "CD0": drag0}
    twin = fly(values, gravity=G, time_step=time_step, inertia=(1e6, 1e6, 1e6))
    twin.entities.set_state("flyer", linear=(speed, 0.0, 0.0))
    twin.advance_to(6.0)
    found = twin.entities.state("flyer").linear
    assert found == pytest.approx((speed * cos(path), 0.0, -speed * sin(path)), rel=0.01)


def test_one_that_is_too_large_for_the_step_fails_with_its_name_alone(fly, recwarn):
    twin = fly({"CLa": 5.0, "CLq": -1e3, "area": 50.0})
    twin.entities.set_state("flyer", linear=(20.0, 0.0, 0.1), angular=(0.1, 0.2, 0.3))
    with pytest.raises(RunError, match="flyer"):
        twin.advance_to(3.0)
    assert [str(item.message) for item in recwarn] == []


def test_a_run_goes_on_from_a_snapshot_and_a_recording_to_the_same_bits(tmp_path, fly):
    twin = fly({"CL0": 0.3, "CLa": 4.0, "CD0": 0.1, "Cellb": -0.1, "Cenb": 0.1, "Cemq": -9}, gravity=G)
    twin.recorder.begin()
    twin.entities.set_state("flyer", linear=(9.0, 1.0, 0.0))
    goes_on_to_the_same_bits(twin, tmp_path)
