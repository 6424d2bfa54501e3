"""What tumbles in the air keeps its energy and its angular momentum, and turns as Euler's equations say."""

import numpy as np
import pytest
from conftest import ROVER
from pydrake.systems.primitives import ConstantValueSource
from scenes import ENGINES, G, box, sphere, thing, velocity
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
    state = twin.entities.state("thing")
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
    twin.entities.set_state("thing", angular=w, linear=(1.0, 0.0, 3.0))
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


@pytest.mark.one_plant
@every_step
@pytest.mark.parametrize(("values", "scale"), [({"izz": 1.5}, None), ({"mass": 20.0}, 1.0), ({"inertia": 3.0}, 3.0)])
def test_the_moments_follow_inertias_that_are_varied(tmp_path, engine, values, scale):
    twin = in_the_air(tmp_path, engine, body()).build()
    twin.entities.set_values({f"thing.body.{name}": value for name, value in values.items()})
    before = twin.snapshot()
    w = np.array([2.0, 8.0, 3.0])
    for _ in range(2):
        twin.entities.set_state("thing", angular=w)
        assert moment(twin) == pytest.approx(0.0 if scale is None else scale * moment_of(w, STEPS[engine]), rel=0.01)
        twin.restore(before)
    twin.entities.set_values({})
    twin.entities.set_state("thing", angular=w)
    assert moment(twin) == pytest.approx(moment_of(w, STEPS[engine]), rel=0.01)
    if scale is not None:
        start = inertia_energy(twin, w)
        twin.entities.set_values({f"thing.body.{name}": value for name, value in values.items()})
        twin.advance_to(5.0)
        assert inertia_energy(twin, motion(twin)[1]) == pytest.approx(start, rel=1e-3)


def moment(twin):
    """What the systems add about the body's x axis (N·m)."""
    port = twin.plant.get_applied_spatial_force_input_port()
    forces = port.Eval(twin.plant.GetMyContextFromRoot(twin.context))
    return sum(force.F_Bq_W.rotational()[0] for force in forces)


def moment_of(w, h, moments=MOMENTS):
    """That moment: what lacks to a fine integration of Euler's equations over a step, up to its third order (N·m)."""
    inertia = np.diag(moments)
    fine = solve_ivp(
        lambda _, w: np.linalg.solve(inertia, np.cross(inertia @ w, w)), (0.0, h), w, rtol=1e-12, atol=1e-14
    )
    return (inertia @ (fine.y[:, -1] - w) / h - np.cross(inertia @ w, w))[0]


def inertia_energy(twin, w):
    return w @ np.diag(MOMENTS) @ w / 2


@every_step
def test_a_wrench_acts_beside_the_moments(tmp_path, engine):
    twin = in_the_air(tmp_path, engine, body()).build()
    twin.entities.set_state("thing", angular=(0.1, 8.0, 0.1))
    twin.entities.apply_wrench("thing", force=(5.0, 0.0, 0.0), duration=1.0)
    twin.advance_to(2.0)
    assert velocity(twin, "thing") == pytest.approx((5.0 / MASS, 0.0, 0.0), abs=1e-9)
    assert motion(twin)[1] @ np.diag(MOMENTS) @ motion(twin)[1] == pytest.approx(128.04, rel=1e-3)


@every_step
def test_what_tumbles_is_repeatable(tmp_path, engine):
    def tumbling():
        builder = in_the_air(tmp_path, engine, body(), G)
        twin = builder.robot("other", tmp_path / "thing.urdf", xyz=(2, 0, 1000.0)).build()
        twin.entities.set_state("thing", angular=(0.1, 8.0, 0.1))
        return twin

    once, again, rebuilt = tumbling(), tumbling(), tumbling()
    once.advance_to(0.5)
    middle = once.snapshot()
    for twin in (once, again):
        twin.advance_to(1.0)
    assert once.state_sha256() == again.state_sha256()
    once.restore(middle)
    once.advance_to(1.0)
    assert once.state_sha256() == again.state_sha256()
    rebuilt.advance_to(0.5)
    rebuilt.entities.delete("other")
    rebuilt.advance_to(1.0)
    assert rebuilt.entities.state("thing") == again.entities.state("thing")


def tumbling_systems(builder):
    return [system.get_name() for system in builder.build().diagram.GetSystems() if "tumbling" in system.get_name()]


@pytest.mark.one_plant
def test_only_loose_bodies_of_unequal_moments_have_moments(tmp_path):
    assert tumbling_systems(in_the_air(tmp_path, "1ms", body()))
    assert not tumbling_systems(in_the_air(tmp_path, "cenic", body()))
    assert not tumbling_systems(in_the_air(tmp_path, "1ms", sphere(0.1)))
    assert not tumbling_systems(in_the_air(tmp_path, "1ms", box((0.2, 0.2, 0.2))))
    assert not tumbling_systems(TwinBuilder().robot("rover", ROVER, xyz=(0, 0, 0.13)))
    fixed = body().replace("</robot>", '<link name="world"/><joint name="j" type="fixed"><parent link="world"/>')
    assert not tumbling_systems(in_the_air(tmp_path, "1ms", f'{fixed}<child link="body"/></joint></robot>'))
    two = body().replace("</robot>", '<link name="more"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/>')
    two += '</inertial></link><joint name="j" type="{}"><parent link="body"/><child link="more"/>'
    two += '<origin xyz="1 0 0"/><limit effort="1" velocity="1"/></joint></robot>'
    assert tumbling_systems(in_the_air(tmp_path, "1ms", two.format("fixed")))
    assert not tumbling_systems(in_the_air(tmp_path, "1ms", two.format("continuous")))


def test_a_users_forces_come_first_and_a_finding_says_so(tmp_path):
    def extend(builder, parts):
        port = parts.plant.get_applied_spatial_force_input_port()
        builder.Connect(builder.AddSystem(ConstantValueSource(port.Allocate())).get_output_port(), port)

    twin = in_the_air(tmp_path, "1ms", body()).system(extend).build()
    (finding,) = (item for item in twin.findings if "applied_spatial_force" in item.what)
    assert "thing::body gain energy where they tumble" in finding.what
