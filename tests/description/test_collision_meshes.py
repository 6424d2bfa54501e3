from pathlib import Path

import numpy as np
import pytest
import trimesh
from mesh_files import OFFSET, ONE, bounds_in_drake, box, must_not_be_called, near, refusal, write
from scipy.spatial import ConvexHull

from drake_twin.description import meshes
from drake_twin.description.meshes import (
    Primitive,
    collision_mesh,
    collision_pieces,
    mesh_primitive,
)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "drake_twin" / "meshes"


# Hulls


@pytest.mark.parametrize("suffix", ["stl", "dae", "glb", "ply", "obj", "off"])
def test_a_hull_reaches_as_far_as_its_mesh(tmp_path, suffix):
    mesh = box(offset=OFFSET)
    assert bounds_in_drake(collision_mesh(write(mesh, tmp_path / f"box.{suffix}"))) == near(mesh.bounds)


def test_a_hull_of_a_gltf_stands_as_drake_draws_the_file(tmp_path):
    for name, content in trimesh.Scene(box(offset=OFFSET)).export(file_type="gltf").items():
        (tmp_path / name).write_bytes(content)
    file = tmp_path / "model.gltf"
    assert bounds_in_drake(collision_mesh(file)) == near(bounds_in_drake(file))


def test_a_hull_of_many_corners_is_thinned_out_and_reaches_as_far(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=4)
    hull = collision_mesh(write(ball, tmp_path / "ball.stl"))
    assert bounds_in_drake(hull) == near(ball.bounds)
    corners = trimesh.load_mesh(hull).vertices
    assert len(corners) <= 64 < len(ball.vertices)
    assert np.linalg.norm(corners, axis=1) == pytest.approx(1.0, abs=1e-3)
    across = trimesh.convex.convex_hull(corners).face_normals
    assert np.einsum("ij,ij->i", trimesh.convex.convex_hull(corners).triangles_center, across).min() > 0.9


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (1, 1, 1)])
def test_a_flat_mesh_gets_a_thin_hull(tmp_path, normal):
    square = trimesh.Trimesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    square.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), normal))
    hull = trimesh.load_mesh(collision_mesh(write(square, tmp_path / "square.stl")))
    assert 0.0 < hull.convex_hull.volume < 0.02
    assert bounds_in_drake(collision_mesh(tmp_path / "square.stl")) == [
        pytest.approx(corner.tolist(), abs=2e-3) for corner in square.bounds
    ]


def test_a_mesh_that_is_a_line_gets_a_thin_hull(tmp_path):
    line = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], process=False)
    hull = trimesh.load_mesh(collision_mesh(write(line, tmp_path / "line.stl")))
    assert hull.extents == pytest.approx([2.0, 0.0, 0.0], abs=3e-3)


# Primitives


@pytest.mark.parametrize("scale", [ONE, (0.001, 0.002, 0.003), (-1.0, 1.0, 1.0)])
def test_a_box_is_recognised(tmp_path, scale):
    file = write(box((1.0, 2.0, 3.0), OFFSET), tmp_path / "box.stl")
    found = mesh_primitive(file, scale)
    assert found.kind == "box"
    assert found.size == pytest.approx(np.abs(np.array([1.0, 2.0, 3.0]) * scale))
    assert found.center == pytest.approx(np.array(OFFSET) * scale)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("scale", [ONE, (0.001, 0.001, 0.001)])
def test_a_cylinder_is_recognised_along_each_axis(tmp_path, axis, scale):
    mesh = trimesh.creation.cylinder(radius=0.5, height=2.0, sections=64)
    mesh.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), np.eye(3)[axis]))
    mesh.apply_translation(OFFSET)
    found = mesh_primitive(write(mesh, tmp_path / "cylinder.stl"), scale)
    assert (found.kind, found.axis) == ("cylinder", axis)
    assert found.size == pytest.approx((0.5 * scale[0], 2.0 * scale[0]), rel=1e-3)
    assert found.center == pytest.approx(np.array(OFFSET) * scale, rel=1e-3)


def test_a_cylinder_stays_one_when_it_is_stretched_along_its_axis(tmp_path):
    file = write(trimesh.creation.cylinder(radius=0.5, height=2.0, sections=64), tmp_path / "cylinder.stl")
    assert mesh_primitive(file, (2.0, 2.0, 5.0)).size == pytest.approx((1.0, 10.0), rel=1e-3)
    assert mesh_primitive(file, (2.0, 1.0, 1.0)) is None


