"""Meshes that strangers wrote: broken, endless, or pipes in place of files. Each is one paragraph, and no reader hangs.

Drake's reader of glTF ends the process at some of these: what is not refused here would be seen as a crash.
"""

import base64
import copy
import json
import os
import struct

import pytest

from drake_twin.description.gltf_file import check_gltf
from drake_twin.description.mesh_file import check_mesh_file
from drake_twin.description.meshes import collision_mesh, visual_mesh
from drake_twin.errors import InputError

CORNERS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
INDICES = bytes((0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3))
SOUND = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "children": [1]}, {"translation": [0, 0, 1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
        {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"},
    ],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60, "uri": "m.bin"}],
}


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def with_value(path, value):
    """Return the sound document with one value changed; `...` deletes it."""
    document = copy.deepcopy(SOUND)
    *holders, last = path
    holder = document
    for key in holders:
        holder = holder[key]
    if value is ...:
        del holder[last]
    else:
        holder[last] = value
    return document


def written(folder, document):
    (folder / "m.bin").write_bytes(CORNERS + INDICES)
    file = folder / "m.gltf"
    file.write_text(document if isinstance(document, str) else json.dumps(document))
    return file


def test_a_sound_file_is_drawn_as_it_is_and_collides(tmp_path):
    file = written(tmp_path, SOUND)
    assert visual_mesh(file) == file
    assert collision_mesh(file).is_file()


@pytest.mark.parametrize("text", ["", "hello", "[]", "[" * 100_000, "{}{}", "\0", '{"asset": NaN, "meshes": 3}'])
def test_what_is_not_an_object_is_refused(tmp_path, text):
    file = written(tmp_path, text)
    for read in (visual_mesh, collision_mesh):
        with pytest.raises(InputError, match=r"m\.gltf: the mesh is not valid glTF"):
            read(file)


WRONG = [
    (("buffers",), [], "bufferViews[0].buffer is 0, and there are 0 buffers"),
    (("buffers", 0, "uri"), ..., "buffers[0] has 0 bytes, not 60"),
    (("buffers", 0, "uri"), 3, "buffers[0].uri is 3"),
    (("buffers", 0, "uri"), "gone.bin", "which cannot be read (No such file or directory)"),
    (("buffers", 0, "uri"), "/dev/zero", "this is not a file"),
    (("buffers", 0, "uri"), "http://127.0.0.1/m.bin", "which cannot be read"),
    (("buffers", 0, "uri"), "\0", "which cannot be read"),
    (("buffers", 0, "uri"), "data:application/octet-stream;base64,!!!", "not valid base64"),
    (("buffers", 0, "byteLength"), 61, "buffers[0] has 60 bytes, not 61"),
    (("buffers", 0, "byteLength"), 10**12, "buffers[0].byteLength is 1000000000000"),
    (("buffers", 0, "byteLength"), True, "buffers[0].byteLength is True"),
    (("bufferViews", 0, "byteLength"), 61, "bufferViews[0] ends at byte 61 of 60"),
    (("bufferViews", 0, "byteOffset"), -1, "bufferViews[0].byteOffset is -1"),
    (("bufferViews", 0, "byteStride"), 400, "byteStride is 400"),
    (("accessors", 0, "bufferView"), 9, "accessors[0].bufferView is 9, and there are 2 bufferViews"),
    (("accessors", 0, "bufferView"), -1, "accessors[0].bufferView is -1"),
    (("accessors", 0, "componentType"), 1, "accessors[0].componentType is 1"),
    (("accessors", 0, "type"), "VEC9", "accessors[0].type is 'VEC9'"),
    (("accessors", 0, "type"), ["VEC3"], "accessors[0].type is"),
    (("accessors", 0, "count"), 5, "ends at byte 60 of the 48 of its bufferView"),
    (("accessors", 0, "count"), 0, "accessors[0].count is 0"),
    (("accessors", 0, "count"), 1e3, "accessors[0].count is 1000.0"),
    (("accessors", 0, "min"), "x", "accessors[0].min is 'x'"),
    (("accessors", 0, "sparse"), {}, "is sparse"),
    (("accessors", 1, "componentType"), 5126, "ends at byte 48 of the 12 of its bufferView"),
    (("meshes",), "x", "meshes is not a list of objects"),
    (("meshes",), None, "meshes is not a list of objects"),
    (("meshes", 0, "primitives", 0, "attributes"), ..., "has no attributes"),
    (("meshes", 0, "primitives", 0, "attributes", "POSITION"), 7, "POSITION is 7, and there are 2 accessors"),
    (("meshes", 0, "primitives", 0, "attributes", "POSITION"), 1, "POSITION is not of three floats"),
    (("meshes", 0, "primitives", 0, "attributes", "NORMAL"), 1, "different counts"),
    (("meshes", 0, "primitives", 0, "indices"), 0, "indices are not whole numbers"),
    (("meshes", 0, "primitives", 0, "material"), 1, "material is 1, and there are 1 materials"),
    (("meshes", 0, "primitives", 0, "mode"), 7, "mode is 7"),
    (("nodes", 0, "children"), [0], "a node is below itself"),
    (("nodes", 1, "children"), [0], "a node is below itself"),
    (("nodes", 0, "children"), [1, 1], "a child that another node has, too"),
    (("nodes", 0, "children"), 1, "children is not a list"),
    (("nodes", 0, "mesh"), "0", "nodes[0].mesh is '0'"),
    (("nodes", 0, "matrix"), [1.0] * 15, "which must be 16 finite numbers"),
    (("nodes", 0, "matrix"), [1e300] * 16, "which must be 16 finite numbers"),
    (("nodes", 0, "skin"), 0, "nodes[0].skin is 0, and there are 0 skins"),
    (("nodes",), [{"children": [index + 1]} for index in range(600)] + [{"mesh": 0}], "more than 500 levels deep"),
    (("scenes", 0, "nodes"), [5], "scenes[0].nodes is 5"),
    (("scene",), 1, "the document.scene is 1"),
    (("images",), [{}], "images[0] has no content"),
    (("images",), [{"uri": 5}], "images[0].uri is 5"),
    (("textures",), [{"source": 0}], "textures[0].source is 0, and there are 0 images"),
    (("materials", 0, "normalTexture"), {"index": 3}, "materials[0].normalTexture.index is 3"),
    (("materials", 0, "extensions"), {"KHR_x": {"aTexture": {}}}, "extensions.KHR_x.aTexture.index is None"),
    (("skins",), [{"joints": [4]}], "skins[0].joints is 4"),
    (("animations",), [{"channels": [{"sampler": 0}]}], "a channel without a sampler"),
    (("animations",), [{"samplers": [{"input": 9, "output": 0}]}], "samplers.input is 9"),
]


