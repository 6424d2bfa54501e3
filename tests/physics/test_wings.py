"""Bodies with gz-sim's LiftDrag in a twin: what the formulas of flight say, at steps of 1 and 10 ms."""

from math import atan2, cos, hypot, sin, sqrt, tanh

import numpy as np
import pytest
from flyers import FLAP, RHO, STEPS, G, deflect, flyer, plugin
from repeated_runs import goes_on_to_the_same_bits

from drake_twin import TwinBuilder
from drake_twin.errors import InputError, RunError


@pytest.fixture
def fly(tmp_path):
    """Builds a twin of a body of 2 kg with wings, each a mapping of elements; gravity in m/s² downwards."""

    def build(*wings, **more):
        return flyer(tmp_path, "".join(plugin("LiftDrag", wing) for wing in wings), **more)

    return build


WING = {"a0": 0.05, "cla": 3.0, "cda": 0.4, "cma": -0.2, "area": 0.6, "alpha_stall": 0.35}
STALL = {"cla_stall": -2.0, "cda_stall": 0.9, "cma_stall": -0.1}
# Flow against the body's x axis (rad) → lift, drag, moment: what the lines through (0, 0) and the stall have there.
ANGLES = [
    (-0.05, 0.0, 0.0, 0.0),
    (0.1, 3.0 * 0.15, 0.4 * 0.15, -0.2 * 0.15),
    (-0.25, 3.0 * -0.2, 0.4 * 0.2, -0.2 * -0.2),
    (0.5, 3.0 * 0.35 - 2.0 * 0.2, 0.4 * 0.35 + 0.9 * 0.2, 0.0),
    (-0.5, -3.0 * 0.35 + 2.0 * 0.1, 0.4 * 0.35 + 0.9 * 0.1, 0.0),
    (1.2, 0.0, 0.4 * 0.35 + 0.9 * 0.9, 0.0),  # the lift would be below zero
]


@STEPS
@pytest.mark.parametrize(("angle", "lift", "drag", "moment"), ANGLES)
def test_lift_drag_and_moment_by_the_angle_of_attack(fly, time_step, angle, lift, drag, moment):
    twin, speed = fly({**WING, **STALL}, time_step=time_step), 12.0
    twin.entities.set_state("flyer", linear=(speed * cos(angle), 0.0, -speed * sin(angle)))
    twin.advance_to(time_step)
    state, size = twin.entities.state("flyer"), 0.5 * RHO * speed**2 * 0.6
    along, across = np.array([cos(angle), 0.0, -sin(angle)]), np.array([sin(angle), 0.0, cos(angle)])
    change = (np.array(state.linear) - speed * along) / time_step
    assert change == pytest.approx(size / 2.0 * (lift * across - drag * along), abs=1e-6)
    # Positive moments raise the nose, which is a turn about -y.
    assert np.array(state.angular) / time_step == pytest.approx((0.0, -size * moment / 0.8, 0.0), abs=1e-6)


def test_the_slope_of_the_moment_behind_stall_keeps_its_side(fly):
    """-0.2 · 0.35 - 0.1 · 0.2 would be below zero at a positive angle, which gz-sim does not have behind stall."""
    assert [moment for angle, *_, moment in ANGLES if angle > 0.3] == [0.0, 0.0]
    twin = fly({**WING, **STALL, "cma": 0.2})
    twin.entities.set_state("flyer", linear=(12 * cos(0.5), 0.0, -12 * sin(0.5)))
    twin.advance_to(0.01)
    size = 0.5 * RHO * 144 * 0.6
    assert twin.entities.state("flyer").angular[1] == pytest.approx(-0.01 * size * (0.2 * 0.35 - 0.1 * 0.2) / 0.8)


@STEPS
def test_forces_act_at_the_center_of_pressure_and_a_sweep_lessens_them(fly, time_step):
    """By the square of the cosine of the angle to the plane of lift and drag, for the speed and again."""
    twin, sideways = fly({**WING, "cma": 0, "cp": "0.1 0.7 0"}, time_step=time_step), 5.0
    twin.entities.set_state("flyer", linear=(12.0, sideways, 0.0))
    twin.advance_to(time_step)
    size = 0.5 * RHO * 144 * 0.6 * 144 / (144 + sideways**2)
    lift, drag, state = size * 3.0 * 0.05, size * 0.4 * 0.05, twin.entities.state("flyer")
    change = np.subtract(state.linear, (12.0, sideways, 0.0)) / time_step
    assert change == pytest.approx((-drag / 2, 0.0, lift / 2), abs=1e-9)
    turns = (0.7 * lift / 0.5, -0.1 * lift / 0.8, 0.7 * drag / 1.2)
    assert np.array(state.angular) / time_step == pytest.approx(turns, abs=1e-9)


