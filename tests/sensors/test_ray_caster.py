"""Rays against closed forms in double precision, and against MuJoCo."""

import itertools
import subprocess
import sys
from math import pi

import numpy as np
import pytest
import trimesh
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Mesh,
    PerceptionProperties,
    ProximityProperties,
    Role,
    Sphere,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.framework import DiagramBuilder

from drake_twin.sensors.ray_caster import RayCaster

COLOR = [1.0, 1.0, 1.0, 1.0]


class Scene:
    """Shapes on free bodies, or on the world."""

    def __init__(self):
        self.builder = DiagramBuilder()
        self.plant, self.graph = AddMultibodyPlantSceneGraph(self.builder, 0.0)
        self.poses, self.numbers = [], itertools.count()

    def add(self, shape, X_WG, *, moves):
        body, X_BG = self.plant.world_body(), X_WG
        if moves:
            body = self.plant.AddRigidBody(f"b{len(self.poses)}", SpatialInertia.SolidSphereWithMass(1.0, 1.0))
            X_WB = RigidTransform(RollPitchYaw(0.3, -0.2, 0.5), [0.1, -0.3, 0.2]) @ X_WG
            X_BG = X_WB.inverse() @ X_WG
            self.poses.append((body, X_WB))
        self.plant.RegisterVisualGeometry(body, X_BG, shape, f"g{next(self.numbers)}", COLOR)

    def caster(self):
        self.plant.Finalize()
        self.diagram = self.builder.Build()
        context = self.diagram.CreateDefaultContext()
        own = self.plant.GetMyMutableContextFromRoot(context)
        for body, pose in self.poses:
            self.plant.SetFreeBodyPose(own, body, pose)
        found = RayCaster(self.plant, self.graph.model_inspector(), Role.kIllustration)
        return found, self.plant.get_body_poses_output_port().Eval(own)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1)[:, np.newaxis]


def slabs(size, origin, directions):
    """A box by the slab method."""
    low, high = (-size / 2 - origin) / directions, (size / 2 - origin) / directions
    enter, leave = np.minimum(low, high).max(axis=1), np.maximum(low, high).min(axis=1)
    return np.where(leave < np.maximum(enter, 0.0), np.inf, np.where(enter >= 0.0, enter, leave))


def roots(a, b, c):
    """The lesser root of a t² + 2 b t + c that is not negative."""
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
    first, second = (-b - root) / a, (-b + root) / a
    found = np.where(first >= 0.0, first, np.where(second >= 0.0, second, np.inf))
    return np.where(np.isnan(root), np.inf, found)


def ball(radii, origin, directions):
    o, d = origin / radii, directions / radii
    return roots((d * d).sum(axis=1), d @ o, o @ o - 1.0)


def cylinder(radius, length, origin, directions):
    """By the least of all crossings of the wall and of the ends that lie on them."""
    o, d = origin, directions
    a, b, c = (d[:, :2] ** 2).sum(axis=1), d[:, :2] @ o[:2], o[:2] @ o[:2] - radius**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
    found = np.full(len(d), np.inf)
    for t in ((-b - root) / a, (-b + root) / a):
        fits = (t >= 0) & (np.abs(o[2] + t * d[:, 2]) <= length / 2)
        found = np.where(fits & (t < found), t, found)
    for end in (-length / 2, length / 2):
        t = (end - o[2]) / d[:, 2]
        fits = (t >= 0) & (((o[:2] + t[:, None] * d[:, :2]) ** 2).sum(axis=1) <= radius**2)
        found = np.where(fits & (t < found), t, found)
    return found


SHAPES = {
    "box": lambda rng: (Box(*(s := rng.uniform(0.1, 1.0, 3))), lambda o, d: slabs(s, o, d)),
    "sphere": lambda rng: (Sphere(r := rng.uniform(0.05, 0.8)), lambda o, d: ball(np.full(3, r), o, d)),
    "ellipsoid": lambda rng: (Ellipsoid(*(s := rng.uniform(0.1, 0.8, 3))), lambda o, d: ball(s, o, d)),
    "cylinder": lambda rng: (
        Cylinder(r := rng.uniform(0.05, 0.5), h := rng.uniform(0.05, 1.0)),
        lambda o, d: cylinder(r, h, o, d),
    ),
    "capsule": lambda rng: (
        Capsule(r := rng.uniform(0.05, 0.4), h := rng.uniform(0.1, 1.0)),
        lambda o, d: (
            np.minimum.reduce(
                [cylinder_side(r, h, o, d), *(ball(np.full(3, r), o - [0, 0, z], d) for z in (-h / 2, h / 2))]
            )
            if not inside_capsule(r, h, o)
            else np.full(len(d), np.nan)
        ),
    ),
}


def cylinder_side(radius, length, origin, directions):
    a, b = (directions[:, :2] ** 2).sum(axis=1), directions[:, :2] @ origin[:2]
    t = roots(a, b, origin[:2] @ origin[:2] - radius**2)
    return np.where(np.abs(origin[2] + t * directions[:, 2]) <= length / 2, t, np.inf)