@pytest.mark.parametrize(("path", "value", "what"), WRONG, ids=[what[:40] for *_, what in WRONG])
def test_a_number_that_is_out_of_range_is_named(tmp_path, path, value, what):
    file = written(tmp_path, with_value(path, value))
    with pytest.raises(InputError) as refused:
        check_gltf(file)
    assert what in str(refused.value)
    for read in (visual_mesh, collision_mesh):
        with pytest.raises(InputError):
            read(file)


@pytest.mark.parametrize(
    ("corners", "indices", "what"),
    [
        (struct.pack("<12f", *[float("nan")] * 12), INDICES, "a corner that is not a finite point"),
        (struct.pack("<12f", *[1e30] * 12), INDICES, "a corner that is not a finite point"),
        (CORNERS, bytes((0, 1, 4) * 4), "has the corner 4 of 4"),
    ],
)
def test_the_numbers_in_its_buffers_are_checked_too(tmp_path, corners, indices, what):
    data = base64.b64encode(corners + indices).decode()
    file = written(tmp_path, with_value(("buffers", 0, "uri"), f"data:application/octet-stream;base64,{data}"))
    with pytest.raises(InputError, match=what):
        visual_mesh(file)


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"glTF", "it has no JSON"),
        (b"glTF" + struct.pack("<II", 2, 0xFFFFFFFF) + struct.pack("<I", 0xFFFFFFF0) + b"JSON{}", "it is cut off"),
        (b"glTF" + struct.pack("<III", 2, 22, 2) + b"JSON[]", "its JSON is not an object"),
    ],
)
def test_a_binary_file_is_checked_likewise(tmp_path, data, what):
    (tmp_path / "m.glb").write_bytes(data)
    with pytest.raises(InputError, match=what):
        visual_mesh(tmp_path / "m.glb")


def test_a_changed_buffer_beside_it_is_checked_again(tmp_path):
    file = written(tmp_path, SOUND)
    visual_mesh(file)
    (tmp_path / "m.bin").write_bytes(CORNERS + bytes((0, 1, 9) * 4))
    check_gltf_again = os.stat(file)
    os.utime(file, ns=(check_gltf_again.st_atime_ns, check_gltf_again.st_mtime_ns + 1))
    with pytest.raises(InputError, match="has the corner 9 of 4"):
        visual_mesh(file)


# What a mesh names beside it

FACES = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 4\nf 2 3 4\nf 1 3 4\n"
BESIDE = {
    "m.obj": ("mtllib x\nusemtl a\n" + FACES, None),
    "plain.obj": ("mtllib x\nusemtl a\n" + FACES.replace("vn 0 0 1\n", "").replace("//1", ""), None),
    "of_mtl.obj": ("mtllib a.mtl\nusemtl a\n" + FACES, "newmtl a\nmap_Kd -s 1 1 1 x\n"),
    "in_small.obj": ("mtllib a.mtl\nusemtl a\n" + FACES, "newmtl a\nmap_kd x\n"),
    "bump.obj": ("mtllib a.mtl\nusemtl a\n" + FACES, "newmtl a\nbump x\n"),
    "m.dae": ("<COLLADA><library_images><image><init_from>x</init_from></image></library_images></COLLADA>", None),
    "m.gltf": (json.dumps({**SOUND, "images": [{"uri": "x"}]}), None),
}


