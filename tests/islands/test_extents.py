"""The boxes of movers against where Drake has their shapes."""

from functools import partial

import numpy as np
import pytest
from crates import crates, model, quaternion
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.geometry import Box, Cylinder, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.islands.extents import MARGIN, Extents
from drake_twin.islands.mover import movers_of

SHAPES = (
    lambda rng: '<box size="{:.3f} {:.3f} {:.3f}"/>'.format(*rng.uniform(0.05, 0.5, 3)),
    lambda rng: f'<sphere radius="{rng.uniform(0.03, 0.3):.3f}"/>',
    lambda rng: '<cylinder radius="{:.3f}" length="{:.3f}"/>'.format(*rng.uniform(0.03, 0.4, 2)),
)
KINDS = ("revolute", "wide", "continuous", "prismatic", "fixed")


def numbers(values):
    return " ".join(f"{value:.4f}" for value in values)


def link(name, rng, least=0):
    shapes = [SHAPES[rng.integers(3)](rng) for _ in range(rng.integers(least, 3))]
    origins = [
        f'<origin xyz="{numbers(rng.uniform(-0.4, 0.4, 3))}" rpy="{numbers(rng.uniform(-3, 3, 3))}"/>' for _ in shapes
    ]
    collisions = "".join(
        f"<collision>{origin}<geometry>{shape}</geometry></collision>"
        for origin, shape in zip(origins, shapes, strict=True)
    )
    return f"""<link name="{name}"><inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>{collisions}</link>"""


def joint(number, parent, rng):
    kind = KINDS[rng.integers(len(KINDS))]
    reach = {"revolute": rng.uniform(0.2, 1.5), "wide": 40.0, "prismatic": rng.uniform(0.1, 0.8)}.get(kind)
    limit = (
        ""
        if reach is None
        else f'<limit lower="{-reach * rng.uniform(0, 1):.3f}" upper="{reach:.3f}" effort="9" velocity="9"/>'
    )
    axis = rng.normal(size=3)
    axis = np.eye(3)[rng.integers(3)] if rng.uniform() < 0.3 else axis / np.linalg.norm(axis)
    return f"""<joint name="j{number}" type="{"revolute" if kind == "wide" else kind}"><parent link="{parent}"/>
<child link="l{number}"/><axis xyz="{" ".join(map(repr, axis.tolist()))}"/>{limit}
<origin xyz="{numbers(rng.uniform(-0.5, 0.5, 3))}" rpy="{numbers(rng.uniform(-3, 3, 3))}"/></joint>"""


def tree(rng, count=6):
    """The URDF of a tree of links with joints of all kinds."""
    parts = [link("l0", rng, 1)]
    for number in range(1, count):
        parts += [link(f"l{number}", rng), joint(number, f"l{rng.integers(number)}", rng)]
    return f'<robot name="tree">{"".join(parts)}</robot>'


@pytest.fixture
def trees(tmp_path):
    """Builds a twin of a fixed and a floating random robot, and a crate."""

    def of(seed):
        rng = np.random.default_rng(seed)
        builder = crates(tmp_path, model("crate", (9, 9, 9), size=(0.3, 0.5, 0.7)), ground=False, islands=1)
        for name, is_fixed in (("fixed", True), ("floating", False)):
            text = tree(rng)
            if is_fixed:
                world = '<link name="world"/><joint name="w" type="fixed"><parent link="world"/><child link="l0"/>'
                text = text.replace("</robot>", f'{world}<origin xyz=".1 .2 .3" rpy="1 2 3"/></joint></robot>')
            (tmp_path / f"{name}.urdf").write_text(text, encoding="utf-8")
            builder.robot(name, tmp_path / f"{name}.urdf", xyz=(1, 2, 3), rpy=tuple(rng.uniform(-3, 3, 3).tolist()))
        return builder.build()

    return of


def put_anywhere(twin, rng):
    """Put joints at random within their limits, and free bodies anywhere, all at random velocities."""
    plant, context = twin.plant, twin.plant.GetMyContextFromRoot(twin.context)
    q = np.zeros(plant.num_positions())
    for item in map(plant.get_joint, plant.GetJointIndices()):
        if item.num_positions() == 1:
            low, high = float(item.position_lower_limits()[0]), float(item.position_upper_limits()[0])
            low, high = max(low, -4.0), min(high, 4.0)
            q[item.position_start()] = rng.choice([low, high, rng.uniform(low, high)])
        elif item.num_positions() == 7:
            turn = quaternion(rng.uniform(-3, 3, 3)) * rng.uniform(0.7, 1.9)
            q[item.position_start() :][:7] = *turn, *rng.uniform(-9, 9, 3)
    plant.SetPositionsAndVelocities(context, np.concatenate([q, rng.uniform(-5, 5, plant.num_velocities())]))
    return context


