"""gz-sim's Hydrodynamics beside mechanics: added mass, decays, terminal velocities, currents and momentum."""

from math import exp, pi, sqrt

import numpy as np
import pytest
from repeated_runs import goes_on_to_the_same_bits
from scipy.spatial.transform import Rotation
from waters import WATER, G, box, buoyancy, height, hydrodynamics, period_of, roll, sampled, twin_of

from drake_twin.messages.interface_types import make

STEPS = (0.001, 0.01)
SIZE = (1.0, 0.4, 0.3)
VOLUME = 0.12
MASS = VOLUME * WATER
LEVEL = {"x": (0, pi / 2, 0), "y": (pi / 2, 0, 0), "z": (0, 0, 0)}  # so that the axis is vertical
VELOCITIES = dict(zip("xyzkmn", "UVWPQR", strict=True))


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def vehicle(folder, step, density=WATER, rpy=(0, 0, 0), **elements):
    """A box of a density in water, in which it has gz-sim's Hydrodynamics."""
    text = box("auv", SIZE, density, more=hydrodynamics(**elements))
    return twin_of(folder, buoyancy(), step, {"auv": (text, (0, 0, 0), rpy)})


def motion(twin):
    """Rotation to the world, velocity and angular velocity in the world."""
    state = twin.entities.state("auv")
    w, x, y, z = state.orientation
    return Rotation.from_quat([x, y, z, w]).as_matrix(), np.array(state.linear), np.array(state.angular)


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("ratio", [0.5, 20.0])
def test_a_light_body_rises_as_if_water_were_part_of_its_mass(tmp_path, step, axis, ratio):
    added = ratio * MASS
    rpy = LEVEL[axis]
    twin = vehicle(tmp_path, step, 0.8 * WATER, rpy, **{f"{axis}Dot{VELOCITIES[axis]}": -added, "disable_coriolis": 1})
    twin.advance_to(1.0)
    assert motion(twin)[1] == pytest.approx((0, 0, 0.2 * MASS * G / (0.8 * MASS + added)), rel=1e-6, abs=1e-9)


def test_a_push_moves_the_water_with_the_body(tmp_path, step):
    twin = vehicle(tmp_path, step, rpy=(0.3, 0.2, 0.4), xDotU=-2 * MASS, yDotV=-2 * MASS, zDotW=-2 * MASS)
    twin.entities.apply_wrench("auv", force=(30, -20, 10), duration=1.0)
    twin.advance_to(2.0)
    assert motion(twin)[1] == pytest.approx(np.array([30, -20, 10]) / (3 * MASS), rel=1e-3)


def test_another_mass_answers_as_that_mass(tmp_path):
    twin = vehicle(tmp_path, 0.01, zDotW=-MASS)
    twin.entities.set_values({"auv.hull.mass": 2 * MASS})
    twin.advance_to(0.5)
    assert motion(twin)[1][2] == pytest.approx(-0.5 * MASS * G / (3 * MASS), rel=1e-6)


def test_without_added_mass_it_rises_by_its_own(tmp_path):
    twin = vehicle(tmp_path, 0.01, 0.8 * WATER, zDotW=-300, disable_added_mass="true")
    twin.advance_to(0.5)
    assert motion(twin)[1][2] == pytest.approx(0.5 * 0.25 * G, rel=1e-6)


@pytest.mark.parametrize("axis", "xyz")
def test_linear_damping_lets_a_velocity_decay_exponentially(tmp_path, step, axis):
    name, place = VELOCITIES[axis], "xyz".index(axis)
    twin = vehicle(tmp_path, step, **{f"{axis}{name}": -2 * MASS, f"{axis}Dot{name}": -MASS / 3})
    twin.entities.set_state("auv", linear=tuple(np.eye(3)[place]))
    twin.advance_to(1.0)
    assert motion(twin)[1][place] == pytest.approx(exp(-2 / (4 / 3)), rel=1e-3)


def test_cenic_takes_its_own_steps_through_the_same_water(tmp_path):
    """It rises against linear damping: v = s (1 - exp(-t c / (m + mₐ)))."""
    text = box("auv", SIZE, 0.8 * WATER, more=hydrodynamics(zW=-2 * MASS, zDotW=-MASS))
    twin = twin_of(tmp_path, buoyancy(), 0.01, {"auv": (text, (0, 0, 0))}, engine="cenic")
    twin.advance_to(0.5)
    assert motion(twin)[1][2] == pytest.approx(0.2 * G / 2 * (1 - exp(-0.5 * 2 / 1.8)), rel=0.01)


def test_quadratic_damping_lets_a_velocity_decay_as_a_hyperbola(tmp_path, step):
    twin = vehicle(tmp_path, step, xUabsU=-1.5 * MASS)
    twin.entities.set_state("auv", linear=(-2, 0, 0))
    twin.advance_to(1.0)
    assert motion(twin)[1][0] == pytest.approx(-2 / (1 + 1.5 * 2), rel=1e-3)


