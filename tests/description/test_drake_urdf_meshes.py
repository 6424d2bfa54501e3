from math import pi
from pathlib import Path

import numpy as np
import pytest
import trimesh
from prepared_urdf import (
    BOX,
    MESH,
    prepare,
    prepared,
    refusal,
    write_wedge,
)
from pydrake.geometry import Box, Cylinder, SceneGraph, Shape, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.errors import InputError


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.mark.parametrize("shape", ["visual", "collision"])
@pytest.mark.parametrize("folder", ["rover", "my rovers", "fusée"])
def test_meshes_of_packages_become_files_that_drake_reads(tmp_path, shape, folder):
    file = write_wedge(tmp_path / folder / "meshes" / "wheel.stl")
    body = f"<link name='base'><{shape}>{MESH.format(f'package://{folder}/meshes/wheel.stl')}</{shape}></link>"
    robot, repairs = prepare(body, None, tmp_path)
    assert repairs == []
    address = robot.find(f"link/{shape}/geometry/mesh").get("filename")
    assert address.startswith(f"file://{tmp_path}/cache/")
    assert prepared(body, None, tmp_path).meshes == (file,)


def test_a_mesh_that_drake_reads_is_found_relative_to_the_robots_file(tmp_path):
    (tmp_path / "my meshes").mkdir()
    wheel = trimesh.creation.box().export(file_type="obj", include_normals=True)
    (tmp_path / "my meshes" / "wheel.obj").write_text(wheel)
    body = f"<link name='base'><visual>{MESH.format('../my meshes/wheel.obj')}</visual></link>"
    (tmp_path / "urdf").mkdir()
    robot, _ = prepare(body, tmp_path / "urdf" / "rover.urdf")
    assert robot.find("link/visual/geometry/mesh").get("filename") == f"file://{tmp_path}/my meshes/wheel.obj"


def test_a_mesh_that_is_used_twice_is_named_once(tmp_path):
    file = write_wedge(tmp_path / "wheel.stl")
    mesh = MESH.format("wheel.stl")
    body = f"<link name='base'><visual>{mesh}</visual><collision>{mesh}</collision></link>"
    assert prepared(body, tmp_path / "rover.urdf").meshes == (file,)


@pytest.mark.parametrize("content", [None, "broken"])
@pytest.mark.parametrize("shape", ["visual", "collision"])
def test_a_shape_whose_mesh_is_missing_or_broken_is_left_out(tmp_path, shape, content):
    if content is not None:
        (tmp_path / "wheel.stl").write_text(content)
    shapes = f"\n<{shape}>{MESH.format('wheel.stl')}</{shape}><{shape}>{BOX}</{shape}>"
    robot, (repair,) = prepare(f"<link name='base'>{shapes}</link>", tmp_path / "rover.urdf")
    assert len(robot.findall(f"link/{shape}")) == 1
    assert repair.startswith(f"rover.urdf:2: the {shape} mesh of link 'base' is left out: {tmp_path}/wheel.stl: ")
    assert repair.endswith("[missing_mesh]")


def test_a_mesh_that_is_missing_is_refused_with_its_line_without_that_repair(tmp_path):
    body = f"<link name='base'>\n<visual>{MESH.format('wheel.stl')}</visual></link>"
    text = refusal(body, tmp_path / "rover.urdf", without=["missing_mesh"])
    assert text.startswith(f"{tmp_path}/rover.urdf:2: <mesh> of ")
    assert text.endswith(f"{tmp_path}/wheel.stl: the file does not exist.")


@pytest.mark.parametrize(
    "address",
    [
        "/home/someone/ws/src/rover/meshes/wheel.stl",
        "file:///home/someone/ws/src/rover/meshes/wheel.stl",
        "package://someones_rover/rover/meshes/wheel.stl",
    ],
)
def test_a_mesh_of_someone_elses_machine_is_found_in_the_package_its_folders_are_named_after(tmp_path, address):
    file = write_wedge(tmp_path / "rover" / "meshes" / "wheel.stl")
    body = f"<link name='base'>\n<visual>{MESH.format(address)}</visual></link>"
    robot, repairs = prepare(body, None, tmp_path)
    assert robot.find("link/visual/geometry/mesh") is not None
    assert repairs == [f"line 2: mesh {address!r} is not on this machine: {file} is used [mesh_elsewhere]"]


def test_a_mesh_of_someone_elses_machine_is_missing_without_that_repair(tmp_path):
    write_wedge(tmp_path / "rover" / "meshes" / "wheel.stl")
    body = f"<link name='base'><visual>{MESH.format('/home/someone/rover/meshes/wheel.stl')}</visual></link>"
    robot, (repair,) = prepare(body, None, tmp_path, without=["mesh_elsewhere"])
    assert robot.find("link/visual") is None
    assert repair.endswith("/home/someone/rover/meshes/wheel.stl: the file does not exist [missing_mesh]")


