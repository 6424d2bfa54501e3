from math import inf
from pathlib import Path

import numpy as np
import pytest
import trimesh
from lxml import etree
from pydrake.math import RollPitchYaw

from drake_twin import TwinBuilder
from drake_twin.description.drake_model import describe_model
from drake_twin.description.model_frames import model_frames
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.sdf import PreparedSdf, prepare_sdf, read_robot_sdf
from drake_twin.errors import InputError

ARM = '<link name="base"/><link name="arm"/>'
JOINT = '<joint name="elbow" type="{kind}"><parent>base</parent><child>arm</child>{inside}</joint>'
TO_WORLD = '<joint name="weld" type="{kind}"><parent>world</parent><child>base</child>{inside}</joint>'
AXIS = "<axis><xyz>0 0 1</xyz>{}</axis>"


def sdf(body: str) -> str:
    return f'<sdf version="1.9">\n<model name="own">{body}</model>\n</sdf>'


def prepared_of(text: str, file: Path, name: str | None, packages: PackageIndex) -> PreparedSdf:
    return prepare_sdf(read_robot_sdf(text, file)[0], name, packages)


def prepare(body: str, file: Path = Path("arm.sdf"), *folders: Path) -> tuple[str, bool]:
    text, is_fixed, *_ = prepared_of(sdf(body), file, "robot_1", PackageIndex(folders, {}))
    return text, is_fixed


def describe(body: str) -> RobotDescription:
    return describe_model(prepare(body)[0], "sdf", sdf(body), Path("arm.sdf"), "own")


def refusal(call, *arguments) -> str:
    with pytest.raises(InputError) as raised:
        call(*arguments)
    return str(raised.value)


@pytest.mark.parametrize(("name", "expected"), [("robot_1", "robot_1"), (None, "own")])
def test_the_model_takes_the_name_in_the_twin_and_its_own_one_by_default(name, expected):
    text, _, own_name, _ = prepared_of(sdf(ARM), Path("arm.sdf"), name, PackageIndex((), {}))
    assert etree.fromstring(text).find("model").get("name") == expected
    assert own_name == "own"


def test_a_model_that_stands_free_is_not_fixed():
    assert prepare(ARM)[1] is False


def test_a_fixed_joint_to_the_world_becomes_a_fixed_robot():
    text, is_fixed = prepare(ARM + TO_WORLD.format(kind="fixed", inside=""))
    assert is_fixed
    assert "weld" not in text


@pytest.mark.parametrize(("value", "expected"), [("true", True), ("1", True), ("True", True), ("false", False)])
def test_a_static_model_is_a_fixed_robot_with_moving_joints(value, expected):
    text, is_fixed = prepare(f"<static>{value}</static>{ARM}")
    assert is_fixed is expected
    assert "<static>" not in text


def test_a_joint_that_moves_against_the_world_hangs_on_a_link_as_a_urdfs_world(tmp_path):
    body = '<link name="base"><inertial><mass>2</mass></inertial></link>'
    body += TO_WORLD.format(kind="prismatic", inside=AXIS.format(""))
    assert prepare(body)[1] is True
    (tmp_path / "rail.sdf").write_text(sdf(body))
    twin = TwinBuilder(time_step=0.001).robot("rail", tmp_path / "rail.sdf", xyz=(1, 2, 3)).build()
    twin.advance_to(0.5)
    assert twin.entities.state("rail::base").position == pytest.approx((1.0, 2.0, 3.0 - 9.81 * 0.5**2 / 2), abs=0.003)
    twin.advance_to(0.6)
    assert twin.entities.state("rail::world").position == (1.0, 2.0, 3.0)


def test_a_world_file_is_refused():
    text = refusal(prepared_of, '<sdf version="1.9"><world name="w"/></sdf>', Path("w.sdf"), "r", PackageIndex((), {}))
    assert text == "w.sdf:1: <sdf>: a robot is an SDF file with one <model>, but this holds a world."


