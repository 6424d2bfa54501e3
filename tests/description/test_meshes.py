import base64
import io
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from mesh_files import OFFSET, ONE, bounds_in_drake, box, must_not_be_called, near, refusal, write
from PIL import Image

from drake_twin.description import meshes
from drake_twin.description.mesh_file import MESH_SUFFIXES
from drake_twin.description.meshes import (
    collision_mesh,
    collision_pieces,
    mesh_address,
    mesh_primitive,
    visual_mesh,
)

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


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "drake_twin" / "meshes"


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


def picture_in(gltf: dict) -> Image.Image:
    (image,) = gltf["images"]
    view = gltf["bufferViews"][image["bufferView"]]
    (buffer,) = gltf["buffers"]
    content = base64.b64decode(buffer["uri"].partition(",")[2])
    return Image.open(io.BytesIO(content[view.get("byteOffset", 0) :][: view["byteLength"]]))


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


@pytest.mark.parametrize("suffix", ["stl", "ply", "off"])
def test_a_box_has_sharp_edges(tmp_path, suffix):
    """Each of its 24 corners of faces has its face's normal."""
    file = write(box(), tmp_path / f"box.{suffix}")
    lines = visual_mesh(file).read_text().splitlines()
    normals = [tuple(abs(float(number)) for number in line.split()[1:]) for line in lines if line.startswith("vn ")]
    assert len(normals) == 24
    assert set(normals) == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)}
    assert sum(line.startswith("v ") for line in lines) == 8


def test_a_coloured_box_has_sharp_edges(tmp_path):
    mesh = box()
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=[[0, 255, 0, 255]] * len(mesh.vertices))
    file = write(mesh, tmp_path / "box.ply", include_attributes=False, vertex_normal=False)
    scene = trimesh.load_scene(io.BytesIO(visual_mesh(file).read_bytes()), file_type="gltf", process=False)
    (drawn,) = scene.geometry.values()
    assert len(drawn.vertices) == 24
    assert np.abs(drawn.vertex_normals).max(axis=1) == pytest.approx(np.ones(24))
    assert np.asarray(drawn.visual.vertex_colors)[:, 1].tolist() == [255] * 24


def test_an_obj_without_normals_is_given_them(tmp_path, cache):
    file = write(box(), tmp_path / "box.obj", include_normals=False)
    assert "\nvn " in visual_mesh(file).read_text()
    assert visual_mesh(file).parent == cache


def test_an_obj_with_normals_is_taken_as_it_is(tmp_path):
    file = write(box(), tmp_path / "box.obj", include_normals=True)
    assert visual_mesh(file) == file


def test_a_gltf_file_is_taken_as_it_is(tmp_path):
    for name, data in box().export(file_type="gltf").items():
        (tmp_path / ("box.gltf" if name == "model.gltf" else name)).write_bytes(data)
    assert visual_mesh(tmp_path / "box.gltf") == tmp_path / "box.gltf"


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


PAINT = """<library_images><image id="picture"><init_from>../materials/textures/red%20paint.png</init_from></image>
  </library_images><library_effects><effect id="fx"><profile_COMMON><technique sid="standard"><phong><diffuse>
    <texture texture="picture" texcoord="CHANNEL0"/></diffuse></phong></technique></profile_COMMON></effect>
  </library_effects><library_materials><material id="m"><instance_effect url="#fx"/></material></library_materials>
  <library_geometries>"""
CORNER = """<source id="t"><float_array id="ta" count="2">0 0</float_array><technique_common>
  <accessor source="#ta" count="1" stride="2"><param name="S" type="float"/><param name="T" type="float"/></accessor>
  </technique_common></source><vertices"""
TRIANGLE = '<input semantic="TEXCOORD" source="#t" offset="1"/><p>0 0 1 0 2 0'
BOUND = """#g"><bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common>
  </bind_material></instance_geometry>"""


@pytest.mark.parametrize("suffix", ["dae", "obj"])
def test_a_texture_in_the_folder_of_materials_is_carried_too(tmp_path, suffix):
    """As in models of Gazebo; COLLADA as 3ds Max writes it: a texture that names its picture without a sampler."""
    meshes, textures = tmp_path / "model" / "meshes", tmp_path / "model" / "materials" / "textures"
    for folder in (meshes, textures):
        folder.mkdir(parents=True)
    write_textured_obj(meshes)
    (meshes / "square.mtl").write_text("newmtl paint\nKd 1 1 1\nmap_Kd ../materials/textures/paint.png\n")
    (textures / "red paint.png").write_bytes((meshes / "paint.png").read_bytes())
    (meshes / "paint.png").rename(textures / "paint.png")
    text = COLLADA.format(unit="", place="").replace("<library_geometries>", PAINT).replace("<vertices", CORNER)
    text = text.replace('count="1"><input', 'count="1" material="m"><input').replace("<p>0 1 2", TRIANGLE)
    (meshes / "square.dae").write_text(text.replace('#g"/>', BOUND))
    gltf = json.loads(visual_mesh(meshes / f"square.{suffix}").read_text())
    assert picture_in(gltf).convert("RGB").getpixel((0, 0)) == (255, 0, 0)


@pytest.mark.parametrize("is_there", [True, False])
def test_a_texture_that_names_its_file_and_no_image_leaves_the_triangles_there(tmp_path, is_there):
    """A material that cannot be read took its triangles with it."""
    write_textured_obj(tmp_path)
    if not is_there:
        (tmp_path / "paint.png").unlink()
    surface = """<newparam sid="p-surface"><surface type="2D"><init_from>paint.png</init_from></surface></newparam>
      <newparam sid="p-sampler"><sampler2D><source>p-surface</source></sampler2D></newparam><technique"""
    paint = PAINT[PAINT.index("<library_effects>") :].replace("<technique", surface, 1)
    text = COLLADA.format(unit="", place="").replace("<library_geometries>", paint).replace("<vertices", CORNER)
    text = text.replace('count="1"><input', 'count="1" material="m"><input').replace("<p>0 1 2", TRIANGLE)
    text = text.replace('#g"/>', BOUND).replace('texture="picture"', 'texture="p-sampler"')
    (tmp_path / "square.dae").write_text(text)
    gltf = json.loads(visual_mesh(tmp_path / "square.dae").read_text())
    assert [accessor["count"] for accessor in gltf["accessors"]][:1] == [3]
    assert ("images" in gltf) is is_there


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


# The cache


@pytest.fixture
def convert_nothing(monkeypatch):
    def stop() -> None:
        for name in ("_visual_obj", "_visual_gltf", "_hull_obj", "read_scene"):
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
