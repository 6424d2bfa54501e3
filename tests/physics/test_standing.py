"""Things of any shape that stand on any of their sides: they stay, and sink in by less than a hair."""

from math import atan, cos, radians, sin

import mujoco
import numpy as np
import pytest
import trimesh
from scenes import (
    ENGINES,
    G,
    Scene,
    box,
    every_engine,
    on_slope,
    plane,
    position,
    static,
    static_box,
    static_mesh,
    thing,
)
from standing import GROUNDS, standing

NAMED = {  # sides (m) and mass (kg)
    "book": ((0.03, 0.15, 0.22), 0.5),
    "domino": ((0.008, 0.024, 0.048), 0.01),
    "phone": ((0.008, 0.07, 0.15), 0.2),
    "door panel": ((0.04, 0.8, 2.0), 20.0),
    "post": ((0.1, 0.1, 2.0), 15.0),
    "cereal box": ((0.06, 0.2, 0.3), 0.5),
    "cupboard": ((0.4, 0.8, 1.8), 60.0),
    "pallet": ((0.8, 1.2, 0.144), 25.0),
    "stick": ((0.05, 0.1, 0.5), 1.0),
}
TURNS = [(0, 0, 0), (np.pi, 0, 0), (np.pi / 2, 0, 0), (-np.pi / 2, 0, 0), (0, np.pi / 2, 0), (0, -np.pi / 2, 0)]
ROUGH = 3.0
DEEPEST, STEEPEST = 1e-4, radians(0.1)  # m, rad


def generated(count, seed=32):
    """Boxes of 2 cm to 2 m, aspects of 1 to 50 and 5 g to 500 kg: size, mass, turn, is a mesh, ground."""
    random = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        size = np.exp(random.uniform(np.log(0.02), np.log(2.0), 3))
        density = np.exp(random.uniform(np.log(50), np.log(8000)))
        mass = float(density * size.prod())
        turn, is_mesh, ground = int(random.integers(6)), bool(random.integers(2)), str(random.choice(GROUNDS))
        if size.max() / size.min() <= 50 and 0.005 <= mass <= 500:
            found.append((tuple(size.tolist()), mass, turn, is_mesh, ground))
    return found


def mesh_of(folder, size, mass, friction=None):
    trimesh.creation.box(size).export(folder / "box.stl")
    x, y, z = size
    moments = (y * y + z * z, x * x + z * z, x * x + y * y)
    return thing(
        f'<mesh filename="file://{folder}/box.stl"/>', mass, [mass / 12 * value for value in moments], friction
    )


def upright(quaternion):
    """The vertical of the world in the frame of a body (unit vector)."""
    w, x, y, z = quaternion
    return np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])


FLOORS = {
    "plane": lambda _: plane(),
    "box": lambda _: static_box(),
    "mesh": lambda folder: static_mesh(folder / "terrain.obj"),
    "slab": lambda _: plane(),
}


def check_standing(folder, engine, seconds, size, mass, turn, is_mesh, ground):
    """Stand a box on a side, leaning by .1° or half of what makes it fall: it sinks in by a hair, and stays upright."""
    R = trimesh.transformations.euler_matrix(*TURNS[turn])[:3, :3]
    x, y, z = np.abs(R @ size)  # along the world's axes
    width, about = (x, "y") if x < y else (y, "x")
    lean = min(radians(0.1), 0.25 * width / z)
    scene = Scene(folder, engine, FLOORS[ground](folder))
    top = 0.0
    if ground == "slab":
        top = 0.2
        scene.add("slab", box((3.0, 3.0, top), 10 * mass), (0, 0, top / 2))
    tilted = trimesh.transformations.rotation_matrix(lean, (0, 1, 0) if about == "y" else (1, 0, 0))[:3, :3] @ R
    matrix = np.eye(4)
    matrix[:3, :3] = tilted
    rpy = trimesh.transformations.euler_from_matrix(matrix)
    height = z / 2 * cos(lean) + width / 2 * sin(lean) + 1e-5
    urdf = mesh_of(folder, size, mass) if is_mesh else box(size, mass)
    twin = scene.add("thing", urdf, (0, 0, top + height), rpy).build()
    twin.advance_to(seconds)
    state = twin.entities.state("thing")
    vertical = upright(state.orientation)
    tilt = float(np.arccos(min(1.0, np.abs(vertical @ R.T[:, 2]))))
    slab = twin.entities.state("slab").position[2] - top / 2 if ground == "slab" else 0.0
    assert -1e-5 < z / 2 + top + slab - state.position[2] < DEEPEST
    assert tilt < STEEPEST