@pytest.mark.parametrize("count", [0, 2])
def test_any_other_number_of_models_is_refused(count):
    models = '<model name="m"/>' * count
    text = refusal(prepared_of, f"<sdf>{models}</sdf>", Path("m.sdf"), "r", PackageIndex((), {}))
    assert f"but this holds {count} models" in text


def test_plugins_are_left_out():
    assert "plugin" not in prepare('<link name="base"/><plugin name="p" filename="f"/>')[0]


@pytest.mark.parametrize("folder", ["arm", "my arm"])
def test_meshes_become_files_that_drake_reads(tmp_path, monkeypatch, folder):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache of mine"))
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "part.stl").write_bytes(trimesh.creation.box().export(file_type="stl"))
    mesh = f"<geometry><mesh><uri>model://{folder}/part.stl</uri></mesh></geometry>"
    shapes = f'<visual name="v">{mesh}</visual><collision name="c">{mesh}</collision>'
    text, _ = prepare(f'<link name="base">{shapes}</link>', Path("arm.sdf"), tmp_path)
    addresses = [uri.text for uri in etree.fromstring(text).iter("uri")]
    assert len(addresses) == 1  # the collision mesh is a box, and becomes one
    assert all(address.startswith(f"file://{tmp_path}/cache of mine/") for address in addresses)
    assert describe_model(text, "sdf", "", Path("arm.sdf"), "own").links == ("base",)


def test_a_link_goes_without_a_mesh_that_is_missing(tmp_path):
    mesh = '<visual name="v"><geometry><mesh><uri>gone.stl</uri></mesh></geometry></visual>'
    model = f'<sdf version="1.9"><model name="own"><link name="base">{mesh}</link></model></sdf>'
    prepared = prepared_of(model, tmp_path / "arm.sdf", None, PackageIndex((), {}))
    assert "visual" not in prepared.text
    (warning,) = map(str, prepared.findings)
    assert f"{tmp_path}/gone.stl" in warning


def test_a_mesh_of_the_models_neighbour_is_found_and_a_missing_model_is_said(tmp_path):
    """As those of turtlebot3_gazebo/models, where no package is called turtlebot3_common."""
    (tmp_path / "models/robot").mkdir(parents=True)
    (tmp_path / "models/common").mkdir()
    (tmp_path / "models/common/part.stl").write_bytes(trimesh.creation.box().export(file_type="stl"))
    visual = '<visual name="{0}"><geometry><mesh><uri>model://{0}/part.stl</uri></mesh></geometry></visual>'
    link = f'<link name="base">{visual.format("common")}{visual.format("gone")}</link>'
    model = f'<sdf version="1.9"><model name="own">{link}</model></sdf>'
    prepared = prepared_of(model, tmp_path / "models/robot/model.sdf", None, PackageIndex((), {}))
    assert prepared.text.count("<visual") == 1
    (warning,) = map(str, prepared.findings)
    assert "the meshes of gone are left out" in warning


def test_links_joints_and_text_are_those_of_the_file():
    body = ARM + JOINT.format(kind="prismatic", inside=AXIS.format("<limit><lower>-1</lower><upper>2</upper></limit>"))
    description = describe(body)
    assert (description.name, description.links, description.text) == ("own", ("base", "arm"), sdf(body))
    (joint,) = description.joints
    assert (joint.name, joint.type, joint.parent, joint.child) == ("elbow", "prismatic", "base", "arm")
    assert tuple(joint.axis) == (0.0, 0.0, 1.0)
    assert (joint.limits.lower, joint.limits.upper) == (-1.0, 2.0)