@STEPS
def test_a_falling_body_approaches_its_terminal_velocity(fly, time_step):
    """With drag alone v = V tanh(g t / V), V² = 2 m g / (ρ A C)."""
    brake = {"a0": 1.0, "cla": 0, "cda": 0.8, "area": 0.5, "forward": "0 0 -1", "upward": "1 0 0"}
    twin = fly(brake, gravity=G, time_step=time_step)
    terminal = sqrt(2 * 2.0 * G / (RHO * 0.5 * 0.8))
    for time in (0.5, 1.0, 2.0):
        twin.advance_to(time)
        assert -twin.entities.state("flyer").linear[2] == pytest.approx(terminal * tanh(G * time / terminal), rel=0.01)
    twin.advance_to(4.5)
    assert twin.entities.state("flyer").linear == pytest.approx((0.0, 0.0, -terminal), rel=2e-3)


@pytest.mark.parametrize(("ratio", "stays"), [(0.5, True), (1.9, True), (2.1, False)])
def test_a_wing_that_is_too_large_for_the_step_swings_and_then_flies_apart(fly, recwarn, ratio, stays):
    """Across its flight v' = -½ ρ V A cla v / m: Euler's explicit steps swing from a ratio of 1 and grow from 2."""
    twin, speed = fly({"cla": 5, "cda": 0, "area": ratio * 2.0 / (0.5 * RHO * 20 * 5 * 0.01)}, inertia=(1e6,) * 3), 0.01
    twin.entities.set_state("flyer", linear=(20.0, 0.0, speed))
    if not stays:
        with pytest.raises(RunError, match="flyer"):
            twin.advance_to(3.0)
        assert [str(item.message) for item in recwarn] == []
        return
    twin.advance_to(0.05)
    assert twin.entities.state("flyer").linear[2] == pytest.approx(speed * (1 - ratio) ** 5, rel=0.01)


def test_the_engine_with_error_control_has_the_same_air(fly):
    brake = {"a0": 1.0, "cla": 0, "cda": 0.8, "area": 0.5, "forward": "0 0 -1", "upward": "1 0 0"}
    twin = fly(brake, gravity=G, engine="cenic")
    terminal = sqrt(2 * 2.0 * G / (RHO * 0.5 * 0.8))
    twin.advance_to(1.0)
    assert -twin.entities.state("flyer").linear[2] == pytest.approx(terminal * tanh(G / terminal), rel=0.01)


MAIN = {"a0": 0.28, "cla": 5.0, "cda": 2.0, "area": 0.5, "cp": "0.03 0 0"}
TAIL = {"a0": 0.0, "cla": 5.0, "cda": 2.0, "area": 0.12, "cp": "-1 0 0"}


@STEPS
def test_a_glider_with_a_tail_flies_at_its_glide_ratio(fly, time_step):
    """It keeps the angle of attack at which both wings balance, the path of CD / CL and the speed that carries it."""
    # x₁ S₁ (a₁ + α) + x₂ S₂ (a₂ + α) = 0: the force of each is as its angle.
    levers = (0.03 * 0.5, -1.0 * 0.12)
    attack = -(levers[0] * 0.28) / sum(levers)
    lift = 5.0 * (0.5 * (0.28 + attack) + 0.12 * attack)  # times the area
    path = atan2(2.0, 5.0)
    speed = sqrt(2 * 2.0 * G / (RHO * hypot(lift, lift * 0.4)))
    pitch = path - attack  # nose down, about y
    twin = fly(MAIN, TAIL, gravity=G, time_step=time_step, pitch=pitch, inertia=(0.1, 0.1, 0.2))
    twin.entities.set_state("flyer", linear=(1.05 * speed * cos(path), 0.0, -speed * sin(path)))
    twin.advance_to(6.0)
    state = twin.entities.state("flyer")
    assert state.linear == pytest.approx((speed * cos(path), 0.0, -speed * sin(path)), rel=0.01)
    assert state.linear[0] / -state.linear[2] == pytest.approx(2.5, rel=0.01)
    assert 2 * atan2(state.orientation[2], state.orientation[0]) == pytest.approx(pitch, abs=0.002)


