import base64
import io
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from pydrake.geometry import Mesh
from scipy.spatial import ConvexHull

from drake_twin.description import meshes
from drake_twin.description.meshes import (
    MESH_SUFFIXES,
    Primitive,
    collision_mesh,
    collision_pieces,
    mesh_address,
    mesh_primitive,
    visual_mesh,
)
from drake_twin.errors import InputError

# A triangle with legs of 1000 units; {unit} says how long a unit is.
COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>{unit}<up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="pa" count="9">0 0 0 1000 0 0 0 1000 0</float_array><technique_common>
      <accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
        <param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node id="n">{place}<instance_geometry url="#g"/></node></visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""
OFFSET = (1.0, 2.0, 3.0)
ONE = (1.0, 1.0, 1.0)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "drake_twin" / "meshes"


def box(extents=(1.0, 2.0, 3.0), offset=(0.0, 0.0, 0.0)) -> trimesh.Trimesh:
    mesh = trimesh.creation.box(extents)
    mesh.apply_translation(offset)
    return mesh


def write(mesh: trimesh.Trimesh, file: Path, **options) -> Path:
    content = mesh.export(file_type=file.suffix[1:].lower(), **options)
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def write_colored(file: Path) -> Path:
    """An upright box beside the origin whose material is orange."""
    mesh = box(offset=OFFSET)
    orange = trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 128, 0, 255])
    mesh.visual = trimesh.visual.TextureVisuals(material=orange)
    return write(mesh, file)


def write_textured_obj(folder: Path) -> Path:
    """A square of an OBJ file whose texture is a red picture beside it."""
    Image.new("RGB", (4, 2), (255, 0, 0)).save(folder / "paint.png")
    (folder / "square.mtl").write_text("newmtl paint\nKd 1 1 1\nmap_Kd paint.png\n")
    corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    (folder / "square.obj").write_text(f"mtllib square.mtl\n{corners}usemtl paint\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
    return folder / "square.obj"


def bounds_in_drake(file: Path) -> list[list[float]]:
    hull = Mesh(str(file)).GetConvexHull()
    vertices = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
    return [vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()]


def near(bounds) -> list:
    return [pytest.approx(list(corner), abs=1e-6) for corner in bounds]


def picture_in(gltf: dict) -> Image.Image:
    (image,) = gltf["images"]
    view = gltf["bufferViews"][image["bufferView"]]
    (buffer,) = gltf["buffers"]
    content = base64.b64decode(buffer["uri"].partition(",")[2])
    return Image.open(io.BytesIO(content[view.get("byteOffset", 0) :][: view["byteLength"]]))


def refusal(call, *arguments) -> str:
    with pytest.raises(InputError) as raised:
        call(*arguments)
    return str(raised.value)


# Visuals


@pytest.mark.parametrize("suffix", ["stl", "STL", "off", "ply", "obj"])
def test_a_mesh_without_colours_becomes_an_obj_of_the_same_size_in_the_cache(tmp_path, cache, suffix):
    mesh = box(offset=OFFSET)
    converted = visual_mesh(write(mesh, tmp_path / f"box.{suffix}"))
    assert converted.parent == cache
    assert converted.suffix == ".obj"
    assert bounds_in_drake(converted) == near(mesh.bounds)


def test_the_obj_has_normals_which_drakes_renderer_needs(tmp_path):
    assert "\nvn " in visual_mesh(write(box(), tmp_path / "box.stl")).read_text()


def test_an_obj_without_normals_is_given_them(tmp_path, cache):
    file = write(box(), tmp_path / "box.obj", include_normals=False)
    assert "\nvn " in visual_mesh(file).read_text()
    assert visual_mesh(file).parent == cache


def test_an_obj_with_normals_is_taken_as_it_is(tmp_path, cache):
    file = write(box(), tmp_path / "box.obj", include_normals=True)
    assert visual_mesh(file) == file
    assert not cache.exists()


def test_a_gltf_file_is_taken_as_it_is(tmp_path, cache):
    (tmp_path / "box.gltf").touch()
    assert visual_mesh(tmp_path / "box.gltf") == tmp_path / "box.gltf"
    assert not cache.exists()


@pytest.mark.parametrize("suffix", ["dae", "glb"])
def test_colours_survive(tmp_path, suffix):
    converted = visual_mesh(write_colored(tmp_path / f"box.{suffix}"))
    assert converted.suffix == ".gltf"
    (material,) = json.loads(converted.read_text())["materials"]
    assert material["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx([1.0, 0.5, 0.0, 1.0], abs=0.01)


def test_colours_of_vertices_survive(tmp_path):
    mesh = box()
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=[[0, 255, 0, 255]] * len(mesh.vertices))
    converted = json.loads(visual_mesh(write(mesh, tmp_path / "box.ply")).read_text())
    assert "COLOR_0" in converted["meshes"][0]["primitives"][0]["attributes"]


def test_a_texture_beside_an_obj_is_carried_inside_the_gltf(tmp_path):
    gltf = json.loads(visual_mesh(write_textured_obj(tmp_path)).read_text())
    assert picture_in(gltf).convert("RGB").getpixel((0, 0)) == (255, 0, 0)
    assert "TEXCOORD_0" in gltf["meshes"][0]["primitives"][0]["attributes"]


def test_a_texture_inside_a_glb_stays_inside(tmp_path):
    mesh = box()
    picture = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.new("RGB", (2, 2), (0, 0, 255)))
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)), material=picture)
    gltf = json.loads(visual_mesh(write(mesh, tmp_path / "box.glb")).read_text())
    assert picture_in(gltf).convert("RGB").getpixel((0, 0)) == (0, 0, 255)


