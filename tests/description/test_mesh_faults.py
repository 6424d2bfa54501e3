"""What is wrong with a mesh, beside closed forms and beside trimesh."""

import re

import numpy as np
import pytest
import trimesh
from bad_shapes import FORMATS, MESHES, write_mesh
from mesh_files import refusal

from drake_twin.description import mesh_file, mesh_findings, meshes
from drake_twin.description.mesh_faults import MeshFaults, faults_of
from drake_twin.description.mesh_findings import said_of_hull, said_of_hulls, said_of_solids, said_of_visual
from drake_twin.description.meshes import collision_mesh, mesh_faults, visual_mesh
from drake_twin.progress import heard

# What differs from a sound mesh: a cube has 12 triangles, 18 edges.
FAULTS = {
    "sound": {},
    "wedge": {"triangles": 4},
    "inside out": {"is_inside_out": True},
    "half inside out": {"turned_edges": 8},
    "two-sided": {"triangles": 24, "two_sided": 12},
    "doubled": {"triangles": 24, "doubled": 12},
    "open": {"triangles": 10, "open_edges": 4},
    "not manifold": {"triangles": 13, "open_edges": 2, "crowded_edges": 1},
    "degenerate": {"triangles": 15, "degenerate": 3},
    "slivers": {"triangles": 13, "degenerate": 1},
    "flat": {"triangles": 2, "open_edges": 4, "dimensions": 2, "is_thin": True},
    "flat, two-sided": {"triangles": 4, "two_sided": 2, "open_edges": 4, "dimensions": 2, "is_thin": True},
    "one triangle": {"triangles": 1, "open_edges": 3, "dimensions": 2, "is_thin": True},
    "line": {"triangles": 1, "degenerate": 1, "dimensions": 1, "is_thin": True},
    "point": {"triangles": 2, "degenerate": 2, "dimensions": 0, "is_thin": True},
    "not a number": {"triangles": 11, "unplaced": 1, "open_edges": 3},
    "infinite": {"triangles": 11, "unplaced": 1, "open_edges": 3},
    "thin": {"is_thin": True},
    "1e-6 m": {},
    "1e6 m": {},
}


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("name", FAULTS)
def test_the_faults_of_a_mesh_are_counted(tmp_path, name, suffix):
    if FAULTS[name].get("unplaced") and suffix == "dae":  # its reader takes zeros instead
        what = refusal(mesh_faults, write_mesh(MESHES[name], tmp_path / f"mesh.{suffix}"))
        assert what.endswith("mesh.dae: the mesh has a corner that is not a finite point.")
        return
    found = mesh_faults(write_mesh(MESHES[name], tmp_path / f"mesh.{suffix}"))
    assert found == MeshFaults(**{"triangles": 12} | FAULTS[name])


@pytest.mark.parametrize("seed", range(30))
def test_what_is_open_or_turned_or_inside_out_is_what_trimesh_finds(seed):
    random = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = ball.faces.copy()
    if seed % 3 == 1:
        faces = np.delete(faces, random.integers(len(faces), size=seed), axis=0)
    if seed % 3 == 2:
        turned = random.integers(len(faces), size=seed // 3)
        faces[turned] = faces[turned, ::-1]
    if seed % 2:
        faces = faces[:, ::-1]
    peer = trimesh.Trimesh(ball.vertices, faces, process=False)
    soup = ball.vertices[faces].reshape(-1, 3)  # as STL has it
    found = faults_of(soup, np.arange(len(soup)).reshape(-1, 3))
    assert (found.open_edges + found.crowded_edges == 0) == peer.is_watertight
    assert found.open_edges == len(trimesh.grouping.group_rows(peer.edges_sorted, require_count=1))
    if peer.is_watertight:
        assert (found.turned_edges == 0) == peer.is_winding_consistent
        assert found.is_inside_out == (peer.volume < 0)


def test_a_cavity_is_not_inside_out():
    outer, inner = trimesh.creation.box((2, 2, 2)), trimesh.creation.box((1, 1, 1))
    inner.invert()
    both = trimesh.util.concatenate([outer, inner])
    assert list(faults_of(both.vertices, both.faces).of_solid()) == []


def said(function, name: str, folder, suffix: str = "binary.stl") -> list[str]:
    return list(function(write_mesh(MESHES[name], folder / f"m.{suffix}")))


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("sound", None),
        ("open", None),
        ("not manifold", None),
        ("inside out", "triangles that face inwards: its convex hull collides"),
        ("two-sided", "each triangle twice, facing opposite ways: its convex hull collides"),
        ("flat", "all corners in one plane: its convex hull collides, a thousandth of its size thick"),
        ("thin", "less thickness than 0.001 of its size: its convex hull collides, a thousandth of its size thick"),
        ("line", "all corners on one line: its convex hull collides, a thousandth of its size thick"),
        ("infinite", "1 triangle with corners that are not finite numbers: its convex hull collides"),
    ],
)
def test_what_changes_a_hull_is_said(tmp_path, name, what):
    expected = [] if what is None else [f"collision mesh m.binary.stl has {what}"]
    assert said(said_of_hull, name, tmp_path) == expected