@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("is_mesh", [False, True], ids=["box", "stl"])
@every_engine
def test_what_people_stand_up_stands(tmp_path, engine, name, is_mesh):
    check_standing(tmp_path, engine, 4.0, *NAMED[name], 0, is_mesh, "plane")


@pytest.mark.parametrize("case", generated(8), ids=str)
@every_engine
def test_some_boxes_stand_on_any_side(tmp_path, engine, case):
    check_standing(tmp_path, engine, 4.0, *case)


@pytest.mark.slow
@pytest.mark.parametrize("case", generated(200), ids=str)
@every_engine
def test_boxes_stand_on_any_side(tmp_path, engine, case):
    check_standing(tmp_path, engine, 60.0, *case)


def check_standing_body(folder, engine, seconds, body):
    """Stand a body on a face, leaning by .1° or a quarter of what makes it fall: it stays upright and hardly sinks."""
    scene, top = Scene(folder, engine, FLOORS[body.ground](folder)), 0.0
    if body.ground == "slab":
        top = 0.2
        scene.add("slab", box((5.0, 5.0, top), 10 * body.mass), (0, 0, top / 2))
    lean = min(radians(0.1), 0.25 * atan(body.margin / body.height))
    matrix = trimesh.transformations.rotation_matrix(lean, body.edge)
    matrix[:3, :3] = matrix[:3, :3] @ body.turn
    height = top + 1e-5 - float((body.mesh.vertices @ matrix[:3, :3].T)[:, 2].min())
    rpy = trimesh.transformations.euler_from_matrix(matrix)
    twin = scene.add("thing", body.urdf(folder), (0, 0, height), rpy).build()
    twin.advance_to(seconds)
    state = twin.entities.state("thing")
    tilt = float(np.arccos(min(1.0, float(upright(state.orientation) @ body.turn[2]))))
    slab = twin.entities.state("slab").position[2] - top / 2 if body.ground == "slab" else 0.0
    # What still leans by so much has its centre of mass above where it should be.
    raised = body.reach * tilt
    assert -1e-5 - raised < body.height + top + slab - state.position[2] < DEEPEST
    assert tilt < STEEPEST


@pytest.mark.parametrize("body", standing(60)[3::7][:8], ids=lambda body: body.name)
@every_engine
def test_some_bodies_stand_on_any_face(tmp_path, engine, body):
    check_standing_body(tmp_path, engine, 4.0, body)


# One leans by 5° on a slab, one stands 0.16 mm too high (docs/physics.md).
EXCEPTIONS = (16, 44)


@pytest.mark.slow
@pytest.mark.parametrize(
    "body", [body for n, body in enumerate(standing(60)) if n not in EXCEPTIONS], ids=lambda body: body.name
)
@every_engine
def test_bodies_stand_on_any_face(tmp_path, engine, body):
    check_standing_body(tmp_path, engine, 10.0, body)