@pytest.mark.parametrize("suffix", ["dae", "glb"])
def test_a_gltf_stands_upright_in_drake(tmp_path, suffix):
    converted = visual_mesh(write_colored(tmp_path / f"box.{suffix}"))
    assert bounds_in_drake(converted) == near(box(offset=OFFSET).bounds)


@pytest.mark.parametrize(("unit", "size"), [("", 1000.0), ('<unit name="millimeter" meter="0.001"/>', 1.0)])
@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh])
def test_colladas_unit_is_applied_as_in_rviz_and_gazebo(tmp_path, convert, unit, size):
    (tmp_path / "part.dae").write_text(COLLADA.format(unit=unit, place=""))
    lower, upper = bounds_in_drake(convert(tmp_path / "part.dae"))
    assert upper[0] - lower[0] == pytest.approx(size)


@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh])
def test_a_node_of_collada_moves_its_mesh(tmp_path, convert):
    (tmp_path / "part.dae").write_text(COLLADA.format(unit="", place="<translate>0 0 500</translate>"))
    lower, upper = bounds_in_drake(convert(tmp_path / "part.dae"))
    assert (lower[2] + upper[2]) / 2 == pytest.approx(500.0)


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
    assert text == "collision: decomposition needs the package coacd: pip install 'drake-twin[decomposition]'."


# The cache


def must_not_be_called(file: Path) -> bytes:
    raise AssertionError(f"{file} was converted again")


@pytest.fixture
def convert_nothing(monkeypatch):
    def stop() -> None:
        for name in ("_visual_obj", "_visual_gltf", "_hull_obj", "_scene"):
            monkeypatch.setattr(meshes, name, must_not_be_called)

    return stop


@pytest.mark.parametrize("suffix", ["stl", "dae", "glb", "ply", "obj"])
def test_the_second_time_nothing_is_converted(tmp_path, convert_nothing, suffix):
    file = write_colored(tmp_path / f"box.{suffix}")
    first = visual_mesh(file), collision_mesh(file), mesh_primitive(file, ONE)
    convert_nothing()
    assert (visual_mesh(file), collision_mesh(file), mesh_primitive(file, ONE)) == first