def inside_capsule(radius, length, origin):
    nearest = np.clip(origin[2], -length / 2, length / 2)
    return np.linalg.norm(origin - [0, 0, nearest]) < radius


def random_pose(rng):
    return RigidTransform(RollPitchYaw(rng.uniform(-3, 3, 3)), rng.uniform(-2.5, 2.5, 3))


@pytest.mark.parametrize("seed", range(100))
def test_ten_thousand_rays_in_a_hundred_scenes_against_closed_forms(seed):
    rng = np.random.default_rng(seed)
    scene, parts = Scene(), []
    for name in rng.choice([*SHAPES], 8):
        shape, formula = SHAPES[name](rng)
        pose = random_pose(rng)
        if inside_capsule(0.9, 1.8, pose.inverse() @ np.zeros(3)):
            continue  # it may hold the rays' origin
        scene.add(shape, pose, moves=bool(rng.integers(2)))
        parts.append((pose, formula))
    scene.add(HalfSpace(), RigidTransform([0, 0, -2.0]), moves=False)
    directions = unit(rng.normal(size=(100, 3)))
    caster, poses = scene.caster()
    found = caster.cast(poses, np.zeros(3), directions)
    down = directions[:, 2]
    wanted = np.where(down < 0.0, -2.0 / down, np.inf)
    beside = np.full(100, np.inf)
    for pose, formula in parts:
        turn = pose.rotation().matrix()
        origin = pose.inverse() @ np.zeros(3)
        wanted = np.minimum(wanted, formula(origin, directions @ turn))
        for shift in np.vstack([np.eye(3), -np.eye(3)]) * 1e-5:  # what a ray beside it meets
            beside = np.minimum(beside, formula(origin, unit(directions + shift) @ turn))
    same = np.isfinite(wanted) == np.isfinite(found)
    edges = ~same | (np.abs(np.where(np.isfinite(found), found, 0) - np.where(np.isfinite(wanted), wanted, 0)) > 1e-4)
    assert edges.sum() <= 1
    near = np.isfinite(wanted) & ~edges
    assert np.abs(found[near] - wanted[near]).max(initial=0.0) < 5e-6
    assert near.sum() > 20


def test_a_mesh_is_met_where_mujoco_meets_it(tmp_path):
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")
    import trimesh

    mesh = trimesh.creation.torus(0.6, 0.2, 40, 24)
    mesh.export(tmp_path / "torus.obj")
    scene = Scene()
    X_WG = RigidTransform(RollPitchYaw(0.4, 0.2, -0.3), [1.5, 0.3, -0.2])
    scene.add(Mesh(str(tmp_path / "torus.obj"), 1.0), X_WG, moves=True)
    caster, poses = scene.caster()
    w, x, y, z = X_WG.rotation().ToQuaternion().wxyz()
    # MuJoCo moves a mesh into its center of mass and axes, and says so: the torus is symmetric, so the center stays.
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler meshdir="{tmp_path}"/><asset><mesh name="t" file="torus.obj" inertia="shell"/></asset>
        <worldbody><geom type="mesh" mesh="t" pos="1.5 0.3 -0.2" quat="{w} {x} {y} {z}"/></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    directions = unit(np.random.default_rng(1).normal(size=(4000, 3)) * 0.3 + [1.5, 0.3, -0.2])
    wanted = np.full(len(directions), -1.0)
    for index, direction in enumerate(directions):
        wanted[index] = mujoco.mj_ray(model, data, np.zeros(3), direction, None, 1, -1, np.zeros(1, dtype=np.int32))
    found = caster.cast(poses, np.zeros(3), directions)
    same = np.isfinite(found) == (wanted >= 0)
    assert (~same).sum() <= 4  # at the outline
    met = same & np.isfinite(found)
    assert met.sum() > 1000
    far = np.abs(found[met] - wanted[met]) > 1e-5
    assert far.sum() <= 4


def test_what_is_nearer_than_the_least_range_is_not_seen():
    scene = Scene()
    scene.add(Box(0.2, 4.0, 4.0), RigidTransform([0.5, 0, 0]), moves=False)
    scene.add(Sphere(0.1), RigidTransform([0.2, 0, 0]), moves=True)
    scene.add(Box(0.2, 4.0, 4.0), RigidTransform([3.1, 0, 0]), moves=True)
    caster, poses = scene.caster()
    forward = np.array([[1.0, 0.0, 0.0]])
    ranges = [caster.cast(poses, np.zeros(3), forward, nearest)[0] for nearest in (0.0, 0.35, 0.7, 4.0)]
    assert ranges == pytest.approx([0.1, 0.4, 3.0, np.inf], abs=1e-6)