@STEPS
def test_a_control_surface_adds_lift_and_moment(fly, time_step):
    surface = {"control_joint_name": "hinge", "control_joint_rad_to_cl": 2.5, "cm_delta": -0.3}
    twin, deflection = fly({**WING, **surface}, more=FLAP, time_step=time_step), 0.2
    deflect(twin, deflection)
    twin.entities.set_state("flyer", linear=(10.0, 0.0, 0.0))
    twin.advance_to(time_step)
    size, state = 0.5 * RHO * 100 * 0.6, twin.entities.state("flyer")
    rise = size * (3.0 * 0.05 + 2.5 * deflection) / 2.001
    assert state.linear[2] / time_step == pytest.approx(rise, rel=1e-4)
    assert (state.linear[0] - 10.0) / time_step == pytest.approx(-size * 0.4 * 0.05 / 2.001, rel=1e-4)
    assert state.angular[1] / time_step == pytest.approx(-size * (-0.2 * 0.05 - 0.3 * deflection) / 0.8, rel=1e-4)


ROTOR = """<sdf version="1.9"><model name="rotor"><link name="mast"/>
<joint name="to_world" type="fixed"><parent>world</parent><child>mast</child></joint>
<link name="blade"><inertial><pose>0 0.5 0 0 0 0</pose><mass>0.2</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>
<izz>0.01</izz></inertia></inertial></link>
<joint name="shaft" type="continuous"><parent>mast</parent><child>blade</child><axis><xyz>0 0 -1</xyz></axis></joint>
<plugin filename="gz-sim-apply-joint-force-system" name="gz::sim::systems::ApplyJointForce">
<joint_name>shaft</joint_name></plugin>
<plugin filename="gz-sim-lift-drag-system" name="gz::sim::systems::LiftDrag"><link_name>blade</link_name><a0>0.1</a0>
<cla>0.5</cla><cda>0.2</cda><cp>0 0.8 0</cp><area>{area}</area></plugin></model></sdf>"""


@STEPS
def test_rotors_of_several_robots_spin_up_to_the_torque_of_their_drag(tmp_path, time_step):
    """I w' = M - c w², so that w = √(M / c) tanh(t √(M c) / I), of each robot by itself."""
    areas, torque, inertia = {"small": 0.1, "large": 0.3}, 2.0, 0.01 + 0.2 * 0.5**2
    builder = TwinBuilder(time_step=time_step)
    for number, (name, area) in enumerate(areas.items()):
        (tmp_path / f"{name}.sdf").write_text(ROTOR.format(area=area))
        builder.robot(name, tmp_path / f"{name}.sdf", xyz=(0, 5 * number, 3), rpy=(0, 0, number))
    twin = builder.build()
    for name in areas:
        twin.publish(f"/{name}/joint/shaft/cmd_force", {"data": torque})
    for time in (0.3, 1.0):
        twin.advance_to(time)
        for name, area in areas.items():
            drag = 0.5 * RHO * area * 0.2 * 0.1 * 0.8**3  # ÷ w², as a torque
            expected = sqrt(torque / drag) * tanh(time * sqrt(torque * drag) / inertia)
            assert twin.robot_state(name).velocities[0] == pytest.approx(expected, rel=0.01)


def test_several_wings_are_controllers_of_their_own_and_can_be_turned_off(fly):
    wing = {"a0": 0.1, "cla": 2.0, "cda": 0}
    twin = fly(wing, wing, {**wing, "upward": "0 1 0"})
    (plan,) = twin.built.plans
    assert [item.name for item in plan.controllers] == ["lift_drag", "lift_drag_2", "lift_drag_3"]
    assert twin.control.manager("flyer").switch_controller(deactivate=["lift_drag_2"])
    twin.entities.set_state("flyer", linear=(10.0, 0.0, 0.0))
    twin.advance_to(0.01)
    each = 0.01 * 0.5 * RHO * 100 * 0.2 / 2
    assert twin.entities.state("flyer").linear == pytest.approx((10.0, each, each), abs=1e-9)


def test_a_value_that_cannot_be_names_the_file_and_its_line(fly, tmp_path):
    with pytest.raises(InputError) as caught:
        fly({"area": -2})
    what = "<plugin filename='gz-sim-lift-drag-system'>: <area> is -2, and has to be zero or more."
    assert str(caught.value) == f"{tmp_path}/flyer.sdf:3: {what}"


def test_a_run_goes_on_from_a_snapshot_a_rebuild_and_a_recording_to_the_same_bits(tmp_path, fly):
    twin = fly(MAIN, TAIL, gravity=G, inertia=(0.1, 0.1, 0.2))
    twin.recorder.begin()
    twin.entities.set_state("flyer", linear=(9.0, 1.0, 0.0))
    goes_on_to_the_same_bits(twin, tmp_path)
