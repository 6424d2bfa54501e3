from pathlib import Path

import pytest
import trimesh
from lxml import etree
from pydrake.geometry import SceneGraph
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.description.drake_urdf import drake_link_name, prepare_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.urdf import parse_urdf
from drake_twin.errors import InputError

DRAKE = "{http://drake.mit.edu}"
JOINT = """<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>"""
BOX = "<geometry><box size='1 1 1'/></geometry>"
MESH = "<geometry><mesh filename='{}'/></geometry>"


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def prepare(body: str, file: Path | None = None, *folders: Path) -> tuple[etree._Element, list[str]]:
    """The prepared robot, which Drake's parser also accepted, and the warnings."""
    description = parse_urdf(f"<robot name='own'>{body}</robot>", file)
    text, warnings = prepare_urdf(description, "robot_1", PackageIndex(folders, {}))
    in_drake(text)
    return etree.fromstring(text), warnings


def in_drake(text: str) -> MultibodyPlant:
    plant, scene_graph = MultibodyPlant(time_step=0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    Parser(plant).AddModelsFromString(text, "urdf")
    return plant


def joint(name="elbow", parent="base", child="arm", inside="") -> str:
    return JOINT.format(name=name, parent=parent, child=child, inside=inside)


def links(*names: str) -> str:
    return "".join(f"<link name='{name}'/>" for name in names)


def write_box(file: Path) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(trimesh.creation.box().export(file_type="stl"))
    return file


def test_the_model_has_the_robots_name_in_the_twin():
    robot, warnings = prepare(links("base"))
    assert robot.get("name") == "robot_1"
    assert warnings == []


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
    robot, warnings = prepare(body)
    assert robot.find("material") is None
    assert robot.find("link/visual/material/color").get("rgba") == "1 0 0 1"
    assert warnings == []


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


def test_a_material_that_is_not_defined_is_left_out_with_a_warning():
    robot, warnings = prepare(f"<link name='base'><visual>{BOX}<material name='pink'/></visual></link>")
    assert robot.find("link/visual/material") is None
    assert warnings == ["material 'pink' is not defined; the visual keeps its own colours"]


@pytest.mark.parametrize("shape", ["visual", "collision"])
@pytest.mark.parametrize("folder", ["rover", "my rovers", "fusée"])
def test_meshes_of_packages_become_files_that_drake_reads(tmp_path, shape, folder):
    write_box(tmp_path / folder / "meshes" / "wheel.stl")
    body = f"<link name='base'><{shape}>{MESH.format(f'package://{folder}/meshes/wheel.stl')}</{shape}></link>"
    robot, warnings = prepare(body, None, tmp_path)
    assert warnings == []
    address = robot.find(f"link/{shape}/geometry/mesh").get("filename")
    assert address.startswith(f"file://{tmp_path}/cache/")


def test_a_mesh_that_drake_reads_is_found_relative_to_the_robots_file(tmp_path):
    (tmp_path / "my meshes").mkdir()
    (tmp_path / "my meshes" / "wheel.obj").write_text(trimesh.creation.box().export(file_type="obj"))
    body = f"<link name='base'><visual>{MESH.format('../my meshes/wheel.obj')}</visual></link>"
    (tmp_path / "urdf").mkdir()
    robot, _ = prepare(body, tmp_path / "urdf" / "rover.urdf")
    assert robot.find("link/visual/geometry/mesh").get("filename") == f"file://{tmp_path}/my meshes/wheel.obj"


@pytest.mark.parametrize("content", [None, "broken"])
def test_a_shape_whose_mesh_is_missing_or_broken_is_left_out_with_a_warning(tmp_path, content):
    if content is not None:
        (tmp_path / "wheel.stl").write_text(content)
    shapes = f"<visual>{MESH.format('wheel.stl')}</visual><visual>{BOX}</visual>"
    robot, (warning,) = prepare(f"<link name='base'>{shapes}</link>", tmp_path / "rover.urdf")
    assert len(robot.findall("link/visual")) == 1
    assert warning.startswith(f"link 'base' goes without its visual mesh: {tmp_path}/wheel.stl: ")


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


def test_joint_friction_is_dropped_with_a_warning_and_damping_stays():
    robot, warnings = prepare(links("base", "arm") + joint(inside="<dynamics damping='0.5' friction='0.1'/>"))
    assert dict(robot.find("joint/dynamics").attrib) == {"damping": "0.5"}
    assert warnings == ["joint friction is not simulated (joints elbow)"]


def test_zero_joint_friction_needs_no_warning():
    _, warnings = prepare(links("base", "arm") + joint(inside="<dynamics friction='0.0'/>"))
    assert warnings == []


def test_the_description_keeps_the_text_of_the_file():
    description = parse_urdf(f"<robot name='own'>{links('world')}</robot>")
    prepare_urdf(description, "robot_1", PackageIndex((), {}))
    assert description.text == "<robot name='own'><link name='world'/></robot>"