def test_a_rotation_decays_with_the_inertia_of_body_and_water(tmp_path, step):
    inertia = MASS / 12 * (SIZE[0] ** 2 + SIZE[1] ** 2)
    twin = vehicle(tmp_path, step, nR=-2 * inertia, nDotR=-inertia)
    twin.entities.set_state("auv", angular=(0, 0, 0.5))
    twin.advance_to(1.0)
    assert motion(twin)[2] == pytest.approx((0, 0, 0.5 * exp(-1)), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("stiffness", [10.0, 5000.0])
def test_it_sinks_at_its_terminal_velocity_whatever_the_step(tmp_path, step, stiffness):
    """By linear damping, and by quadratic; of 5000/s a step of 10 ms is fifty times as long as the time constant."""
    weight, linear = 0.5 * MASS * G, stiffness * 1.5 * MASS
    twin = vehicle(tmp_path, step, 1.5 * WATER, zW=-linear)
    twin.advance_to(0.8)
    assert motion(twin)[1][2] == pytest.approx(-weight / linear, rel=1e-3)
    twin = vehicle(tmp_path, step, 1.5 * WATER, zWabsW=-linear, zDotW=-MASS)
    twin.advance_to(1.3)
    assert motion(twin)[1][2] == pytest.approx(-sqrt(weight / linear), rel=1e-3)


def test_damping_of_any_size_stops_it_and_never_turns_it_round(tmp_path, step):
    twin = vehicle(tmp_path, step, xU=-1e6 * MASS, yVabsV=-1e6 * MASS, mQ=-1e6)
    twin.entities.set_state("auv", linear=(1, 1, 0), angular=(0, 0.5, 0))
    _, found = sampled(twin, lambda: np.concatenate(motion(twin)[1:]), 0.1)
    assert found[1:].min() > -1e-6
    assert found[-1, [0, 4]] == pytest.approx(0, abs=1e-6)
    assert found[-1, 1] < 0.1


def test_a_turned_body_drifts_with_the_current_that_the_file_and_then_a_message_say(tmp_path, step):
    elements = {f"{axis}{name}": -3 * MASS for axis, name in VELOCITIES.items()}
    rpy = (0.3, 0.4, 0.5)
    twin = vehicle(tmp_path, step, WATER, rpy, default_current="0.4 -0.2 0.1", namespace="sub", **elements)
    twin.advance_to(1.0)
    assert motion(twin)[1] == pytest.approx(np.array([0.4, -0.2, 0.1]) * (1 - exp(-3)), rel=2e-3)
    twin.publish("/auv/ocean_current", make("geometry_msgs/msg/Vector3", {"x": -0.3, "y": 0.0, "z": 0.0}))
    twin.advance_to(3.0)
    assert motion(twin)[1] == pytest.approx((-0.3, 0, 0), abs=2e-3)


def test_a_current_pushes_a_body_with_added_mass_no_harder_than_its_damping_does(tmp_path, step):
    """Added mass resists the acceleration alone: without damping nothing moves, however it turns."""
    twin = vehicle(tmp_path, step, default_current="0.5 0 0", xDotU=-MASS, yDotV=-MASS, zDotW=-MASS)
    twin.entities.set_state("auv", angular=(0.2, 0, 1.0))
    twin.advance_to(1.0)
    assert motion(twin)[1] == pytest.approx(0, abs=1e-6)


ADDED = {"xDotU": -0.1 * MASS, "yDotV": -0.9 * MASS, "zDotW": -1.5 * MASS, "kDotP": -1.0, "mDotQ": -6.0, "nDotR": -4.0}


def test_body_and_water_keep_their_momentum_and_energy_in_the_world(tmp_path):
    """Kirchhoff's equations without damping, which hold only with the Coriolis forces of the right sign."""
    twin = vehicle(tmp_path, 0.001, **ADDED)
    twin.entities.set_state("auv", linear=(0.3, 0.2, -0.1), angular=(0.4, -0.3, 0.5))
    own = np.array([0.1, 0.9, 1.5]) * MASS + MASS
    x, y, z = SIZE
    turning = MASS / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y]) + [1.0, 6.0, 4.0]

    def kept():
        R, v, w = motion(twin)
        momentum = R @ (own * (R.T @ v))
        angular = R @ (turning * (R.T @ w)) + np.cross(twin.entities.state("auv").position, momentum)
        energy = own @ (R.T @ v) ** 2 / 2 + turning @ (R.T @ w) ** 2 / 2
        return np.array([*momentum, *angular, energy])

    start = kept()
    _, found = sampled(twin, kept, 2.0, 0.1)
    scale = np.array([np.linalg.norm(start[:3])] * 3 + [np.linalg.norm(start[3:6])] * 3 + [start[6]])
    assert np.abs((found - start) / scale).max() < 0.01