@pytest.mark.parametrize("kind", ["pipe", "device"])
@pytest.mark.parametrize("name", BESIDE)
def test_a_pipe_or_a_device_beside_a_mesh_is_refused_and_not_waited_for(tmp_path, name, kind):
    content, materials = BESIDE[name]
    (tmp_path / name).write_text(content)
    (tmp_path / "m.bin").write_bytes(CORNERS + INDICES)
    if materials is not None:
        (tmp_path / "a.mtl").write_text(materials)
    if kind == "pipe":
        os.mkfifo(tmp_path / "x")
    else:
        (tmp_path / "x").symlink_to("/dev/zero")
    for read in (check_mesh_file, visual_mesh, collision_mesh):
        with pytest.raises(InputError, match="this is not a file, but a folder, a device or a pipe"):
            read(tmp_path / name)


def test_materials_that_name_themselves_are_read_once(tmp_path):
    (tmp_path / "m.obj").write_text("mtllib a.mtl\nusemtl a\n" + FACES)
    (tmp_path / "a.mtl").write_text("newmtl a\nmap_Kd b.mtl\n")
    (tmp_path / "b.mtl").write_text("newmtl b\nmap_Kd a.mtl\nmap_Kd b.mtl\n")
    assert collision_mesh(tmp_path / "m.obj").is_file()


@pytest.mark.parametrize("name", ["m.stl", "m.obj", "m.gltf", "m.dae"])
def test_a_link_to_itself_is_one_paragraph(tmp_path, name):
    (tmp_path / name).symlink_to(name)
    for read in (visual_mesh, collision_mesh):
        with pytest.raises(InputError, match="the mesh cannot be read"):
            read(tmp_path / name)


@pytest.mark.parametrize(
    "text",
    [
        "v 0 0 0\nvn 0 0 1\nf 1//1 2//5 9//9\n",
        "vn 0 0 1\nf 0//0 0//0 0//0\n",
        FACES + "f -9//-9 -8//-7 -1//-1\n",
        "vn 0 0 1\nv a b c\nf x y z\n",
    ],
)
def test_an_obj_at_which_drakes_reader_fails_is_refused(tmp_path, text):
    (tmp_path / "m.obj").write_text(text)
    for read in (visual_mesh, collision_mesh):
        with pytest.raises(InputError):
            read(tmp_path / "m.obj")


def test_an_obj_whose_corners_are_in_one_point_is_converted_to_be_drawn_and_does_not_collide(tmp_path):
    file = tmp_path / "m.obj"
    file.write_text("vn 0 0 1\nv 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n")
    assert visual_mesh(file) != file
    with pytest.raises(InputError, match="all corners of the mesh are in one point"):
        collision_mesh(file)


def test_an_obj_with_a_corner_nowhere_is_converted_without_it(tmp_path):
    (tmp_path / "m.obj").write_text(FACES + "v nan inf 0\nf 1 2 5\n")
    drawn = visual_mesh(tmp_path / "m.obj")
    assert drawn != tmp_path / "m.obj"
    assert b"nan" not in drawn.read_bytes()


def test_a_sound_obj_with_normals_is_drawn_as_it_is(tmp_path):
    (tmp_path / "m.obj").write_text(FACES.replace("f 1 2 4", "f 1 \\\n 2 4 # a comment") + "f -1 -2 -3\n")
    assert visual_mesh(tmp_path / "m.obj") == tmp_path / "m.obj"


SPECK = """<COLLADA version="1.4.1" xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset>
<unit name="meter" meter="0.001"/></asset><library_geometries><geometry id="g"><mesh><source id="s">
<float_array id="a" count="9">9.43199e-09 2.24391e-09 4.40436e-09 1.03801e-07 7.22176e-10 3.52006e-09 3.44226e-09
1.06538e-07 2.57883e-09</float_array><technique_common><accessor source="#a" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices><triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node id="n"><matrix>-0.9466 0.05644 0.3505 -0.7193 0.6911 0.09986 -0.1786
-0.975 -0.471 0.1522 -0.6609 0.6062 0 0 0 1</matrix><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>"""


def test_a_mesh_that_is_too_small_for_drakes_hull_is_refused(tmp_path):
    (tmp_path / "m.dae").write_text(SPECK)
    with pytest.raises(InputError, match="no convex hull"):
        collision_mesh(tmp_path / "m.dae")