def test_what_does_not_change_hulls_is_one_sentence(tmp_path):
    names = ("sound", "not manifold", "degenerate", "doubled", "half inside out", "open")
    files = [write_mesh(MESHES[name], tmp_path / f"{name}.binary.stl") for name in names]
    (sentence,) = said_of_hulls(files)
    assert sentence == (
        "convex hulls collide in place of faulty meshes, as of sound ones: not manifold.binary.stl (1 edge of more "
        "than two triangles); degenerate.binary.stl (3 triangles "
        "without area); doubled.binary.stl (12 triangles twice) and 1 more"
    )
    assert list(said_of_hulls(files[:1])) == []
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.faces[:2] = ball.faces[:2, ::-1]
    (tmp_path / "ball.stl").write_bytes(ball.export(file_type="stl"))
    assert list(mesh_faults(tmp_path / "ball.stl").of_surface()) != []
    assert list(said_of_hulls([tmp_path / "ball.stl"])) == []  # most meshes of robots have some such edges


def test_what_may_change_a_static_mesh_is_said(tmp_path):
    (sentence,) = said(said_of_solids, "two-sided", tmp_path)
    assert sentence.startswith("collision mesh m.binary.stl has each triangle twice, facing opposite ways")
    assert sentence.endswith(": convex parts of it collide as solids, other faces as slabs")
    assert said(said_of_solids, "open", tmp_path) == []


def test_what_is_not_drawn_as_written_is_said(tmp_path, monkeypatch):
    assert said(said_of_visual, "two-sided", tmp_path) == []
    (sentence,) = said(said_of_visual, "inside out", tmp_path)
    both_sides = "the twin draws both sides of them, Gazebo the outer one"
    assert sentence == f"visual mesh m.binary.stl has triangles that face inwards: {both_sides}"
    assert said(said_of_visual, "not a number", tmp_path, "obj") == [
        "visual mesh m.obj: 1 triangle with corners that are not finite numbers are not drawn"
    ]
    for module in (meshes, mesh_findings):
        monkeypatch.setattr(module, "MOST_DRAWN", 100)
    file = tmp_path / "ball.stl"
    file.write_bytes(trimesh.creation.icosphere(subdivisions=3).export(file_type="stl"))
    assert list(said_of_visual(file)) == ["visual mesh ball.stl: 1,280 triangles are drawn as at most 100"]
    drawn = trimesh.load_mesh(visual_mesh(file))
    assert 10 < len(drawn.faces) <= 100
    assert drawn.extents == pytest.approx([2, 2, 2], rel=0.5)


def test_a_binary_stl_of_ten_million_triangles_is_refused_before_it_is_read(tmp_path, monkeypatch):
    file = tmp_path / "scan.stl"
    with file.open("wb") as content:
        content.write(b"scan".ljust(80) + (10_000_000).to_bytes(4, "little"))
        content.truncate(84 + 50 * 10_000_000)  # without a block on the disk
    monkeypatch.setattr(mesh_file, "read_scene", None)
    for use in (collision_mesh, visual_mesh, mesh_faults):
        what = "the mesh has 10,000,000 triangles, and 2,000,000 are the most"
        assert refusal(use, file) == f"{file}: {what}: decimate it, in Blender or MeshLab for example."


@pytest.mark.parametrize("suffix", ["obj", "ascii.stl"])
def test_a_long_text_of_too_many_triangles_is_refused_before_it_is_read(tmp_path, monkeypatch, suffix):
    monkeypatch.setattr(mesh_file, "MOST_TRIANGLES", 11)
    monkeypatch.setattr(mesh_file, "_MANY_BYTES_OF_TEXT", 100)
    monkeypatch.setattr(mesh_file, "read_scene", None)
    file = write_mesh(MESHES["sound"], tmp_path / f"m.{suffix}")
    for use in (collision_mesh, visual_mesh):
        assert "the mesh has 12 triangles, and 11 are the most" in refusal(use, file)


def test_normals_of_collada_may_be_anything(tmp_path):
    file = write_mesh(MESHES["sound"], tmp_path / "m.dae")
    source = file.read_text().partition("<source")[2].partition("</source>")[0].replace('"p', '"n').replace("#p", "#n")
    normals = re.sub(r">[-0-9. ]+</float_array>", f">{' '.join(['nan'] * 108)}</float_array>", source)
    text = file.read_text().replace("<vertices", f"<source{normals}</source><vertices")
    assert text.count("nan") == 108
    file.write_text(text)
    assert mesh_faults(file).triangles == 12


@pytest.mark.parametrize("suffix", ["obj", "dae", "ascii.stl"])
def test_a_text_of_too_many_triangles_is_refused_with_their_number(tmp_path, monkeypatch, suffix):
    monkeypatch.setattr(mesh_file, "MOST_TRIANGLES", 11)
    file = write_mesh(MESHES["sound"], tmp_path / f"m.{suffix}")
    for use in (collision_mesh, visual_mesh):
        assert "the mesh has 12 triangles, and 11 are the most" in refusal(use, file)


def test_the_progress_tells_what_is_read(tmp_path):
    steps: list[str] = []
    with heard(steps.append):
        collision_mesh(write_mesh(MESHES["sound"], tmp_path / "m.binary.stl"))
    assert steps[0] == "reading m.binary.stl (0.0 MB)"