@pytest.mark.parametrize(
    ("kind", "inside", "expected"),
    [
        ("fixed", "", "fixed"),
        ("revolute", AXIS.format("<limit><lower>0</lower><upper>1</upper></limit>"), "revolute"),
        ("revolute", AXIS.format(""), "continuous"),
        ("continuous", AXIS.format(""), "continuous"),
        ("ball", "", "ball"),
        ("universal", AXIS.format("") + "<axis2><xyz>1 0 0</xyz></axis2>", "universal"),
        ("screw", AXIS.format(""), "screw"),
    ],
)
def test_joint_types_are_those_of_urdf(kind, inside, expected):
    assert describe(ARM + JOINT.format(kind=kind, inside=inside)).joints[0].type == expected


def test_velocity_limits_and_damping_are_read():
    inside = AXIS.format("<limit><velocity>3</velocity></limit><dynamics><damping>0.3</damping></dynamics>")
    (joint,) = describe(ARM + JOINT.format(kind="continuous", inside=inside)).joints
    assert (joint.limits.velocity, joint.damping, joint.limits.effort) == (3.0, 0.3, inf)


def test_a_joint_frame_apart_from_its_child_is_read_from_both_sides():
    links = '<link name="base"/><link name="arm"><pose>1 0 0 0 0 0</pose></link>'
    body = links + JOINT.format(kind="continuous", inside="<pose>0 0 0.5 0 0 0</pose>" + AXIS.format(""))
    (joint,) = describe(body).joints
    assert joint.origin.xyz == pytest.approx((1.0, 0.0, 0.5))
    assert joint.child_origin.xyz == pytest.approx((0.0, 0.0, -0.5))


def test_the_first_of_several_trees_is_the_robots_base():
    description = describe(ARM.replace('<link name="arm"/>', '<link name="arm"><pose>1 2 3 0 0 0</pose></link>'))
    assert (description.root_link, {name: pose.xyz for name, pose in description.loose_links.items()}) == (
        "base",
        {"arm": (1, 2, 3)},
    )


def test_the_loose_links_of_a_static_model_stay_where_they_are():
    """A maze: one model with a link a wall, none joined to another."""
    wall = '<link name="{0}"><pose>{1} 0 0.5 0 0 0</pose></link>'
    walls = "".join(wall.format(name, x) for name, x in (("a", 1), ("b", 3), ("c", 5)))
    description = describe(f"<static>1</static>{walls}")
    assert [joint.type for joint in description.joints] == ["fixed", "fixed"]
    assert [joint.origin.xyz for joint in description.joints] == [(2.0, 0.0, 0.0), (4.0, 0.0, 0.0)]


@pytest.mark.parametrize("normal", ["0 0 1", "1 0 0"])
def test_a_plane_of_a_static_model_is_the_upper_side_of_a_slab(normal):
    plane = f"<geometry><plane><normal>{normal}</normal><size>4 400</size></plane></geometry>"
    shape = f'<collision name="c"><pose>0 0 0.2 0 0 0</pose>{plane}</collision>'
    text, *_ = prepare(f'<static>1</static><link name="floor">{shape}</link>')
    collision = etree.fromstring(text).find(".//collision")
    assert collision.findtext("geometry/box/size") == "100 400 1"
    x, y, z, roll, pitch, yaw = map(float, collision.findtext("pose").split())
    up = RollPitchYaw(roll, pitch, yaw).ToRotationMatrix().matrix()[:, 2]
    assert up == pytest.approx(np.array(normal.split(), dtype=float))
    assert np.array([x, y, z]) + up / 2 == pytest.approx((0, 0, 0.2))


def test_friction_is_that_of_gazebos_default_engine():
    """DART reads ``<ode>``; ``<bullet>`` is another engine's."""
    bullet = "<surface><friction><bullet><friction>0.2</friction></bullet></friction></surface>"
    box = "<geometry><box><size>1 1 1</size></box></geometry>"
    text, *_ = prepare(f'<link name="a"><collision name="c">{box}{bullet}</collision></link>')
    assert {float(element.text) for element in etree.fromstring(text).iter("{http://drake.mit.edu}mu_dynamic")} == {1.0}