def points_of(inspector, geometry):
    """Points of a shape's surface that are farthest out, among others."""
    shape, directions = inspector.GetShape(geometry), np.random.default_rng(0).normal(size=(3, 200))
    if isinstance(shape, Box):
        return np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1) * np.array(shape.size())[:, None]
    if isinstance(shape, Sphere):
        return shape.radius() * directions / np.linalg.norm(directions, axis=0)
    if isinstance(shape, Cylinder):
        rim = shape.radius() * directions[:2] / np.linalg.norm(directions[:2], axis=0)
        return np.vstack([rim, shape.length() / 2 * np.sign(directions[2])])
    hull = inspector.GetConvexHull(geometry)  # of what yields, which is a mesh
    return np.array([hull.vertex(index) for index in range(hull.num_vertices())]).T


def points(twin, context, mover):
    """Points of all shapes of a mover in the world, by Drake's own poses of its bodies."""
    plant, inspector = twin.plant, twin.built.scene_graph.model_inspector()
    found = [np.empty((3, 0))]
    for index in mover.places.bodies:
        X_WB = plant.EvalBodyPoseInWorld(context, plant.get_body(index))
        for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index)):
            X_WG = X_WB @ inspector.GetPoseInFrame(geometry)
            found.append(X_WG @ points_of(inspector, geometry))
    return np.hstack(found).T


def extents(twin):
    inspector = twin.built.scene_graph.model_inspector()
    movers = movers_of(twin.built, inspector)
    return movers, Extents(twin.plant, inspector, movers)


def swept(twin, context, dut, duration, moving):
    return dut.swept(twin.plant.GetPositionsAndVelocities(context), context, duration, moving)


@pytest.mark.parametrize("seed", range(12))
def test_the_boxes_hold_all_shapes_wherever_joints_and_bases_are(trees, seed):
    twin, rng = trees(seed), np.random.default_rng(seed)
    movers, dut = extents(twin)
    moving = np.ones(len(movers), dtype=bool)
    for _ in range(20):
        context = put_anywhere(twin, rng)
        lower, upper, rows = swept(twin, context, dut, 0.0, moving)
        assert rows.tolist() == list(range(len(dut.owners)))
        for number, mover in enumerate(movers):
            own = dut.owners == number
            cloud = points(twin, context, mover)
            inside = (lower[own][:, None] <= cloud) & (cloud <= upper[own][:, None])
            assert len(cloud) > 0
            assert inside.all(axis=2).any(axis=0).all(), (mover.name, seed)


@pytest.mark.parametrize("seed", range(6))
def test_the_boxes_of_a_time_hold_what_flies_and_turns_on_for_that_time(trees, seed):
    """The base keeps its velocities, while joints go anywhere."""
    twin, rng = trees(seed), np.random.default_rng(seed)
    movers, dut = extents(twin)
    moving = np.ones(len(movers), dtype=bool)
    for duration in (0.01, 0.1, 1.0):
        context = put_anywhere(twin, rng)
        lower, upper, _ = swept(twin, context, dut, duration, moving)
        free = list(map(twin.plant.get_body, twin.plant.GetFloatingBaseBodies()))
        starts = [(body, body.EvalPoseInWorld(context), body.EvalSpatialVelocityInWorld(context)) for body in free]
        assert len(starts) == 2
        for part in np.linspace(0.0, 1.0, 8):
            put_anywhere(twin, rng)
            for body, X_WB, V_WB in starts:
                turn, way = (V_WB.rotational() * duration * part, V_WB.translational() * duration * part)
                angle = float(np.linalg.norm(turn))
                R = RotationMatrix(AngleAxis(angle, turn / angle if part else np.eye(3)[0])) @ X_WB.rotation()
                X = RigidTransform(R, X_WB.translation() + way)
                twin.plant.SetFloatingBaseBodyPoseInWorldFrame(context, body, X)
            for number, mover in enumerate(movers):
                own = dut.owners == number
                cloud = points(twin, context, mover)
                inside = (lower[own][:, None] <= cloud) & (cloud <= upper[own][:, None])
                assert inside.all(axis=2).any(axis=0).all(), (mover.name, duration, part)


