"""``<fluid_added_mass>`` of links beside mechanics: pushes, falls, coupled axes, momentum and energy."""

import numpy as np
import pytest
from repeated_runs import goes_on_to_the_same_bits
from scipy.spatial.transform import Rotation
from sdf_worlds import refusal
from waters import G, box, sampled, twin_of

from drake_twin.errors import InputError

SIZE, MASS = (1.0, 0.4, 0.3), 2.0
INERTIA = MASS / 12 * np.array([0.4**2 + 0.3**2, 1.0 + 0.3**2, 1.0 + 0.4**2])
AXES = "xyzpqr"
STEPS = pytest.mark.parametrize("step", [0.001, 0.01])


def body(name="b", **added):
    """SDF of a box with added mass: ``xx`` and so on (kg, kg·m, kg·m²)."""
    inside = "".join(f"<{tag}>{value}</{tag}>" for tag, value in added.items())
    text = box(name, SIZE, mass=MASS)
    return text.replace("</mass>", f"</mass>\n<fluid_added_mass>{inside}</fluid_added_mass>")


def drifting(folder, text, step=0.001, **options):
    """A twin of a model in a world without gravity."""
    return twin_of(folder, f"<gravity>0 0 0</gravity>{text}", step, **options)


def velocity(twin, name="b"):
    return np.array(twin.entities.state(name).linear)


@STEPS
@pytest.mark.parametrize("ratio", [0.2, 30.0])
def test_a_push_moves_the_fluid_too(tmp_path, step, ratio):
    twin = drifting(tmp_path, body(xx=ratio * MASS, zz=MASS), step)
    twin.entities.apply_wrench("b", force=(6, 0, 0), duration=1.0)
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx((6 / (MASS * (1 + ratio)), 0, 0), rel=1e-6, abs=1e-9)
    assert twin.findings == ()


@STEPS
def test_weight_is_that_of_the_link_alone(tmp_path, step):
    twin = twin_of(tmp_path, body(zz=3 * MASS), step)
    twin.advance_to(0.5)
    assert velocity(twin) == pytest.approx((0, 0, -G * 0.5 / 4), rel=1e-6, abs=1e-9)


@STEPS
def test_axes_that_are_coupled_answer_together(tmp_path, step):
    """The acceleration is that of the whole matrix, (M + M_A)⁻¹ F."""
    added = {"xx": 1.0, "xy": 0.8, "yy": 2.0, "zr": 0.1, "rr": 0.3, "zz": 0.5}
    twin = drifting(tmp_path, body(**added), step)
    twin.entities.apply_wrench("b", force=(3, 0, 2), duration=step)
    twin.advance_to(step)
    matrix = np.diag([MASS, MASS, MASS, *INERTIA])
    for tag, value in added.items():
        i, j = map(AXES.index, tag)
        matrix[i, j] += value
        matrix[j, i] += value * (i != j)
    wanted = np.linalg.solve(matrix, [3, 0, 2, 0, 0, 0]) * step
    state = twin.entities.state("b")
    assert [*state.linear, *state.angular] == pytest.approx(wanted, rel=1e-4, abs=1e-9)


def test_body_and_fluid_keep_their_momentum_and_energy(tmp_path):
    """Kirchhoff's equations of a body that tumbles."""
    added = dict(zip(("xx", "yy", "zz", "pp", "qq", "rr"), (0.2, 1.8, 3.0, 0.1, 0.3, 0.2), strict=True))
    twin = drifting(tmp_path, body(**added))
    twin.entities.set_state("b", linear=(0.3, 0.2, -0.1), angular=(0.4, -0.3, 0.5))
    own = MASS + np.array([0.2, 1.8, 3.0])
    turning = INERTIA + np.array([0.1, 0.3, 0.2])

    def kept():
        state = twin.entities.state("b")
        w, x, y, z = state.orientation
        R = Rotation.from_quat([x, y, z, w]).as_matrix()
        v, omega = R.T @ state.linear, R.T @ state.angular
        momentum = R @ (own * v)
        angular = R @ (turning * omega) + np.cross(state.position, momentum)
        return np.array([*momentum, *angular, own @ v**2 / 2 + turning @ omega**2 / 2])

    start = kept()
    _, found = sampled(twin, kept, 2.0, 0.1)
    scale = np.array([np.linalg.norm(start[:3])] * 3 + [np.linalg.norm(start[3:6])] * 3 + [start[6]])
    assert np.abs((found - start) / scale).max() < 0.01


@pytest.mark.parametrize("as_robot", [False, True])
def test_a_link_of_a_model_inside_another_one_has_its_own(tmp_path, as_robot):
    inner = body("in", xx=MASS).replace('<link name="hull">', '<link name="keel">', 1)
    outer = box("out", SIZE, mass=MASS)
    joint = '<joint name="j" type="fixed"><parent>hull</parent><child>in::keel</child></joint>'
    text = outer.replace("</model>", f"{inner}{joint}</model>")
    robots = {"out": (text, (0, 0, 0))} if as_robot else None
    twin = drifting(tmp_path, "" if as_robot else text, robots=robots)
    twin.entities.apply_wrench("out", force=(6, 0, 0), duration=1.0)
    twin.advance_to(1.0)
    assert velocity(twin, "out")[0] == pytest.approx(6 / (3 * MASS), rel=1e-3)


def test_a_robot_has_it_and_another_mass_answers_as_that(tmp_path):
    twin = twin_of(tmp_path, "", robots={"b": (body(zz=MASS), (0, 0, 5))})
    assert twin.findings == ()
    twin.entities.set_values({"b.hull.mass": 2 * MASS})
    twin.advance_to(0.5)
    assert velocity(twin)[2] == pytest.approx(-G * 0.5 * 2 / 3, rel=1e-6)


def test_a_run_repeats_to_the_same_bits(tmp_path):
    twin = drifting(tmp_path, body(xx=1.0, xy=0.5, yy=2.0), 0.01)
    twin.recorder.begin()
    twin.entities.set_state("b", linear=(0.3, 0.2, -0.1), angular=(0.4, -0.3, 0.5))
    goes_on_to_the_same_bits(twin, tmp_path)


def test_a_world_without_it_has_no_such_forces(tmp_path):
    twin = drifting(tmp_path, body(xx=0.0))
    assert not twin.diagram.HasSubsystemNamed("forces/on_links")


def test_numbers_that_are_none_are_refused_with_their_line(tmp_path):
    said = refusal(drifting, tmp_path, body(xx="much"))
    assert said.startswith(f"{tmp_path / 'water.sdf'}:3: ")
    assert "xx is 'much', which is not a number" in said


def test_one_that_takes_all_of_the_mass_is_refused(tmp_path):
    with pytest.raises(InputError, match="model 'b': the added mass of link 'hull' is negative and takes all"):
        drifting(tmp_path, body(xx=-2 * MASS))