HELD = """<link name="base"/><link name="arm"><pose>0 0 1 0 0 0</pose></link>
<joint name="j" type="fixed"><parent>base</parent><child>arm</child><pose>0 1 0 0 0 0</pose></joint>
<frame name="f" attached_to="j">{}</frame><link name="tool"><pose relative_to="f">0 0 0 0 0 0</pose></link>
<joint name="k" type="fixed"><parent>f</parent><child>tool</child></joint>"""


@pytest.mark.parametrize(
    ("pose", "expected"),
    [
        ("", (0, 1, 1)),
        ("<pose>2 0 0 0 0 0</pose>", (2, 1, 1)),
        ('<pose relative_to="base">2 0 0 0 0 0</pose>', (2, 0, 0)),
    ],
)
def test_a_frame_that_a_joint_holds_is_where_the_joint_is(pose, expected):
    """Drake alone has it at the joint's child link, whatever the joint's own pose is."""
    text, *_ = prepare(HELD.format(pose))
    frames = model_frames(text)["robot_1"]
    assert frames["f"].translation() == pytest.approx(expected)
    assert frames["tool"].translation() == pytest.approx(expected)


def test_a_mesh_of_someone_elses_machine_is_found_in_the_package_its_folders_are_named_after(tmp_path):
    file = tmp_path / "rover" / "meshes" / "part.stl"
    file.parent.mkdir(parents=True)
    file.write_bytes(trimesh.creation.box().export(file_type="stl"))
    address = "/home/someone/ws/src/rover/meshes/part.stl"
    body = f'<link name="base"><visual name="v"><geometry><mesh><uri>{address}</uri></mesh></geometry></visual></link>'
    text, *_, findings = prepared_of(sdf(body), tmp_path / "own.sdf", None, PackageIndex([tmp_path], {}))
    assert etree.fromstring(text).find(".//visual") is not None
    assert [finding.what for finding in findings] == [f"mesh {address!r} is not on this machine: {file} is used"]


def test_what_drake_refuses_gives_drakes_reason():
    assert refusal(describe, "").startswith("arm.sdf: Drake cannot read this robot: ")


POSED = """<pose>9 9 9 0 0 0</pose>
<link name="base"><pose>.3 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
<link name="tip"><pose>.3 0 1.5 0 0 0</pose><inertial><mass>1</mass></inertial></link>
<joint name="j" type="revolute"><parent>base</parent><child>tip</child><axis><xyz>0 1 0</xyz>
<limit><lower>-1</lower><upper>1</upper><effort>7</effort><velocity>2</velocity></limit></axis></joint>{more}"""


@pytest.mark.parametrize("more", ["", "<static>true</static>"])
@pytest.mark.parametrize(("yaw", "expected"), [(0.0, (0.3, 0, 3)), (np.pi / 2, (0, 0.3, 3))])  # Gazebo's, at yaw 0
def test_a_spawn_pose_is_that_of_the_models_frame(tmp_path, more, yaw, expected):
    (tmp_path / "m.sdf").write_text(sdf(POSED.format(more=more)))
    twin = TwinBuilder().robot("m", tmp_path / "m.sdf", xyz=(0, 0, 2), rpy=(0, 0, yaw)).build()
    x, y, z, *quaternion = twin.robot_state("m").base_pose
    assert (x, y, z) == pytest.approx(expected)
    assert quaternion == pytest.approx([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)])


def test_limits_of_a_joint_are_the_files(tmp_path):
    (tmp_path / "m.sdf").write_text(sdf(POSED.format(more="")))
    (joint,) = load_robot_model(str(tmp_path / "m.sdf"), PackageIndex((), {})).description.joints
    limits = joint.limits
    assert (limits.lower, limits.upper, limits.velocity, limits.effort) == (-1.0, 1.0, 2.0, 7.0)
