import multiprocessing
from pathlib import Path

import pytest
import trimesh

from drake_twin.description import meshes
from drake_twin.description.meshes import mesh_address, mesh_cache_folder, mesh_for_drake
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
  <library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "drake_twin" / "meshes"


@pytest.fixture
def conversions(monkeypatch) -> list[Path]:
    """The meshes converted so far."""
    converted, convert = [], meshes._as_obj
    monkeypatch.setattr(meshes, "_as_obj", lambda file: converted.append(file) or convert(file))
    return converted


def write_box(file: Path, extents=(1.0, 2.0, 3.0)) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(trimesh.creation.box(extents).export(file_type="stl"))
    return file


def refusal(file: Path) -> str:
    with pytest.raises(InputError) as raised:
        mesh_for_drake(file)
    return str(raised.value)


def test_an_stl_becomes_an_obj_of_the_same_size_in_the_cache(tmp_path, cache):
    converted = mesh_for_drake(write_box(tmp_path / "box.stl"))
    assert converted.parent == cache
    assert converted.suffix == ".obj"
    assert trimesh.load_mesh(converted).extents == pytest.approx([1.0, 2.0, 3.0])


def test_the_obj_has_normals_which_drakes_renderer_needs(tmp_path):
    assert "\nvn " in mesh_for_drake(write_box(tmp_path / "box.stl")).read_text()


def test_a_mesh_is_converted_once(tmp_path, conversions):
    file = write_box(tmp_path / "box.stl")
    assert mesh_for_drake(file) == mesh_for_drake(file)
    assert conversions == [file]


def test_the_same_content_elsewhere_is_not_converted_again(tmp_path, conversions):
    first, second = write_box(tmp_path / "box.stl"), write_box(tmp_path / "moved" / "chassis.STL")
    assert mesh_for_drake(first) == mesh_for_drake(second)
    assert conversions == [first]


def test_a_changed_mesh_is_converted_again(tmp_path):
    before = mesh_for_drake(write_box(tmp_path / "box.stl"))
    after = mesh_for_drake(write_box(tmp_path / "box.stl", (4.0, 4.0, 4.0)))
    assert trimesh.load_mesh(after).extents == pytest.approx([4.0, 4.0, 4.0])
    assert before != after


@pytest.mark.parametrize("name", ["box.obj", "box.OBJ", "box.gltf", "box.vtk"])
def test_what_drake_reads_is_left_as_it_is(tmp_path, cache, name):
    (tmp_path / name).touch()
    assert mesh_for_drake(tmp_path / name) == tmp_path / name
    assert not cache.exists()


@pytest.mark.parametrize(("unit", "size"), [("", 1000.0), ('<unit name="millimeter" meter="0.001"/>', 1.0)])
def test_colladas_unit_is_applied_as_in_rviz_and_gazebo(tmp_path, unit, size):
    (tmp_path / "part.dae").write_text(COLLADA.format(unit=unit))
    assert trimesh.load_mesh(mesh_for_drake(tmp_path / "part.dae")).extents[0] == pytest.approx(size)


def test_an_unknown_suffix_is_refused_with_those_that_are_known(tmp_path):
    assert refusal(tmp_path / "part.step") == (
        f"{tmp_path}/part.step: the mesh format '.step' is not understood."
        " Valid: .3mf, .dae, .glb, .gltf, .obj, .off, .ply, .stl, .vtk."
    )


def test_a_file_without_a_suffix_is_refused(tmp_path):
    assert "'without a suffix' is not understood" in refusal(tmp_path / "part")


@pytest.mark.parametrize("content", [b"", b"no mesh", b"solid empty\nendsolid empty\n"])
def test_an_stl_without_triangles_is_refused(tmp_path, content):
    (tmp_path / "part.stl").write_bytes(content)
    assert refusal(tmp_path / "part.stl") == f"{tmp_path}/part.stl: the mesh holds no triangles."


def test_an_stl_that_was_cut_short_is_refused(tmp_path, cache):
    file = write_box(tmp_path / "part.stl")
    file.write_bytes(file.read_bytes()[:200])
    assert refusal(file).startswith(f"{file}: the mesh ")
    assert not cache.exists()


def test_a_broken_collada_file_is_refused(tmp_path):
    (tmp_path / "part.dae").write_text("<COLLADA>")
    assert refusal(tmp_path / "part.dae").startswith(f"{tmp_path}/part.dae: the mesh ")


def test_a_missing_mesh_is_named(tmp_path):
    assert (
        refusal(tmp_path / "gone.stl") == f"{tmp_path}/gone.stl: the mesh cannot be read (No such file or directory)."
    )


def test_a_cache_that_cannot_be_written_is_named(tmp_path, cache):
    (tmp_path / "cache").write_text("a file where the folder should be")
    assert refusal(write_box(tmp_path / "box.stl")).startswith(f"{cache}: the mesh cache cannot be written")


def test_without_xdg_cache_home_the_cache_is_in_the_home_folder(tmp_path, monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert mesh_cache_folder() == tmp_path / ".cache" / "drake_twin" / "meshes"


def test_a_relative_cache_folder_still_gives_absolute_meshes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert mesh_for_drake(write_box(tmp_path / "box.stl")).is_absolute()


def test_an_address_keeps_spaces_and_accents_as_drake_takes_them(tmp_path):
    assert mesh_address(Path("/my robots/é.obj")) == "file:///my robots/é.obj"


def _convert(file: Path, barrier, results) -> None:
    barrier.wait()
    results.put(trimesh.load_mesh(mesh_for_drake(file)).extents.tolist())


def test_two_processes_that_fill_the_cache_at_once_leave_one_readable_file(tmp_path, cache):
    file = tmp_path / "ball.stl"
    file.write_bytes(trimesh.creation.icosphere(subdivisions=4).export(file_type="stl"))
    spawn = multiprocessing.get_context("spawn")
    barrier, results = spawn.Barrier(2), spawn.Queue()
    processes = [spawn.Process(target=_convert, args=(file, barrier, results)) for _ in range(2)]
    for process in processes:
        process.start()
    sizes = [results.get(timeout=60) for _ in processes]
    for process in processes:
        process.join()
    assert sizes == [pytest.approx([2.0, 2.0, 2.0], abs=0.01)] * 2
    (left,) = cache.iterdir()
    assert left == mesh_for_drake(file)
    assert len(trimesh.load_mesh(left).faces) == 20 * 4**4
