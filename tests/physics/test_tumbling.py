"""What tumbles in the air keeps its energy and its angular momentum, and turns as Euler's equations say."""

import numpy as np
import pytest
from scenes import ENGINES, G, thing
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from drake_twin import TwinBuilder
from drake_twin.scenario import World

MASS, MOMENTS, SECONDS = 10.0, (1.0, 2.0, 3.0), 10.0
STEPS = {engine: options["time_step"] for engine, options in ENGINES.items() if engine != "cenic"}
every_step = pytest.mark.parametrize("engine", STEPS)


def in_the_air(folder, engine, urdf, gravity=0.0):
    file = folder / "thing.urdf"
    file.write_text(urdf)
    world = World(gravity=(0, 0, -gravity))
    return TwinBuilder(world=world, **ENGINES[engine]).robot("thing", file, xyz=(0, 0, 1000.0))


def body(moments=MOMENTS, products=(0.0, 0.0, 0.0), center=(0.0, 0.0, 0.0)):
    xy, xz, yz = products
    urdf = thing('<box size="0.3 0.2 0.1"/>', MASS, moments, center=center)
    return urdf.replace('ixy="0" ixz="0" iyz="0"', f'ixy="{xy}" ixz="{xz}" iyz="{yz}"')


def motion(twin):
    """The orientation of a body and its angular velocity in its own axes (rad/s)."""
    state = twin.entity_state("thing")
    attitude = Rotation.from_quat(np.roll(state.orientation, -1))
    return attitude, attitude.inv().apply(state.angular)


def halfway(attitude, w, h):
    """The orientation half a step of Drake's before: it turns by 2 atan(h w / 2) in each."""
    speed = np.linalg.norm(w)
    return attitude * Rotation.from_rotvec(-np.arctan(h * speed / 2) * w / speed)


def euler(w, inertia, seconds):
    """The orientation after a time (s) of a body that is not turned at the start, by SciPy."""

    def slope(_, state):
        q, w = Rotation.from_quat(state[:4]), state[4:]
        x, y, z, s = q.as_quat()
        turn = 0.5 * np.array(
            [s * w[0] + y * w[2] - z * w[1], s * w[1] + z * w[0] - x * w[2], s * w[2] + x * w[1] - y * w[0]]
        )
        return [*turn, -0.5 * (x * w[0] + y * w[1] + z * w[2]), *np.linalg.solve(inertia, np.cross(inertia @ w, w))]

    end = solve_ivp(slope, (0.0, seconds), [0, 0, 0, 1, *w], rtol=1e-10, atol=1e-12, method="DOP853").y[:4, -1]
    return Rotation.from_quat(end)


def check_tumbling(figure, folder, engine, w, inertia=None, center=(0.0, 0.0, 0.0)):
    inertia = np.diag(MOMENTS) if inertia is None else inertia
    products = (inertia[0, 1], inertia[0, 2], inertia[1, 2])
    twin = in_the_air(folder, engine, body(np.diag(inertia), products, center), G).build()
    twin.set_entity_state("thing", angular=w, linear=(1.0, 0.0, 3.0))
    h, speed = STEPS[engine], float(np.linalg.norm(w))
    energy = w @ inertia @ w / 2
    momentum = halfway(Rotation.identity(), w, h).apply(inertia @ w)
    energies, errors = [], []
    while twin.time < SECONDS - 1e-9:
        twin.advance_to(twin.time + 0.1)
        attitude, now = motion(twin)
        energies.append(now @ inertia @ now / 2 / energy)
        errors.append(np.linalg.norm(halfway(attitude, now, h).apply(inertia @ now) - momentum))
    about = f"tumbles at {speed:.0f} rad/s for 10 s"
    assert figure(f"{about}: energy ÷ that of its start", max(energies)) < 1.0 + (h * speed) ** 2 / 100
    assert figure(f"{about}: energy ÷ that of its start", min(energies)) > 0.99
    momentum_error = max(errors) / np.linalg.norm(momentum)
    assert figure(f"{about}: error of angular momentum ÷ its length", momentum_error) < 2.5 * (h * speed) ** 2
    away = (attitude * euler(w, inertia, twin.time).inv()).magnitude()
    assert figure(f"{about}: error of orientation (rad)", away) < (h * speed) ** 2 / 6 * speed * SECONDS + h * speed


def about_axis(axis, speed):
    w = np.full(3, 0.02 * speed)
    w[axis] = speed
    return w


@every_step
@pytest.mark.parametrize(("axis", "speed"), [(0, 20.0), (1, 8.0), (1, 20.0)])
def test_what_tumbles_keeps_energy_and_momentum(figure, tmp_path, engine, axis, speed):
    check_tumbling(figure, tmp_path, engine, about_axis(axis, speed))


@pytest.mark.slow
@every_step
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("speed", [2.0, 5.0, 8.0, 12.0, 16.0, 20.0])
def test_what_tumbles_at_any_speed_keeps_energy_and_momentum(figure, tmp_path, engine, axis, speed):
    check_tumbling(figure, tmp_path, engine, about_axis(axis, speed))


@pytest.mark.slow
@every_step
@pytest.mark.parametrize("seed", range(20))
def test_any_body_keeps_energy_and_momentum(tmp_path, engine, seed):
    random = np.random.default_rng(seed)
    a, b = random.uniform(1.0, 2.0, 2)
    axes = Rotation.random(rng=random).as_matrix()
    inertia = axes @ np.diag([a, b, random.uniform(1.001 * abs(a - b), 0.999 * (a + b))]) @ axes.T
    w = random.normal(size=3)
    w *= random.uniform(2.0, 20.0) / np.linalg.norm(w)
    check_tumbling(lambda _, value: value, tmp_path, engine, w, inertia, random.uniform(-0.1, 0.1, 3))
