"""gz-sim's LighterThanAirDynamics on its own: its forces, a link's added mass, and what a file may say."""

from math import atan2, hypot, sin

import numpy as np
import pytest
from controller_parameters import parameters_of
from waters import box, twin_of

from drake_twin.control.airship_hull import AirshipHulls, HullCoefficients
from drake_twin.description.added_mass import fluid_added_mass
from drake_twin.description.gazebo_drive import LIGHTER_THAN_AIR
from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.errors import InputError

HULL = HullCoefficients(1.2, -0.3, 0.5, 0.4, -0.6, 0.8, 0.7)
NUMBERS = dict(
    zip(
        ("force_inviscid_coeff", "force_viscous_coeff", "moment_inviscid_coeff", "moment_viscous_coeff", "eps_v"),
        (0.1, 0.2, 0.3, 0.4, 0.5),
        strict=True,
    ),
    axial_drag_coeff=0.6,
)


def test_the_forces_are_those_of_the_angle_of_attack():
    """Independently, with sines of the angle, as in the references of gz-sim's system."""
    p, q, r, u, v, w = velocity = np.array([0.2, 0.3, -0.1, 2.0, 0.5, -0.4])
    (found,), _ = AirshipHulls([HULL]).calc(velocity[None])
    x, y, z = u, v - 0.8 * r, w + 0.8 * q  # of a point 0.8 m behind the origin
    pressure, angle = 0.6 * (x * x + y * y + z * z), atan2(hypot(y, z), x)
    force = pressure * (0.3 * sin(2 * angle) + 0.5 * sin(angle) ** 2)
    moment = pressure * (-0.4 * sin(2 * angle) - 0.6 * sin(angle) ** 2)
    along = np.array([y, z]) / hypot(y, z)
    assert found[4:] == pytest.approx(-force * along)
    assert found[:3] == pytest.approx((0, moment * along[1], -moment * along[0]))
    assert found[3] == pytest.approx(-0.6 * 0.7 * (u * u + v * v + w * w) * u * u / (u * u + w * w))
    assert p == 0.2


def test_the_slope_is_the_derivative_and_rest_has_none():
    velocity = np.array([[0.2, 0.3, -0.1, 2.0, 0.5, -0.4]])
    hulls = AirshipHulls([HULL])
    _, (slope,) = hulls.calc(velocity)
    change = 1e-4 * np.array([[1, -2, 3, 2, -1, 1]])
    moved = (hulls.calc(velocity + change)[0] - hulls.calc(velocity - change)[0]) / 2
    assert -slope @ change[0] == pytest.approx(moved[0], rel=1e-4, abs=1e-9)
    still, flat = hulls.calc(np.zeros((1, 6)))
    assert not still.any()
    assert np.abs(flat).max() < 1e-5


def added_of(inertial):
    text = f'<sdf><model name="m"><link name="l"><inertial>{inertial}</inertial></link></model></sdf>'
    return fluid_added_mass(text, "l", PluginReader(GazeboPlugin("", "")))


def test_added_mass_is_read_as_a_symmetric_matrix():
    added = added_of("<fluid_added_mass><xx>1</xx><yr>0.5</yr><pp>2</pp></fluid_added_mass>")
    expected = np.zeros((6, 6))
    expected[3, 3], expected[4, 2], expected[2, 4], expected[0, 0] = 1, 0.5, 0.5, 2
    assert added.tolist() == expected.tolist()
    assert added_of("<mass>1</mass>") is None


def test_added_mass_about_the_center_of_mass_is_moved_to_the_links_origin():
    """Of the same mass on all sides, 0.3 m above the origin, it has the moments that Steiner's theorem says."""
    mass = "".join(f"<{tag}>2</{tag}>" for tag in ("xx", "yy", "zz"))
    added = added_of(f"<pose>0 0 0.3 0.5 0 0</pose><fluid_added_mass>{mass}</fluid_added_mass>")
    assert np.diag(added) == pytest.approx([2 * 0.09, 2 * 0.09, 0, 2, 2, 2])
    assert added[1, 3] == pytest.approx(2 * 0.3)  # a pitch moves the center forwards


def test_added_mass_of_another_size_is_refused():
    with pytest.raises(InputError, match="fluid_added_mass has to have 36 numbers"):
        parameters_of(LIGHTER_THAN_AIR, link_name="palm", fluid_added_mass=[0.0] * 35, **NUMBERS)


def built(folder, added="<fluid_added_mass><xx>1</xx></fluid_added_mass>", **elements):
    values = {"link_name": "hull", **NUMBERS, **elements}
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items() if value is not None)
    name = "gz::sim::systems::LighterThanAirDynamics"
    plugin = f'\n<plugin filename="gz-sim-lighter_than_air_dynamics-system" name="{name}">{own}</plugin>'
    text = box("blimp", (3, 1, 1), mass=6, more=plugin).replace("</inertial>", f"{added}</inertial>", 1)
    return twin_of(folder, "", 0.01, {"blimp": (text, (0, 0, 0))})


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"air_density": -1}, "<air_density> is -1, and has to be zero or more"),
        ({"eps_v": "long"}, "<eps_v> is 'long', which is not a number"),
        (
            {"added": "<fluid_added_mass><xy>two</xy></fluid_added_mass>"},
            "<xy> of the link's added mass is 'two', which is not a number",
        ),
    ],
    ids=("density", "number", "mass"),
)
def test_values_that_are_refused_with_file_and_line(tmp_path, elements, says):
    with pytest.raises(InputError) as refusal:
        built(tmp_path, **elements)
    assert str(refusal.value).startswith(f"{tmp_path / 'blimp.sdf'}:4: ")
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"link_name": "gondola"}, "the robot has no link 'gondola'"),
        ({"moment_viscous_coeff": None}, "<moment_viscous_coeff> is missing"),
        ({"added": ""}, "link 'hull' has no <fluid_added_mass>"),
    ],
    ids=("link", "coefficient", "mass"),
)
def test_what_does_nothing_in_gazebo_is_said(tmp_path, elements, says):
    (finding,) = [str(item) for item in built(tmp_path, **elements).findings if "lighter" in str(item)]
    assert says in finding


def test_nothing_is_said_of_a_hull_that_works(tmp_path):
    assert not [item for item in built(tmp_path).findings if "air" in item.what or "added" in item.what]