def test_without_coriolis_forces_the_water_does_not_turn_a_body_that_moves_askew(tmp_path):
    """Munk's moment, (m_x - m_y) u v, is theirs."""
    for disabled, moment in ((0, 0.8 * MASS * 0.2 * 0.3), (1, 0.0)):
        twin = vehicle(tmp_path, 0.001, disable_coriolis=disabled, **(ADDED | {"nDotR": 0.0}))
        twin.entities.set_state("auv", linear=(0.3, 0.2, 0.0))
        twin.advance_to(0.05)
        inertia = MASS / 12 * (SIZE[0] ** 2 + SIZE[1] ** 2)
        assert motion(twin)[2][2] == pytest.approx(-moment / inertia * 0.05, rel=0.01, abs=1e-9)


def test_it_swings_upright_with_the_inertia_of_the_water_too(tmp_path, step):
    """Buoyancy acts above its center of mass by d: ω² = m g d / (I + Iₐ)."""
    offset = f"<pose>0 0 0.2 0 0 0</pose><geometry><box><size>{SIZE[0]} {SIZE[1]} {SIZE[2]}</size></box></geometry>"
    text = box("auv", SIZE, WATER, more=hydrodynamics(kDotP=-4.0))
    text = text.replace(text[text.index("<geometry>") : text.index("</collision>")], offset)
    twin = twin_of(tmp_path, buoyancy(), step, {"auv": (text, (0, 0, 0), (0.03, 0, 0))})
    times, angles = sampled(twin, lambda: roll(twin, "auv"), 2.0, 0.02)
    inertia = MASS / 12 * (SIZE[1] ** 2 + SIZE[2] ** 2) + 4.0
    assert period_of(times, angles) == pytest.approx(2 * pi * sqrt(inertia / (MASS * G * 0.2)), rel=0.01)


def _with_fin(joint, link, **elements):
    """A box whose fin of 10 g carries the water's forces, or the box itself."""
    fin = f"""<link name="fin"><inertial><mass>0.01</mass><inertia><ixx>1e-5</ixx><iyy>1e-5</iyy><izz>1e-5</izz>
</inertia></inertial></link><joint name="j" type="{joint}"><parent>hull</parent><child>fin</child>
<axis><xyz>0 0 1</xyz></axis></joint>"""
    return box("auv", SIZE, WATER, more=fin + hydrodynamics(link, **elements))


@pytest.mark.parametrize("joint", ["fixed", "continuous"])
def test_a_light_link_brakes_all_that_it_is_jointed_to(tmp_path, step, joint):
    twin = twin_of(tmp_path, buoyancy(), step, {"auv": (_with_fin(joint, "fin", xU=-2 * MASS), (0, 0, 0))})
    twin.entities.set_state("auv", linear=(1, 0, 0))
    twin.advance_to(1.0)
    assert motion(twin)[1][0] == pytest.approx(exp(-2), rel=2e-3)


def test_two_links_of_one_robot_share_its_mass(tmp_path, step):
    """Each brakes with 1000/s: in a step of 10 ms each alone would stop it, and both must not turn it round."""
    more = hydrodynamics("hull", xU=-1000 * MASS)
    text = _with_fin("fixed", "fin", xU=-1000 * MASS).replace("</model>", f"{more}</model>")
    twin = twin_of(tmp_path, buoyancy(), step, {"auv": (text, (0, 0, 0))})
    twin.entities.set_state("auv", linear=(1, 0, 0))
    _, found = sampled(twin, lambda: motion(twin)[1][0], 0.1)
    assert found[1] < 0.05
    assert found[1:].min() > -1e-6


def test_a_pendulum_on_the_world_creeps_down_against_strong_damping(tmp_path, step):
    """c θ' = -m g d sin θ from the horizontal: tan(θ/2) = exp(-t m g d / c). The damping's time constant is 10 ms."""
    arm, damping = 0.3, 20 * 9.0
    text = f"""<model name="auv"><link name="post"/><joint name="foot" type="fixed"><parent>world</parent>
<child>post</child></joint><link name="hull"><inertial><pose>{arm} 0 0 0 0 0</pose><mass>20</mass>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
<joint name="hinge" type="continuous"><parent>post</parent><child>hull</child><axis><xyz>0 1 0</xyz></axis></joint>
{hydrodynamics(mQ=-damping)}</model>"""
    twin = twin_of(tmp_path, "", step, {"auv": (text, (0, 0, 2))})
    twin.advance_to(2.0)
    w, x, y, z = twin.entities.state("auv::hull").orientation
    sunk = -Rotation.from_quat([x, y, z, w]).as_matrix()[2, 0]  # the cosine of the angle from below
    angle = np.arccos(sunk)
    assert np.tan(angle / 2) == pytest.approx(exp(-2.0 * 20 * G * arm / damping), rel=0.01)


