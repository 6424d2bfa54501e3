"""The meshes of loose hulls: as large as the hull, closed, and with the same gradient of pressure behind each side."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Convex

from drake_twin.diagram.track_shapes import soft_box
from drake_twin.diagram.yielding_shapes import _box_surface, _fine_box, _fine_hull, _hard_surface, _surface

SHAPES = {
    "plate": trimesh.creation.box((0.008, 0.07, 0.15)),
    "prism": trimesh.creation.cylinder(0.03, 0.2, sections=12),
    "cone": trimesh.creation.cone(0.05, 0.1, sections=12),
    "wedge": trimesh.convex.convex_hull(
        [(0, 0, 0), (0.2, 0, 0), (0, 0.1, 0), (0.2, 0.1, 0), (0, 0, 0.05), (0, 0.1, 0.05)]
    ),
}
RANDOM = np.random.default_rng(31)
SHAPES |= {f"random {n}": trimesh.convex.convex_hull(RANDOM.normal(size=(8, 3)) * (0.05, 0.1, 0.2)) for n in range(4)}


def read(text):
    """The points (m) and tetrahedra of a VTK text."""
    lines = text.split("\n")
    first = next(k for k, line in enumerate(lines) if line.startswith("POINTS"))
    count = int(lines[first].split()[1])
    points = np.array([line.split() for line in lines[first + 1 : first + 1 + count]], dtype=float)
    number = int(lines[first + 1 + count].split()[1])
    cells = lines[first + 2 + count : first + 2 + count + number]
    return points, np.array([line.split()[1:] for line in cells], dtype=int)


def check(text, depth, hull):
    points, tetrahedra = read(text)
    a, b, c, d = (points[tetrahedra[:, k]] for k in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(hull.volume, rel=3e-4)  # its sides are hollow
    faces = Counter(tuple(sorted(face)) for each in tetrahedra.tolist() for face in combinations(each, 3))
    surface = [face for face, times in faces.items() if times == 1]
    assert max(faces.values()) == 2
    triangles = points[np.array(surface)]
    assert np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    ).sum() / 2 == (pytest.approx(hull.area, rel=2e-4))
    if len(hull.facets) == 6:  # a box: all its sides consist of several triangles
        below = -(points @ hull.facets_normal.T - np.einsum("ij,ij->i", hull.facets_origin, hull.facets_normal))
        inside = below.min(axis=1) > depth / 2
        assert below.min(axis=1)[inside] == pytest.approx(depth, abs=1e-9)
        assert 0 <= below.min(axis=1)[~inside].max() < 1e-4 * hull.extents.max()


@pytest.mark.parametrize("name", SHAPES)
def test_a_hull_is_filled_with_a_core_at_one_depth(name):
    hull = SHAPES[name]
    text, depth = _fine_hull(Convex(np.ascontiguousarray(hull.vertices.T), "hull"), is_loose=True)
    assert depth is not None
    check(text, depth, hull)


def test_a_box_is_filled_with_a_core_at_one_depth():
    check(_fine_box(0.008, 0.07, 0.15), 0.002, SHAPES["plate"])


@pytest.mark.parametrize("size", [(0.6, 0.1, 0.15), (0.1, 0.6, 0.15), (0.2, 0.2, 0.2), (2.0, 0.01, 0.1)])
def test_the_box_of_a_track_has_squares_on_its_sides_and_one_point_inside(size):
    points, tetrahedra = read(soft_box(*size))
    a, b, c, d = (points[tetrahedra[:, k]] for k in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(np.prod(size))
    assert np.abs(d).max() == 0.0
    faces = Counter(tuple(sorted(face)) for each in tetrahedra.tolist() for face in combinations(each, 3))
    assert sorted(set(faces.values())) == [1, 2]
    below = np.isclose(points[:, 2], -size[2] / 2)
    lengths = [len(set(points[below, axis].round(9).tolist())) - 1 for axis in range(2)]
    assert lengths == [max(round(8 * length / max(size)), 2) for length in size[:2]]
    assert below[tetrahedra[:, :3]].all(axis=1).sum() == 2 * np.prod(lengths)


def test_the_pressure_behind_the_lower_part_of_an_upright_side_falls_towards_the_ground():
    points, tetrahedra = read(_fine_box(0.1, 0.2, 0.3))
    faces = Counter(tuple(sorted(face)) for each in tetrahedra.tolist() for face in combinations(each, 3))
    triangles = points[np.array([face for face, times in faces.items() if times == 1])]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    middles = triangles.mean(axis=1)
    normals *= np.sign((normals * middles).sum(axis=1) / np.linalg.norm(normals, axis=1) ** 2)[:, None]  # outwards
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for down in np.vstack([np.eye(3), -np.eye(3)]):
        lower = (np.abs(normals @ down) < 0.1) & ((triangles @ down).max(axis=1) > 0.99 * (points @ down).max())
        assert lower.sum() >= 4 * 3
        assert (normals @ down)[lower].max() < -1e-5


@pytest.mark.parametrize("name", SHAPES)
def test_the_surface_of_a_hard_hull_is_divided_into_small_triangles(name):
    hull = SHAPES[name]
    points, triangles, _ = _surface(Convex(np.ascontiguousarray(hull.vertices.T), "hull"))
    check_surface(_hard_surface(points, triangles, True), hull)


def check_surface(text, hull):
    lines = [line.split() for line in text.split("\n")]
    points = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
    faces = np.array([line[1:] for line in lines if line[0] == "f"], dtype=int) - 1
    fine = trimesh.Trimesh(points, faces, process=False)
    assert fine.is_watertight
    assert fine.is_winding_consistent
    assert (fine.area, fine.volume) == pytest.approx((hull.area, hull.volume), rel=1e-6)
    assert fine.edges_unique_length.max() <= max(0.6 * np.median(hull.extents), hull.extents.max() / 16)


@pytest.mark.parametrize(
    ("size", "least", "most"),
    [
        ((0.018, 0.015, 0.018), 96, 200),
        ((0.02, 0.03, 100.0), 64, 2000),
        ((0.1, 0.1, 1e-4), 32, 200),
        ((6e-6, 1e-3, 1e-3), 40, 80),  # halves of its sides' triangles have 1.5e-9 m², which Drake can still use
    ],
)
def test_the_sides_of_a_hard_box_are_divided(size, least, most):
    text = _hard_surface(*_box_surface(np.array(size)), True)
    assert least <= text.count("f ") <= most
    check_surface(text, trimesh.creation.box(size))
