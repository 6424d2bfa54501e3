"""What the air and the water do to bodies that nothing drives takes energy from them, and never gives any."""

import numpy as np
import pytest
from flyers import flyer, plugin
from scipy.spatial.transform import Rotation
from test_airships import hull
from waters import box, hydrodynamics, twin_of

STEPS = (0.001, 0.01)
SEEDS = range(6)
SIZE, MASS = (1.0, 0.4, 0.3), 6.0
INERTIA = MASS / 12 * np.array([0.4**2 + 0.3**2, 1.0 + 0.3**2, 1.0 + 0.4**2])
AXES = "xyzkmn"


def wing(folder, random, step):
    """A wing at any place; a moment of its own would be a drive."""
    values = {"a0": random.uniform(-0.1, 0.1), "cla": random.uniform(1, 5), "cda": random.uniform(0.1, 1)}
    place = " ".join(map(str, random.uniform(-0.5, 0.5, 3)))
    more = {"area": random.uniform(0.1, 1.0), "cp": place, "alpha_stall": 0.3}
    return flyer(folder, plugin("LiftDrag", values | more), time_step=step), "flyer", 2.0, (0.5, 0.8, 1.2), np.zeros(6)


def aircraft(folder, random, step):
    """Lift and drag before and behind stall, and a side force that brakes."""
    values = {"CL0": random.uniform(0, 0.3), "CLa": random.uniform(2, 6), "CD0": random.uniform(0.01, 0.1)}
    more = {"AR": 15, "eff": 0.8, "area": 0.6, "alpha_stall": random.uniform(0.2, 0.5)}
    twin = flyer(folder, plugin("AdvancedLiftDrag", values | more), time_step=step)
    return twin, "flyer", 2.0, (0.5, 0.8, 1.2), np.zeros(6)


def airship(folder, random, step):
    """The drag of a hull and the air that it carries, alike on all axes: a coefficient stands for Munk's moment."""
    added = random.uniform(0, 2) * MASS * np.ones(3)
    named = dict(zip(("xx", "yy", "zz"), added, strict=True))
    text = hull(named, axial_drag_coeff=random.uniform(0, 20), force_viscous_coeff=random.uniform(0, 20))
    twin = twin_of(folder, "<gravity>0 0 0</gravity>", step, {"body": (text, (0, 0, 0))})
    inertia = MASS / 12 * np.array([2.0, 10.0, 10.0])
    return twin, "body", MASS, inertia, np.array([*added, 0, 0, 0])


def vehicle(folder, random, step):
    """Damping of both kinds and added mass, from a hundredth to a hundred times the body's."""
    added = np.concatenate([MASS * np.ones(3), INERTIA]) * random.uniform(0, 2, 6)
    strengths = 10.0 ** random.uniform(-2, 2, (2, 6)) * MASS
    elements = {}
    for place, (axis, name) in enumerate(zip(AXES, "UVWPQR", strict=True)):
        elements[f"{axis}Dot{name}"] = -added[place]
        elements[f"{axis}{name}"] = -strengths[0, place]
        elements[f"{axis}{name}abs{name}"] = -strengths[1, place]
    text = box("body", SIZE, mass=MASS, more=hydrodynamics(**elements))
    twin = twin_of(folder, "<gravity>0 0 0</gravity>", step, {"body": (text, (0, 0, 0))})
    return twin, "body", MASS, INERTIA, added


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", [wing, aircraft, airship, vehicle])
def test_energy_of_body_and_fluid_never_grows(tmp_path, kind, seed, step):
    random = np.random.default_rng(seed)
    twin, name, mass, inertia, added = kind(tmp_path, random, step)
    twin.entities.set_state(name, linear=tuple(random.normal(0, 4, 3)), angular=tuple(random.normal(0, 2, 3)))
    masses = np.array([mass] * 3 + [*inertia]) + added

    def energy():
        state = twin.entities.state(name)
        w, *xyz = state.orientation
        in_body = Rotation.from_quat([*xyz, w]).inv()
        velocity = np.concatenate([in_body.apply(state.linear), in_body.apply(state.angular)])
        return masses @ velocity**2 / 2

    found = [energy()]
    for number in range(1, 101):
        twin.advance_to(number / 100)
        found.append(energy())
    assert np.diff(found).max() <= 1e-5 * found[0]
