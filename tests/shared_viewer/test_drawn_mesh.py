import base64
import json

import numpy as np
import pytest
from PIL import Image

from drake_twin.shared_viewer.drawn_mesh import read_mesh

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 2 0\nvn 0 0 1\n"


@pytest.fixture
def obj(tmp_path):
    """Writes an OBJ file of a triangle with the normal +z, which a material may cover."""

    def write(mtl="", face="f 1//1 2//1 3//1\n", more=""):
        (tmp_path / "look.mtl").write_text(mtl)
        file = tmp_path / "mesh.obj"
        file.write_text(("mtllib look.mtl\n" if mtl else "") + TRIANGLE + more + face)
        return file

    return write


def outward(part):
    """The normals that follow from the order of the corners."""
    a, b, c = (part.vertices[part.faces[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def test_without_a_material_the_color_is_left_open(obj):
    (part,) = read_mesh(obj(), (1, 1, 1))
    assert part.color is None
    assert np.sort(part.vertices, axis=0).tolist() == [[0, 0, 0], [0, 0, 0], [1, 2, 0]]


def test_each_material_is_a_part_with_its_color_and_opacity(obj):
    mtl = "newmtl red\nKd 1 0 0\nnewmtl glass\nKd 0 0 1\nd 0.5\n"
    face = "usemtl red\nf 1//1 2//1 3//1\nusemtl glass\nf 3//1 2//1 1//1\n"
    parts = read_mesh(obj(mtl, face), (1, 1, 1))
    assert sorted(part.color for part in parts) == [(0.0, 0.0, 1.0, 0.5), (1.0, 0.0, 0.0, 1.0)]


def test_a_texture_comes_with_where_it_lies(obj, tmp_path):
    Image.new("RGB", (2, 2), (0, 255, 0)).save(tmp_path / "green.png")
    face = "vt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\n"
    (part,) = read_mesh(obj("newmtl m\nKd 1 1 1\nmap_Kd green.png\n", face), (1, 1, 1))
    assert part.texture.startswith(b"\x89PNG")
    assert part.uv.tolist() == [[x, y / 2] for x, y, _ in part.vertices.tolist()]


def test_without_places_on_a_texture_a_mesh_has_its_materials_color(obj, tmp_path):
    Image.new("RGB", (2, 2), (0, 255, 0)).save(tmp_path / "green.png")
    face = "usemtl m\nf 1//1 2//1 3//1\n"
    (part,) = read_mesh(obj("newmtl m\nKd 1 0 0\nmap_Kd green.png\n", face), (1, 1, 1))
    assert (part.color, part.texture, part.uv) == ((1.0, 0.0, 0.0, 1.0), None, None)


def test_the_scale_is_applied_to_corners_and_normals(obj):
    (part,) = read_mesh(obj(more="vn 1 1 0\n", face="f 1//2 2//2 3//2\n"), (2, 1, 1))
    assert part.vertices[:, 0].max() == 2
    assert part.normals[0] == pytest.approx(np.array([1, 2, 0]) / np.sqrt(5))


def test_a_mirrored_mesh_shows_its_front(obj):
    (part,) = read_mesh(obj(), (1, 1, -1))
    assert part.normals[0] == pytest.approx([0, 0, -1])
    assert outward(part)[0] == pytest.approx([0, 0, -1])


def test_gltf_is_turned_from_y_up_to_z_up_as_drake_does(tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 5, 0]], dtype=np.float32)
    data = "data:application/octet-stream;base64," + base64.b64encode(corners.tobytes()).decode()
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 5, 0]}
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}}],
        "buffers": [{"uri": data, "byteLength": corners.nbytes}],
        "bufferViews": [{"buffer": 0, "byteLength": corners.nbytes}],
        "accessors": [accessor],
    }
    file = tmp_path / "mesh.gltf"
    file.write_text(json.dumps(document))
    (part,) = read_mesh(file, (1, 1, 1))
    assert part.vertices.max(axis=0) == pytest.approx([1, 0, 5])
    assert part.color == (0, 1, 0, 1)


@pytest.mark.parametrize("text", ["", "v 0 0\n", "v 0 0 0\nf 1 2 3\n"])
def test_what_is_no_mesh_is_refused_in_words(tmp_path, text):
    file = tmp_path / "mesh.obj"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"\w+"):
        read_mesh(file, (1, 1, 1))