def test_a_replay_and_a_restored_twin_repeat_the_motion_to_the_last_bit(tmp_path):
    twin = vehicle(tmp_path, 0.01, 0.9 * WATER, (0.3, 0.2, 0.1), xU=-30, zWabsW=-90, **ADDED)
    twin.recorder.begin()
    twin.advance_to(0.5)
    twin.publish("/ocean_current", make("geometry_msgs/msg/Vector3", {"x": 0.5, "y": 0.0, "z": 0.0}))
    goes_on_to_the_same_bits(twin, tmp_path, 0.7)
    assert height(twin, "auv") > 0


# Ellipsoids of 1 m × 0.5 m × 0.5 m (half axes) and 1025 kg/m³ in fluids of 1025, 102.5 and 10250 kg/m³, by Lamb's
# coefficients. After 1 s of a force and a torque about (1, 1, 0), from rest: where an independent integration has them,
# as gz-sim's integration test added_mass.cc gives it: place, angle, axis, velocity, angular velocity.
ELLIPSOIDS = [
    (
        1.0,
        (0.1615036362557803, 0.10710173528687592, -0.0024940422102210013),
        0.31351100787675423,
        (0.9487133476959254, 0.2967465880246766, -0.10901580802481375),
        (0.32087488227940963, 0.212772641112832, -0.010283659814296216),
        (0.0031500380024329826, 0.0022451901112414984, -0.052564274312245286),
    ),
    (
        0.1,
        (0.19339397146633158, 0.18238590690754014, -0.0006146904921505786),
        0.3185857744101227,
        (0.9309057658841812, 0.3615623345327693, -0.051837566405069514),
        (0.386607475883442, 0.36477533916100213, -0.002544369239292084),
        (0.0005006537195657914, 0.0007044864197475587, -0.012889587224151892),
    ),
    (
        10.0,
        (0.0616809222579082, 0.020951194425796703, -0.0006836779301496875),
        0.2990323477528498,
        (0.992866493007573, 0.11317163977508175, -0.03752741682373132),
        (0.12296544056644206, 0.04157265120194949, -0.002832810385198371),
        (0.0017159692398096078, 0.00022402938638815302, -0.014274584996716126),
    ),
]


@pytest.mark.parametrize("by_plugin", [True, False])
@pytest.mark.parametrize(("fluid", "place", "angle", "axis", "linear", "angular"), ELLIPSOIDS)
def test_ellipsoids_are_where_gz_sims_own_test_has_them(
    tmp_path, fluid, place, angle, axis, linear, angular, by_plugin
):
    """Within that test's bounds, with the plugin's added mass and with that of SDF itself."""
    mass = 4 / 3 * pi * 0.25 * 1025
    moments = dict(zip("xyz", (mass / 10, mass / 4, mass / 4), strict=True))
    inertia = "".join(f"<i{name}{name}>{value}</i{name}{name}>" for name, value in moments.items())
    along, across, turning = fluid * 236.14304779483277, fluid * 901.6370915802705, fluid * 64.40264939859075
    own, plugin = "", ""
    if by_plugin:
        plugin = hydrodynamics(xDotU=-along, yDotV=-across, zDotW=-across, mDotQ=-turning, nDotR=-turning)
    else:
        values = {"xx": along, "yy": across, "zz": across, "qq": turning, "rr": turning}
        own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items())
        own = f"<fluid_added_mass>{own}</fluid_added_mass>"
    inertial = f"<inertial><mass>{mass}</mass><inertia>{inertia}</inertia>{own}</inertial>"
    text = f'<model name="auv"><link name="hull">{inertial}</link>{plugin}</model>'
    twin = twin_of(tmp_path, "<gravity>0 0 0</gravity>", 0.001, {"auv": (text, (0, 0, 0))})
    for step in range(1, 1001):
        force, torque = 2000 * np.sin(0.003 * pi * step), 200 * np.sin(0.002 * pi * step)
        twin.entities.apply_wrench("auv", force=(force, force, 0), torque=(torque, torque, 0), duration=0.001)
        twin.advance_to(step / 1000)
    R, v, w = motion(twin)
    turned = Rotation.from_matrix(R).as_rotvec()
    assert twin.entities.state("auv").position == pytest.approx(place, abs=1e-3)
    assert np.linalg.norm(turned) == pytest.approx(angle, abs=1e-5)
    assert turned / np.linalg.norm(turned) == pytest.approx(axis, abs=1e-4)
    assert v == pytest.approx(linear, abs=2e-5)
    assert w == pytest.approx(angular, abs=1e-4)