PRIMITIVES = {
    "box": trimesh.creation.box((1.0, 2.0, 3.0)),
    "cylinder along x": trimesh.creation.cylinder(0.5, 2.0, sections=64).apply_transform(
        trimesh.transformations.rotation_matrix(pi / 2, (0, 1, 0))
    ),
    "cylinder along y": trimesh.creation.cylinder(0.5, 2.0, sections=64).apply_transform(
        trimesh.transformations.rotation_matrix(pi / 2, (1, 0, 0))
    ),
    "cylinder along z": trimesh.creation.cylinder(0.5, 2.0, sections=64),
    "sphere": trimesh.creation.icosphere(subdivisions=4, radius=0.5),
}


def reach(shape: Shape, direction: np.ndarray) -> float:
    """How far a shape reaches from its centre in a direction of its own frame."""
    match shape:
        case Box():
            return float(np.abs(direction) @ shape.size() / 2)
        case Cylinder():
            return shape.radius() * np.hypot(*direction[:2]) + shape.length() / 2 * abs(direction[2])
        case Sphere():
            return shape.radius()
    raise AssertionError(f"{shape} is no primitive")


@pytest.mark.parametrize("kind", PRIMITIVES)
@pytest.mark.parametrize("origin", ["", "<origin xyz='1 2 3' rpy='0.4 -0.5 2.5'/>"])
@pytest.mark.parametrize("scale", [1.0, 0.001, -2.0])
def test_a_collision_mesh_that_is_a_primitive_becomes_one_at_the_same_place(tmp_path, kind, origin, scale):
    mesh = PRIMITIVES[kind].copy().apply_translation((0.3, -0.2, 0.1))
    (tmp_path / "part.stl").write_bytes(mesh.export(file_type="stl"))
    geometry = f"<geometry><mesh filename='part.stl' scale='{scale} {scale} {scale}'/></geometry>"
    body = f"<link name='base'><collision>{origin}{geometry}</collision></link>"
    pose = RigidTransform(RollPitchYaw(0.4, -0.5, 2.5), [1, 2, 3]) if origin else RigidTransform()
    corners = (pose @ (mesh.vertices * scale).T).T
    shape, place = the_collision_shape(prepared(body, tmp_path / "rover.urdf").text)
    for direction in np.random.default_rng(0).normal(size=(20, 3)):
        direction /= np.linalg.norm(direction)
        found = direction @ place.translation() + reach(shape, place.rotation().inverse() @ direction)
        assert found == pytest.approx(np.max(corners @ direction), abs=5e-3 * abs(scale))


def the_collision_shape(text: str) -> tuple[Shape, RigidTransform]:
    """The only collision shape of the link ``base``, and where it is in the link."""
    plant, scene_graph = MultibodyPlant(time_step=0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    Parser(plant).AddModelsFromString(text, "urdf")
    plant.Finalize()
    (geometry,) = plant.GetCollisionGeometriesForBody(plant.GetBodyByName("base"))
    inspector = scene_graph.model_inspector()
    return inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry)


def test_a_visual_mesh_that_is_a_primitive_stays_a_mesh(tmp_path):
    (tmp_path / "part.stl").write_bytes(trimesh.creation.box().export(file_type="stl"))
    robot, _ = prepare(f"<link name='base'><visual>{MESH.format('part.stl')}</visual></link>", tmp_path / "rover.urdf")
    assert robot.find("link/visual/geometry/mesh") is not None


def write_channel(file: Path) -> Path:
    """A U-shaped channel: its hull is a box, it is not."""
    corners = [[0, 0], [2, 0], [2, 1], [1.8, 1], [1.8, 0.2], [0.2, 0.2], [0.2, 1], [0, 1]]
    across = [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [0, 5, 6], [0, 6, 7]]
    channel = trimesh.creation.extrude_triangulation(np.array(corners, dtype=float), np.array(across), height=1.0)
    file.write_bytes(channel.export(file_type="stl"))
    return file


def test_an_open_channel_is_a_box_for_contact_unless_it_is_decomposed(tmp_path):
    write_channel(tmp_path / "channel.stl")
    body = f"<link name='base'><collision name='c'>{MESH.format('channel.stl')}</collision></link>"
    robot, _ = prepare(body, tmp_path / "channel.urdf")
    assert len(robot.findall("link/collision/geometry/box")) == 1
    pytest.importorskip("coacd", reason="the extra 'decomposition' is not installed")
    robot, _ = prepare(body, tmp_path / "channel.urdf", collision="decomposition")
    assert robot.find("link/collision/geometry/box") is None
    assert len(robot.findall("link/collision/geometry/mesh")) >= 2


def test_a_box_stays_one_when_it_is_decomposed(tmp_path):
    pytest.importorskip("coacd", reason="the extra 'decomposition' is not installed")
    (tmp_path / "part.stl").write_bytes(trimesh.creation.box().export(file_type="stl"))
    body = f"<link name='base'><collision>{MESH.format('part.stl')}</collision></link>"
    robot, _ = prepare(body, tmp_path / "rover.urdf", collision="decomposition")
    assert robot.find("link/collision/geometry/box") is not None


def test_a_mesh_without_a_file_name_is_refused_with_its_line(tmp_path):
    with pytest.raises(InputError, match=r"rover\.urdf:2: <mesh> .*the attribute 'filename' is missing"):
        prepare("<link name='base'><visual><geometry>\n<mesh/></geometry></visual></link>", tmp_path / "rover.urdf")