def test_collision_shapes_and_visual_shapes_are_seen_apart():
    builder = DiagramBuilder()
    plant, graph = AddMultibodyPlantSceneGraph(builder, 0.0)
    body = plant.world_body()
    plant.RegisterVisualGeometry(body, RigidTransform([2.0, 0, 0]), Sphere(0.5), "seen", COLOR)
    plant.RegisterCollisionGeometry(body, RigidTransform([3.0, 0, 0]), Sphere(0.5), "touched", ProximityProperties())
    plant.Finalize()
    builder.Build()
    cast = {
        role: RayCaster(plant, graph.model_inspector(), role).cast([], np.zeros(3), np.array([[1.0, 0, 0]]))[0]
        for role in (Role.kIllustration, Role.kProximity)
    }
    assert cast == {Role.kIllustration: pytest.approx(1.5), Role.kProximity: pytest.approx(2.5)}
    assert PerceptionProperties is not None


@pytest.mark.parametrize("moves", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("name", [*SHAPES, "mesh", "hull", "shells"])
def test_a_lidar_sees_out_of_its_housing_as_in_gazebo(tmp_path, name, moves, mirrored):
    """What is drawn is seen from in front alone: the ranges are those without the housing."""
    rng = np.random.default_rng(3)
    directions = unit(rng.normal(size=(500, 3)))
    scale = (1.0, -1.0, 1.0) if mirrored else (1.0, 1.0, 1.0)
    housing = trimesh.creation.icosphere(2, 0.3)
    if name == "shells":  # one within the other
        housing += trimesh.creation.icosphere(2, 0.2)
    housing.export(tmp_path / "housing.obj")
    rooms = []
    for is_housed in (False, True):
        scene = Scene()
        for wall in (Box(0.1, 6.0, 6.0), Sphere(0.5)):
            scene.add(wall, RigidTransform(RollPitchYaw(0.1, 0.2, 0.3), [1.5, 0.3, 0.2]), moves=not moves)
        if is_housed:
            shape = SHAPES[name](rng)[0] if name in SHAPES else Mesh(str(tmp_path / "housing.obj"), scale)
            shape = Convex(str(tmp_path / "housing.obj"), scale) if name == "hull" else shape
            scene.add(shape, RigidTransform(), moves=moves)
        caster, poses = scene.caster()
        rooms.append(caster.cast(poses, np.array([0.005, 0.01, -0.01]), directions))
    assert np.isfinite(rooms[0]).sum() > 100
    assert rooms[0] == pytest.approx(rooms[1], abs=1e-5)


@pytest.mark.parametrize("moves", [False, True])
def test_a_lidar_in_the_plane_of_its_robots_top_does_not_see_it(moves):
    """A face that is seen edge-on is not drawn: the rays go on to the wall, whatever they round to."""
    angles = np.linspace(-pi, pi, 720)
    directions = np.column_stack([np.cos(angles), np.sin(angles), 1e-17 * np.sin(7 * angles)])
    scene = Scene()
    scene.add(Box(0.5, 0.3, 0.1), RigidTransform([0, 0, 0.15]), moves=moves)
    scene.add(Box(0.1, 8.0, 8.0), RigidTransform([2.05, 0, 0]), moves=not moves)
    caster, poses = scene.caster()
    ranges = caster.cast(poses, np.array([0.02, 0.015, 0.2]), directions, 0.05)
    ahead = np.cos(angles) > 0.5
    assert ranges[ahead] == pytest.approx(1.98 / np.cos(angles[ahead]), abs=1e-4)
    assert np.isinf(ranges[np.cos(angles) < 0.0]).all()


def test_the_bounding_spheres_change_no_bit(monkeypatch):
    def ranges():
        rng = np.random.default_rng(5)
        scene = Scene()
        for name in [*SHAPES] * 4:
            scene.add(SHAPES[name](rng)[0], random_pose(rng), moves=True)
        caster, poses = scene.caster()
        return caster.cast(poses, np.zeros(3), unit(rng.normal(size=(2000, 3))))

    culled = ranges()

    def always(directions, ways, *_):
        shapes, rays = np.indices((len(ways), len(directions)))
        return shapes.ravel(), rays.ravel()

    monkeypatch.setattr("drake_twin.sensors.ray_caster._meets", always)
    assert culled.tobytes() == ranges().tobytes()


def test_two_processes_find_the_same_bytes():
    program = (
        "import sys, hashlib; sys.path[:0] = ['tests', 'tests/sensors']\n"
        "import numpy as np, test_ray_caster as t\n"
        "rng = np.random.default_rng(7); s = t.Scene()\n"
        "for name in [*t.SHAPES] * 3: s.add(t.SHAPES[name](rng)[0], t.random_pose(rng), moves=True)\n"
        "c, p = s.caster()\n"
        "r = c.cast(p, np.zeros(3), t.unit(rng.normal(size=(500, 3))))\n"
        "print(hashlib.sha256(r.tobytes()).hexdigest())"
    )
    found = {subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout for _ in range(2)}
    assert len(found) == 1


def test_without_embree_one_paragraph_says_so(monkeypatch):
    from drake_twin import InputError

    monkeypatch.setitem(sys.modules, "embreex", None)
    scene = Scene()
    scene.add(Sphere(0.5), RigidTransform(), moves=False)
    with pytest.raises(InputError, match="pip install 'embreex>=4'"):
        scene.caster()
