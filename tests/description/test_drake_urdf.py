from math import pi
from pathlib import Path

import numpy as np
import pytest
import trimesh
from lxml import etree
from pydrake.geometry import Box, Cylinder, SceneGraph, Shape, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.description.drake_urdf import PreparedUrdf, drake_link_name, prepare_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Kind

DRAKE = "{http://drake.mit.edu}"
JOINT = """<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>"""
BOX = "<geometry><box size='1 1 1'/></geometry>"
MESH = "<geometry><mesh filename='{}'/></geometry>"


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def prepared(body: str, file: Path | None = None, *folders: Path, **options) -> PreparedUrdf:
    text = f"<robot name='own'>{body}</robot>"
    reader = XmlReader(text, file)
    return prepare_urdf(reader, describe_urdf(reader, text), "robot_1", PackageIndex(folders, {}), **options)


def prepare(body: str, file: Path | None = None, *folders: Path, **options) -> tuple[etree._Element, list[str]]:
    """The prepared robot, which Drake's parser also accepted, and what was mended."""
    made = prepared(body, file, *folders, **options)
    in_drake(made.text)
    return etree.fromstring(made.text), [str(item) for item in made.findings if item.kind is Kind.MENDED]


def ignored(body: str, **options) -> list[str]:
    return [str(item) for item in prepared(body, **options).findings if item.kind is Kind.IGNORED]


def refusal(body: str, file: Path | None = None, **options) -> str:
    with pytest.raises(InputError) as raised:
        prepared(body, file, **options)
    return str(raised.value)