@pytest.mark.parametrize(
    ("size", "mass"), [((0.5, 0.02, 0.02), 0.5), ((0.4, 0.3, 0.005), 1.0), ((1.0, 0.02, 0.02), 0.2)]
)
@every_engine
def test_what_is_pushed_end_on_into_a_wall_stops_there(tmp_path, engine, size, mass):
    wall = static("<box><size>0.1 2 2</size></box>", (1.05, 0, 0, 0, 0, 0), name="wall")
    place = (1 - size[0] / 2 - 0.001, 0, size[2] / 2)
    scene = Scene(tmp_path, engine, wall + plane(friction=0.001))
    twin = scene.add("thing", box(size, mass, friction=0.001), place).build()
    twin.entities.apply_wrench("thing", force=(20, 0, 0), duration=2.0)
    twin.advance_to(1.0)
    assert 0 < position(twin, "thing")[0] + size[0] / 2 - 1 < DEEPEST


def rods_and_plates(count, seed=77):
    """Things of 5 to 50 mm, .1 to 5 kg and 10 cm to 1 m, and what pushes them (1 to 200 N)."""
    random = np.random.default_rng(seed)
    found = []
    for number in range(count):
        thick = float(np.exp(random.uniform(np.log(0.005), np.log(0.05))))
        length = float(random.uniform(0.1, 1.0))
        width = thick if number % 2 == 0 else float(random.uniform(0.1, 0.4))
        mass, force = np.exp(random.uniform((np.log(0.1), 0), (np.log(5), np.log(200)))).tolist()
        found.append(((length, width, thick), mass, force))
    return found


def way_of_a_step(engine, mass, force):
    return force / mass * {"1ms": 1e-6, "10ms": 1e-4, "cenic": 0.0}[engine]


def depths_in_mujoco(size, mass, force):
    """How deep (m) a wall is entered by what is pushed into it, in each ms, with MuJoCo's default solref."""
    x, y, z = size
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody>
<geom type="plane" size="9 9 1" friction="0.001"/><geom type="box" size="0.05 1 1" pos="1.05 0 0"/>
<body pos="{0.999 - x / 2} 0 {z / 2}"><freejoint/>
<geom type="box" size="{x / 2} {y / 2} {z / 2}" mass="{mass}" friction="0.001"/></body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.xfrc_applied[1, 0] = force
    depths = []
    for _ in range(1000):
        mujoco.mj_step(model, data)
        depths.append(float(data.qpos[0]) + x / 2 - 1)
    return depths


def check_push(folder, engine, size, mass, force):
    """Push a thing end-on into a wall: it rests less deep than in MuJoCo, and strikes it as deep and a step's way.

    MuJoCo's deepest of the second half: a thin plate that it pushes end-on jumps about, and is off the wall at times.
    """
    wall = static("<box><size>0.1 2 2</size></box>", (1.05, 0, 0, 0, 0, 0), name="wall")
    scene = Scene(folder, engine, wall + plane(friction=0.001))
    twin = scene.add("thing", box(size, mass, friction=0.001), (0.999 - size[0] / 2, 0, size[2] / 2)).build()
    twin.entities.apply_wrench("thing", force=(force, 0, 0), duration=2.0)
    depths = []
    for moment in np.linspace(0, 1, 51)[1:]:
        twin.advance_to(float(moment))
        depths.append(float(position(twin, "thing")[0]) + size[0] / 2 - 1)
    expected = depths_in_mujoco(size, mass, force)
    assert 0 < max(depths) < max(expected) + way_of_a_step(engine, mass, force)
    assert depths[-1] < max(expected[500:])


PUSHES = rods_and_plates(20)
SAID = [(e, case) for e in ENGINES for case in PUSHES if way_of_a_step(e, *case[1:]) > case[0][2] / 2]
HELD = [(e, case) for e in ENGINES for case in PUSHES if way_of_a_step(e, *case[1:]) <= case[0][2] / 2]


@pytest.mark.parametrize(("engine", "case"), HELD[::8], ids=str)
def test_a_wall_holds_what_is_pushed_into_it_end_on(tmp_path, engine, case):
    check_push(tmp_path, engine, *case)


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "case"), HELD, ids=str)
def test_walls_hold_what_is_pushed_into_them_end_on(tmp_path, engine, case):
    check_push(tmp_path, engine, *case)