@pytest.mark.parametrize("subdivisions", [3, 4])
def test_a_sphere_is_recognised(tmp_path, subdivisions):
    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.5)
    ball.apply_translation(OFFSET)
    found = mesh_primitive(write(ball, tmp_path / "ball.stl"), (2.0, 2.0, 2.0))
    assert found == Primitive("sphere", pytest.approx((1.0,), rel=1e-3), pytest.approx((2.0, 4.0, 6.0), rel=1e-3))
    assert mesh_primitive(tmp_path / "ball.stl", (2.0, 2.0, 3.0)) is None


def turned(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    mesh.apply_transform(trimesh.transformations.euler_matrix(0.3, 0.2, 0.1))
    return mesh


@pytest.mark.parametrize(
    "mesh",
    [
        turned(box()),
        trimesh.creation.cone(radius=1.0, height=1.0, sections=64),
        trimesh.creation.capsule(radius=0.5, height=1.0),
        trimesh.creation.cylinder(radius=1.0, height=1.0, sections=6),
        trimesh.creation.icosahedron(),
        turned(trimesh.creation.cylinder(radius=1.0, height=3.0, sections=64)),
    ],
    ids=["turned box", "cone", "capsule", "hexagon", "icosahedron", "turned cylinder"],
)
def test_what_is_no_primitive_is_taken_for_none(tmp_path, mesh):
    assert mesh_primitive(write(mesh, tmp_path / "part.stl"), ONE) is None


def test_a_flat_square_is_no_box(tmp_path):
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    assert mesh_primitive(write(square, tmp_path / "square.stl"), ONE) is None


@pytest.mark.parametrize("scale", [(0.0, 0.0, 0.0), (1.0, 1.0, 0.0)])
def test_a_mesh_scaled_to_nothing_is_no_primitive(tmp_path, scale):
    assert mesh_primitive(write(box(), tmp_path / "box.stl"), scale) is None


# Decomposition


def write_angle(file: Path) -> Path:
    """An L in the x-z plane: a bar along x and one along z, each 2 m long and 0.4 m thick."""
    corners = [[0, 0], [2, 0], [2, 0.4], [0.4, 0.4], [0.4, 2], [0, 2]]
    across = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    angle = trimesh.creation.extrude_triangulation(np.array(corners, dtype=float), np.array(across), height=0.4)
    angle.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    return write(angle, file)


def inside(piece: trimesh.Trimesh, points: list[list[float]]) -> np.ndarray:
    """Which points lie in the hull of a piece."""
    sides = ConvexHull(piece.vertices).equations
    return (np.array(points) @ sides[:, :3].T + sides[:, 3] <= 0).all(axis=1)


def test_a_decomposed_angle_is_several_pieces_that_leave_the_notch_free(tmp_path):
    pytest.importorskip("coacd", reason="the extra 'decomposition' is not installed")
    file = write_angle(tmp_path / "angle.stl")
    pieces = [trimesh.load_mesh(piece) for piece in collision_pieces(file)]
    assert len(pieces) >= 2
    notch, bars = [[0.7, -0.2, 0.7]], [[1.8, -0.2, 0.2], [0.2, -0.2, 1.8], [0.2, -0.2, 0.2]]
    assert inside(trimesh.load_mesh(collision_mesh(file)), notch + bars).all()
    in_pieces = np.any([inside(piece, notch + bars) for piece in pieces], axis=0)
    assert in_pieces.tolist() == [False, True, True, True]


def test_pieces_are_made_once(tmp_path, monkeypatch):
    pytest.importorskip("coacd", reason="the extra 'decomposition' is not installed")
    file = write_angle(tmp_path / "angle.stl")
    pieces = collision_pieces(file)
    monkeypatch.setattr(meshes, "_pieces_json", must_not_be_called)
    assert collision_pieces(file) == pieces
    assert all(piece.exists() for piece in pieces)


def test_decomposition_without_coacd_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "coacd", None)
    text = refusal(collision_pieces, write(box(), tmp_path / "box.stl"))
    assert text.startswith("collision: decomposition needs coacd, which is not installed: `")
    assert text.endswith(" -m pip install 'coacd>=1'`.")