def in_drake(text: str) -> MultibodyPlant:
    plant, scene_graph = MultibodyPlant(time_step=0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    Parser(plant).AddModelsFromString(text, "urdf")
    return plant


def joint(name="elbow", parent="base", child="arm", inside="") -> str:
    return JOINT.format(name=name, parent=parent, child=child, inside=inside)


def links(*names: str) -> str:
    return "".join(f"<link name='{name}'/>" for name in names)


def write_wedge(file: Path) -> Path:
    """A mesh that is no primitive."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(trimesh.creation.cone(radius=1.0, height=1.0).export(file_type="stl"))
    return file


def test_the_model_has_the_robots_name_in_the_twin():
    robot, repairs = prepare(links("base"))
    assert robot.get("name") == "robot_1"
    assert repairs == []


@pytest.mark.parametrize("tag", ["ros2_control", "gazebo", "transmission"])
def test_tags_that_drake_must_not_act_on_are_dropped(tag):
    robot, _ = prepare(f"{links('base', 'arm')}{joint()}<{tag} name='t'/><{tag} name='u'/>")
    assert robot.find(tag) is None


def test_a_transmission_makes_no_actuator():
    transmission = (
        "<transmission name='t'><type>transmission_interface/SimpleTransmission</type><joint name='elbow'/>"
        "<actuator name='motor'/></transmission>"
    )
    robot, _ = prepare(links("base", "arm") + joint() + transmission)
    assert in_drake(etree.tostring(robot, encoding="unicode")).num_actuators() == 0


def test_a_link_called_world_gets_another_name_wherever_it_is_named():
    robot, _ = prepare(links("world", "base") + joint(parent="world", child="base"))
    assert [link.get("name") for link in robot.iterfind("link")] == ["robot_world", "base"]
    assert robot.find("joint/parent").get("link") == "robot_world"
    assert (drake_link_name("world"), drake_link_name("base")) == ("robot_world", "base")


def test_materials_defined_at_the_top_are_inlined():
    body = (
        f"<material name='red'><color rgba='1 0 0 1'/></material>"
        f"<link name='base'><visual>{BOX}<material name='red'/></visual></link>"
    )
    robot, repairs = prepare(body)
    assert robot.find("material") is None
    assert robot.find("link/visual/material/color").get("rgba") == "1 0 0 1"
    assert repairs == []


def test_a_material_defined_twice_keeps_each_visuals_own_colour():
    visuals = "".join(
        f"<visual name='v{index}'>{BOX}<material name='paint'>{color}</material></visual>"
        for index, color in enumerate(["<color rgba='1 0 0 1'/>", "<color rgba='0 1 0 1'/>", ""])
    )
    robot, _ = prepare(f"<link name='base'>{visuals}</link>")
    colors = [color.get("rgba") for color in robot.iterfind("link/visual/material/color")]
    assert colors == ["1 0 0 1", "0 1 0 1", "1 0 0 1"]
    names = [material.get("name") for material in robot.iter("material")]
    assert len(set(names)) == 3


def test_a_material_that_is_not_defined_is_left_out_once_for_all_its_visuals():
    visual = f"<visual>{BOX}<material name='pink'/></visual>"
    robot, repairs = prepare(f"<link name='base'>\n{visual}{visual}</link>")
    assert robot.find("link/visual/material") is None
    what = "material 'pink' is not defined: its visuals keep the colours of their meshes, or grey"
    assert repairs == [f"line 2: {what} [undefined_material]"]


def test_a_material_that_is_not_defined_is_refused_without_that_repair():
    body = f"<link name='base'><visual>{BOX}\n<material name='pink'/></visual></link>"
    text = refusal(body, Path("rover.urdf"), without=["undefined_material"])
    assert text == "rover.urdf:2: <material name=\"pink\">: the material 'pink' is not defined."


def test_the_first_of_several_materials_of_a_visual_counts():
    paints = "".join(f"<material name='{name}'/>" for name in ("red", "green"))
    colors = "<material name='red'><color rgba='1 0 0 1'/></material>"
    robot, repairs = prepare(f"{colors}<link name='base'><visual>{BOX}{paints}</visual></link>")
    assert [color.get("rgba") for color in robot.iter("color")] == ["1 0 0 1"]
    assert repairs == []


def test_a_blank_name_of_a_shape_is_left_out():
    robot, _ = prepare(f"<link name='base'><visual name=' '>{BOX}</visual><collision name='c'>{BOX}</collision></link>")
    assert robot.find("link/visual").get("name") is None
    assert robot.find("link/collision").get("name") == "c"


def test_a_material_of_a_texture_alone_needs_no_repair():
    _, repairs = prepare(
        f"<link name='base'><visual>{BOX}<material name='wood'><texture filename='a.png'/></material></visual></link>"
    )
    assert repairs == []


def test_gazebos_colour_is_used_where_a_visual_has_none_of_its_own():
    red = "<material name='red'><color rgba='1 0 0 1'/></material>"
    gazebo = "<gazebo reference='base'><material>Gazebo/Green</material></gazebo>"
    robot, repairs = prepare(f"<link name='base'><visual>{BOX}</visual><visual>{BOX}{red}</visual></link>{gazebo}")
    assert [color.get("rgba") for color in robot.iterfind("link/visual/material/color")] == ["0 1 0 1", "1 0 0 1"]
    assert repairs == []


def test_a_gazebo_colour_that_is_not_known_changes_nothing():
    gazebo = "<gazebo reference='base'><material>Gazebo/Plaid</material></gazebo>"
    robot, _ = prepare(f"<link name='base'><visual>{BOX}</visual></link>{gazebo}")
    assert robot.find("link/visual/material") is None


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


@pytest.mark.parametrize(
    ("tags", "expected"), [("<mu1>0.9</mu1><mu2>0.5</mu2>", 0.5), ("<mu2>0.7</mu2>", 0.7), ("<mu1>-1</mu1>", 0.0)]
)
@pytest.mark.parametrize("link", ["base", "world"])
def test_the_smaller_friction_coefficient_of_a_link_reaches_its_collision_shapes(link, tags, expected):
    body = f"<link name='{link}'><collision>{BOX}</collision></link><gazebo reference='{link}'>{tags}</gazebo>"
    robot, _ = prepare(body)
    properties = robot.find(f"link/collision/{DRAKE}proximity_properties")
    for name in ("mu_dynamic", "mu_static"):
        assert float(properties.find(DRAKE + name).get("value")) == expected


def test_a_link_without_friction_keeps_drakes_own():
    robot, _ = prepare(f"<link name='base'><collision>{BOX}</collision></link>")
    assert robot.find(f"link/collision/{DRAKE}proximity_properties") is None


def test_a_follower_of_ros2_control_is_coupled_in_drake():
    ros2_control = (
        "<ros2_control name='s' type='system'><joint name='wrist'><param name='mimic'>elbow</param>"
        "<param name='multiplier'>-0.5</param></joint></ros2_control>"
    )
    robot, _ = prepare(links("base", "arm", "hand") + joint() + joint("wrist", "arm", "hand") + ros2_control)
    assert dict(robot.find("joint[@name='wrist']/mimic").attrib) == {
        "joint": "elbow",
        "multiplier": "-0.5",
        "offset": "0",
    }
    assert in_drake(etree.tostring(robot, encoding="unicode")).num_constraints() == 1


def test_a_follower_of_the_urdf_keeps_its_own_mimic():
    inside = "<mimic joint='elbow' multiplier='2'/>"
    robot, _ = prepare(links("base", "arm", "hand") + joint() + joint("wrist", "arm", "hand", inside))
    (mimic,) = robot.findall("joint/mimic")
    assert dict(mimic.attrib) == {"joint": "elbow", "multiplier": "2"}


def test_joint_friction_is_left_to_the_plant_and_damping_stays():
    robot, repairs = prepare(links("base", "arm") + joint(inside="<dynamics damping='0.5' friction='0.1'/>"))
    assert dict(robot.find("joint/dynamics").attrib) == {"damping": "0.5"}
    assert repairs == []


def test_joint_friction_counts_as_ignored_only_when_it_is_left_out():
    body = links("base", "arm") + joint(inside="<dynamics friction='0.1'/>")
    assert ignored(body) == []
    assert ignored(body, without=["joint_friction"]) == ["friction of joint elbow"]
    assert ignored(body.replace("0.1", "0.0"), without=["joint_friction"]) == []


def test_what_is_ignored_does_not_reach_drake():
    robot, _ = prepare(f"<link name='base'><note/></link><link name='arm'/>{joint(inside='<note/>')}<note/>")
    assert next(robot.iter("note"), None) is None


def test_the_document_that_was_read_is_not_changed():
    text = f"<robot name='own'>{links('world', 'arm')}{joint(parent='world')}<transmission name='t'/></robot>"
    reader = XmlReader(text)
    before = etree.tostring(reader.root)
    description = describe_urdf(reader, text)
    prepare_urdf(reader, description, "robot_1", PackageIndex((), {}))
    assert etree.tostring(reader.root) == before
    assert description.text == text