@pytest.mark.parametrize(("engine", "case"), SAID, ids=str)
def test_a_push_that_a_step_is_too_long_for_is_said(tmp_path, caplog, engine, case):
    size, mass, force = case
    twin = Scene(tmp_path, engine, plane()).add("thing", box(size, mass), (0, 0, size[2] / 2)).build()
    twin.entities.apply_wrench("thing", force=(force, 0, 0), duration=2.0)
    way = 1e3 * way_of_a_step(engine, mass, force)
    said = f"thing: {force:g} N move {mass:.3g} kg by {way:.3g} mm in a step of 10 ms: it may pass through walls"
    assert [record.getMessage().startswith(said) for record in caplog.records] == [True]
    caplog.clear()
    twin.entities.apply_wrench("thing", force=(force / 100, 0, 0), duration=2.0)
    assert not caplog.records


def check_tipping(folder, engine, how, size, mass, is_mesh):
    """Push a box at its top, or stand it on a slope: it stands at .95 of what tips it, and tips at 1.05."""
    width, _, height = size
    urdf = mesh_of(folder, size, mass, friction=ROUGH) if is_mesh else box(size, mass, friction=ROUGH)
    for share in (0.95, 1.05):
        tilt = share * atan(width / height) if how == "slope" else 0.0
        last = mass * G * (sin(tilt) if how == "slope" else share * width / (2 * height))
        scene = Scene(folder, engine, plane(tilt, friction=ROUGH))
        twin = scene.add("thing", urdf, on_slope(tilt, z=height / 2), (0, tilt, 0)).build()
        for part in np.linspace(0, 1, 41)[1:]:  # slowly: on a slope, by a hand that lets it go
            force, at = (part * last, height / 2) if how == "force" else ((part - 1) * last, 0.0)
            twin.entities.apply_wrench("thing", force=on_slope(tilt, force), duration=0.05, at=(0, 0, at))
            twin.advance_to(twin.time + 0.05)
        if how == "force":
            twin.entities.apply_wrench("thing", force=(last, 0, 0), duration=4.0, at=(0, 0, height / 2))
        leans = 0.0  # at most: what tumbles down a slope may be upright again in the end
        for _ in range(12):
            twin.advance_to(twin.time + 0.25)
            vertical = upright(twin.entities.state("thing").orientation)
            leans = max(leans, abs(float(np.arctan2(vertical[0], vertical[2])) - -tilt))
        assert (leans > radians(5.0)) == (share > 1), (share, np.degrees(leans))


def slim(count, seed=33):
    """Boxes of aspects of 1 to 50: size and mass."""
    random = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        width, aspect, density = np.exp(random.uniform(np.log((0.02, 1.0, 50)), np.log((0.1, 50.0, 8000))))
        size = (width, width * np.exp(random.uniform(0, 2)), width * aspect)
        found.append((tuple(map(float, size)), float(density * np.prod(size))))
    return found


@pytest.mark.parametrize("is_mesh", [False, True], ids=["box", "stl"])
@pytest.mark.parametrize("how", ["force", "slope"])
@pytest.mark.parametrize("size", [(0.1, 0.1, 0.3), (0.4, 0.4, 0.4), (0.05, 0.05, 0.5), (0.02, 0.1, 1.0)], ids=str)
@every_engine
def test_a_body_tips_where_its_weight_passes_its_edge(tmp_path, engine, size, how, is_mesh):
    check_tipping(tmp_path, engine, how, size, 1.0, is_mesh)


@pytest.mark.slow
@pytest.mark.parametrize("is_mesh", [False, True], ids=["box", "stl"])
@pytest.mark.parametrize("how", ["force", "slope"])
@pytest.mark.parametrize("case", slim(30), ids=str)
@every_engine
def test_bodies_tip_where_their_weight_passes_their_edge(tmp_path, engine, case, how, is_mesh):
    check_tipping(tmp_path, engine, how, *case, is_mesh)