SLIDING = '<limit lower="-0.3" upper="0.7" effort="9" velocity="9"/>'
TURNING = '<limit lower="-3" upper="3" effort="9" velocity="9"/>'


@pytest.mark.parametrize(
    ("kind", "axis", "limit"),
    [
        ("prismatic", "1 0 0", SLIDING),
        ("revolute", "0 0 1", TURNING),
        ("continuous", "0.6 0 0.8", ""),
    ],
)
def test_the_box_of_one_joint_holds_its_way_and_little_more(tmp_path, kind, axis, limit):
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    ball = '<collision><geometry><sphere radius=".01"/></geometry></collision>'
    shape = '<collision><origin xyz=".25 0 0"/><geometry><box size=".2 .4 .5"/></geometry></collision>'
    (tmp_path / "one.urdf").write_text(
        f"""<robot name="one"><link name="world"/><link name="a">{inertial}{ball}</link>
<link name="b">{inertial}{shape}</link>
<joint name="w" type="fixed"><parent link="world"/><child link="a"/><origin xyz="1 0 0"/></joint>
<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><origin xyz=".1 0 0"/><axis xyz="{axis}"/>{limit}
</joint></robot>""",
        encoding="utf-8",
    )
    builder = crates(tmp_path, ground=False, islands=1, gravity=0)
    twin = builder.robot("one", tmp_path / "one.urdf").build()
    movers, dut = extents(twin)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    lower, upper, _ = swept(twin, context, dut, 0.0, np.array([True]))
    ways = (-0.3, 0.7) if kind == "prismatic" else np.linspace(-3.14, 3.14, 400)
    clouds = [cloud_at(twin, context, movers[0], q) for q in ways]
    least, most = np.min(clouds, axis=(0, 1)), np.max(clouds, axis=(0, 1))
    assert (lower <= least).all()
    assert (upper >= most).all()
    assert (upper - lower <= 1.6 * (most - least) + 4 * MARGIN).all()


def cloud_at(twin, context, mover, q):
    twin.plant.SetPositions(context, [q])
    return points(twin, context, mover)


def test_the_box_of_a_crate_is_no_wider_than_needed(tmp_path):
    twin = crates(tmp_path, model("crate", (1, 2, 3), size=(0.2, 0.4, 0.6)), ground=False, islands=1).build()
    _, dut = extents(twin)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    at = partial(swept, twin, context, dut, moving=np.array([True]))
    lower, upper, _ = at(duration=0.0)
    assert lower == pytest.approx(np.array([[0.9, 1.8, 2.7]]) - MARGIN)
    assert upper == pytest.approx(np.array([[1.1, 2.2, 3.3]]) + MARGIN)
    twin.entities.set_state("crate", linear=(3, 0, 4))
    lower, upper, _ = at(duration=0.1)
    assert upper == pytest.approx(np.array([[1.1, 2.2, 3.3]]) + MARGIN + 0.5)
    twin.entities.set_state("crate", linear=(0, 0, 0), angular=(0, 0, 2))
    lower, upper, _ = at(duration=0.1)
    assert upper == pytest.approx(np.array([[1.1, 2.2, 3.3]]) + MARGIN + 0.2 * np.linalg.norm([0.1, 0.2, 0.3]))


def test_those_that_do_not_move_keep_their_boxes_until_they_are_forgotten(tmp_path):
    models = (model("one", (0, 0, 5)), model("other", (3, 0, 5)))
    twin = crates(tmp_path, *models, ground=False, islands=1).build()
    _, dut = extents(twin)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    at = partial(swept, twin, context, dut, 0.0, np.array([True, False]))
    first = at()[0].copy()
    for name in ("one", "other"):
        twin.entities.set_state(name, position=(0, 9, 5))
    lower, _, rows = at()
    assert rows.tolist() == [0]
    assert (lower[0] != first[0]).any()
    assert (lower[1] == first[1]).all()
    dut.forget()
    assert at()[0][1, 1] == pytest.approx(9 - 0.2 - MARGIN)
