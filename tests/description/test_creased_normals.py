"""Normals of meshes without their own, against those of the surfaces that they approximate."""

import numpy as np
import pytest
import trimesh

from drake_twin.description.creased_normals import creased_normals


def corners_and_normals(mesh):
    """The places of all corners of triangles, and their normals, each of shape (3 M, 3)."""
    normals, indices = creased_normals(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))
    return mesh.vertices[mesh.faces.ravel()], normals[indices.ravel()]


def test_a_ball_is_smooth():
    ball = trimesh.creation.icosphere(3)
    corners, normals = corners_and_normals(ball)
    assert np.einsum("ij,ij->i", corners, normals).min() > 0.9999


def test_a_cylinder_is_round_with_a_sharp_rim():
    cylinder = trimesh.creation.cylinder(radius=0.5, height=0.2, sections=48)
    of_faces = np.repeat(cylinder.face_normals, 3, axis=0)
    corners, normals = corners_and_normals(cylinder)
    is_cap = np.abs(of_faces[:, 2]) > 0.5
    assert normals[is_cap] == pytest.approx(of_faces[is_cap])
    outward = corners[~is_cap] * [1.0, 1.0, 0.0] / 0.5
    assert normals[~is_cap] == pytest.approx(outward, abs=1e-6)


def test_a_prism_of_few_sides_is_not_round():
    """The sides of one of eight turn by 45 degrees, those of one of sixteen by 22.5."""
    for sections, is_round in ((8, False), (16, True)):
        prism = trimesh.creation.cylinder(radius=0.5, height=0.2, sections=sections)
        _, normals = corners_and_normals(prism)
        assert (np.abs(normals - np.repeat(prism.face_normals, 3, axis=0)).max() > 0.01) == is_round


def test_a_sheet_is_sharp_where_it_is_bent_sharply_and_smooth_where_it_is_flat():
    """Its bend goes from 86 degrees at one end of a line to none at the other, which joins its two sides smoothly."""
    n = 21
    along = np.linspace(0.0, 20.0, n)
    bend = 1.5 * (1 - along / 20.0)
    line, zero = np.stack([along, 0 * along, 0 * along], axis=1), np.zeros(n)
    sides = np.stack([along, zero + 1.0, zero], axis=1), np.stack([along, -np.cos(bend), -np.sin(bend)], axis=1)
    faces = []
    for i in range(n - 1):
        faces += [(i, i + 1, n + i + 1), (i, n + i + 1, n + i)]
        faces += [(i, 2 * n + i, 2 * n + i + 1), (i, 2 * n + i + 1, i + 1)]
    corners = np.array(faces)
    _, indices = creased_normals(np.concatenate([line, *sides]), corners)
    assert len(np.unique(indices[corners == 1])) == 2
    assert len(np.unique(indices[corners == n - 1])) == 1


def test_triangles_without_an_area_do_no_harm():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]])
    normals, indices = creased_normals(vertices, np.array([[0, 1, 2], [0, 1, 3], [1, 1, 1]]))
    assert normals[indices[0]].tolist() == [[0.0, 0.0, 1.0]] * 3
    assert np.isfinite(normals).all()
