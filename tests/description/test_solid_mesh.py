import numpy as np
import pytest
import trimesh

from drake_twin.description.solid_mesh import THICKNESS, solid_mesh
from drake_twin.errors import InputError


def solids_of(tmp_path, mesh, name="mesh.stl", detail=0.0):
    mesh.export(tmp_path / name)
    return solid_mesh(tmp_path / name, detail)


def covers(solids, point):
    """Whether a point lies in one of the solids."""
    from scipy.spatial import ConvexHull

    for corners in solids.solids((1, 1, 1)):
        planes = ConvexHull(corners.T).equations
        if np.all(planes[:, :3] @ point + planes[:, 3] < 1e-9):
            return True
    return False


def test_convex_parts_become_their_hulls(tmp_path):
    two = trimesh.util.concatenate([trimesh.creation.box((1, 1, 1)), trimesh.creation.icosphere(1, 0.5)])
    two.vertices[8:] += (5, 0, 0)
    found = solids_of(tmp_path, two)
    assert (len(found.hulls), len(found.faces)) == (2, 0)
    assert covers(found, (0, 0, 0))
    assert not covers(found, (2.5, 0, 0))


def test_a_terrain_is_solid_below_and_free_above(tmp_path):
    x, y = np.meshgrid(np.linspace(-5, 5, 12), np.linspace(-5, 5, 12))
    heights = np.sin(x) * np.cos(y)
    vertices = np.column_stack([x.ravel(), y.ravel(), heights.ravel()])
    index = np.arange(144).reshape(12, 12)
    a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel()
    terrain = trimesh.Trimesh(vertices, np.vstack([np.column_stack([a, b, d]), np.column_stack([a, d, c])]))
    found = solids_of(tmp_path, terrain)
    assert len(found.faces) > 100
    middle = terrain.triangles_center[40]
    assert covers(found, np.subtract(middle, (0, 0, THICKNESS / 2)))
    assert not covers(found, np.add(middle, (0, 0, 0.01)))


def test_a_wall_round_a_corner_leaves_the_corner_free(tmp_path):
    """Two walls as one connected, closed mesh in the shape of an L."""
    outline = np.array([(0, 0), (3, 0), (3, 0.1), (0.1, 0.1), (0.1, 3), (0, 3)])
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    vertices = np.vstack([np.column_stack([outline, np.full(6, z)]) for z in (0.0, 1.0)])
    faces = [(c, b, a) for a, b, c in caps] + [(a + 6, b + 6, c + 6) for a, b, c in caps]
    for n in range(6):
        m = (n + 1) % 6
        faces += [(n, m, m + 6), (n, m + 6, n + 6)]
    found = solids_of(tmp_path, trimesh.Trimesh(vertices, faces))
    assert covers(found, (2.0, 0.1 - THICKNESS / 2, 0.5))
    assert not covers(found, (1.0, 1.0, 0.5))


@pytest.mark.parametrize(("dent", "hulls"), [(0.1, 0), (0.01, 1)])
def test_a_fine_ball_with_a_dent_is_its_hull_only_where_the_dent_is_a_hundredth_of_its_size(tmp_path, dent, hulls):
    ball = trimesh.creation.icosphere(3, 0.5)
    rim = 0.5 * np.cos(np.radians(30.0))
    share = np.clip((ball.vertices[:, 2] - rim) / (0.5 - rim), 0.0, 1.0)  # 0 at the rim, 1 at the pole
    ball.vertices[:, 2] = np.where(share > 0.0, rim - dent * share, ball.vertices[:, 2])
    found = solids_of(tmp_path, ball)
    assert len(found.hulls) == hulls
    assert covers(found, (0.0, 0.0, rim - 0.001)) == bool(hulls)


def test_a_scale_that_mirrors_keeps_the_free_side_free(tmp_path):
    square = trimesh.Trimesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    found = solids_of(tmp_path, square, "square.obj")
    for scale in ((1, 1, 1), (-1, 1, 1), (2, -3, 1)):
        (corners,) = found.solids(scale)
        assert corners[2].max() == 0
        assert corners[2].min() == pytest.approx(-THICKNESS)


def test_coarser_detail_gives_fewer_solids(tmp_path):
    knot = trimesh.creation.torus(1.0, 0.3)
    fine, coarse = solids_of(tmp_path, knot), solids_of(tmp_path, knot, detail=0.3)
    assert 0 < len(coarse) < len(fine) / 2
    assert not covers(coarse, (0, 0, 0))  # the hole stays


def test_parts_smaller_than_the_detail_become_one_solid_a_cell(tmp_path):
    grains = [trimesh.creation.icosphere(1, 0.02) for _ in range(20)]
    for index, grain in enumerate(grains):
        grain.apply_translation((0.01 + 0.04 * (index % 5), 0.01 + 0.04 * (index // 5), 0.1))
    found = solids_of(tmp_path, trimesh.util.concatenate(grains), detail=1.0)
    assert len(found) == 1


def test_a_file_without_triangles_is_refused(tmp_path):
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    with pytest.raises(InputError, match="no triangles"):
        solid_mesh(tmp_path / "empty.obj")


def test_what_is_thinner_than_the_detail_is_still_there(tmp_path):
    sheet = trimesh.creation.box((4, 0.001, 0.3))
    sheet.update_faces(np.arange(len(sheet.faces)) != 0)  # not closed, so not convex
    sheet = trimesh.util.concatenate([sheet, trimesh.creation.torus(0.5, 0.01)])
    found = solids_of(tmp_path, sheet, detail=0.8)
    assert covers(found, (1.5, 0.0, 0.0))
    for corners in found.solids((1, 1, 1)):
        assert np.linalg.matrix_rank(corners - corners.mean(axis=1, keepdims=True), tol=1e-6) == 3