def test_the_same_content_elsewhere_is_not_converted_again(tmp_path, convert_nothing):
    first, second = write(box(), tmp_path / "box.stl"), write(box(), tmp_path / "chassis.STL")
    converted = visual_mesh(first)
    convert_nothing()
    assert visual_mesh(second) == converted


def test_a_changed_mesh_is_converted_again(tmp_path):
    before = visual_mesh(write(box(), tmp_path / "box.stl"))
    after = visual_mesh(write(box((4.0, 4.0, 4.0)), tmp_path / "box.stl"))
    assert trimesh.load_mesh(after).extents == pytest.approx([4.0, 4.0, 4.0])
    assert before != after


def test_a_relative_cache_folder_still_gives_absolute_meshes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert visual_mesh(write(box(), tmp_path / "box.stl")).is_absolute()


# What cannot be read


@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh, collision_pieces])
def test_an_unknown_suffix_is_refused_with_those_that_are_known(tmp_path, convert):
    assert refusal(convert, tmp_path / "part.step") == (
        f"{tmp_path}/part.step: unknown mesh format '.step'. Valid: {', '.join(MESH_SUFFIXES)}."
    )


def test_a_file_without_a_suffix_is_refused(tmp_path):
    assert "the mesh's file name has no suffix" in refusal(visual_mesh, tmp_path / "part")


@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh])
@pytest.mark.parametrize("content", [b"", b"no mesh", b"solid empty\nendsolid empty\n"])
def test_an_stl_without_triangles_is_refused(tmp_path, convert, content):
    (tmp_path / "part.stl").write_bytes(content)
    assert refusal(convert, tmp_path / "part.stl") == f"{tmp_path}/part.stl: the mesh holds no triangles."


@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh])
@pytest.mark.parametrize("suffix", ["stl", "dae", "glb", "ply", "obj"])
@pytest.mark.parametrize("part", [0.1, 0.5])
def test_a_mesh_that_was_cut_short_is_refused(tmp_path, convert, suffix, part):
    file = write_colored(tmp_path / f"part.{suffix}")
    file.write_bytes(file.read_bytes()[: int(part * file.stat().st_size)])
    assert refusal(convert, file).startswith(f"{file}: the mesh ")


@pytest.mark.parametrize("suffix", sorted(MESH_SUFFIXES))
def test_text_that_is_no_mesh_is_refused_as_collision_shape(tmp_path, suffix):
    (tmp_path / f"part{suffix}").write_text("<html>404: not found</html>")
    assert refusal(collision_mesh, tmp_path / f"part{suffix}").startswith(f"{tmp_path}/part{suffix}: the mesh ")


@pytest.mark.parametrize("convert", [visual_mesh, collision_mesh])
def test_a_missing_mesh_is_named(tmp_path, convert):
    text = refusal(convert, tmp_path / "gone.stl")
    assert text == f"{tmp_path}/gone.stl: the mesh cannot be read (No such file or directory)."


def test_triangles_whose_corners_are_no_numbers_are_left_out(tmp_path):
    triangles = "v 0 0 0\nv 9 9 nan\nv 0 1 0\nv 1 1 0\nf 1 3 4\nf 1 2 3\n"
    (tmp_path / "part.obj").write_text(triangles)
    assert bounds_in_drake(collision_mesh(tmp_path / "part.obj"))[1] == pytest.approx([1.0, 1.0, 0.0], abs=2e-3)


@pytest.mark.parametrize("corners", ["v 0 0\nv 1 0\nv 0 1\n", "v 0 0 0\nv 1e300 0 0\nv 0 1 0\n"])
def test_vertices_that_are_no_points_in_space_are_refused(tmp_path, corners):
    (tmp_path / "part.obj").write_text(corners + "f 1 2 3\n")
    assert refusal(collision_mesh, tmp_path / "part.obj").startswith(f"{tmp_path}/part.obj: the mesh ")


def test_an_address_keeps_spaces_and_accents_as_drake_takes_them():
    assert mesh_address(Path("/my robots/é.obj")) == "file:///my robots/é.obj"
