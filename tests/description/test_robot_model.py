from pathlib import Path

import pytest
import trimesh
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import RobotModel, is_xacro_text, load_robot_model
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind

URDF = '<robot name="own">\n<link name="base"/></robot>'
XACRO = (
    '<robot name="own" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    '<xacro:arg name="side" default="left"/><link name="$(arg side)_base"/></robot>'
)
SDF = '<sdf version="1.9"><model name="own"><link name="base"/></model></sdf>'


@pytest.fixture(autouse=True)
def _cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def load(tmp_path):
    def load(
        text: str | bytes, name: str | None = None, suffix: str = "urdf", without_repairs=(), **xacro_args: str
    ) -> RobotModel:
        file = tmp_path / f"robot.{suffix}"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_robot_model(
            str(file), PackageIndex((), {}), name=name, xacro_args=xacro_args, without_repairs=without_repairs
        )

    return load


def of(model: RobotModel, kind: Kind) -> list[Finding]:
    return [item for item in model.findings if item.kind is kind]


def instances_in_drake(model: RobotModel) -> list[str]:
    plant = MultibodyPlant(time_step=0.001)
    return [
        plant.GetModelInstanceName(instance)
        for instance in Parser(plant).AddModelsFromString(model.drake_text, model.drake_format)
    ]


@pytest.mark.parametrize(("text", "kind"), [(URDF, "urdf"), (XACRO, "urdf"), (SDF, "sdf")])
@pytest.mark.parametrize(("name", "expected"), [(None, "own"), ("robot_1", "robot_1")])
def test_the_model_instance_has_the_name_in_the_twin_or_the_one_in_the_file(load, text, kind, name, expected):
    model = load(text, name)
    assert model.drake_format == kind
    assert instances_in_drake(model) == [expected]
    assert model.description.name == "own"


def test_arguments_reach_a_xacro_file(load):
    assert load(XACRO, side="right").description.links == ("right_base",)


@pytest.mark.parametrize("text", [URDF, SDF])
def test_arguments_to_a_file_that_takes_none_are_refused(load, tmp_path, text):
    with pytest.raises(InputError) as raised:
        load(text, side="right")
    assert str(raised.value) == (f"{tmp_path}/robot.urdf: side:=right cannot be used: only xacro files take arguments.")


@pytest.mark.parametrize("suffix", ["urdf", "xacro", "urdf.xacro", "xml"])
def test_a_xacro_file_is_known_by_its_content(load, suffix):
    assert load(XACRO, suffix=suffix).description.links == ("left_base",)


@pytest.mark.parametrize("namespace", ["http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro"])
def test_each_of_xacros_namespaces_is_known(namespace):
    assert is_xacro_text(f'<robot xmlns:xacro="{namespace}"/>')
    assert not is_xacro_text("<robot/>")


def test_an_error_has_its_line_in_a_urdf_and_in_a_xacro_file(load, tmp_path):
    with pytest.raises(InputError, match=rf"^{tmp_path}/robot\.urdf:2: "):
        load(URDF.replace('name="base"', ""))
    with pytest.raises(InputError, match=rf"^{tmp_path}/robot\.urdf:1: <link>"):
        load(XACRO.replace('link name="$(arg side)_base"', "link"))


def test_a_robot_that_is_rooted_in_the_world_is_fixed(load):
    links = '<link name="world"/><link name="base"/>'
    joint = '<joint name="j" type="fixed"><parent link="world"/><child link="base"/></joint>'
    model = load(f'<robot name="own">{links}{joint}</robot>')
    assert model.is_fixed
    assert (model.description.root_link, model.root_body) == ("world", "robot_world")
    assert not load(URDF).is_fixed


def test_a_static_sdf_is_fixed(load):
    assert load(SDF.replace("<link", "<static>true</static><link")).is_fixed


PINK_BOX = '<visual><geometry><box size="1 1 1"/></geometry><material name="pink"/></visual>'


def test_what_xacro_warns_of_is_a_warning(load):
    (warning,) = load(XACRO.replace('"left"', '"left" unit="m"')).findings[-1:]
    assert warning.what.startswith("xacro:arg: unknown attribute(s): unit")


def test_what_was_mended_is_listed_in_the_order_of_the_rules(load):
    repairs = of(load(f'<robot>\n<link name="base">{PINK_BOX}</link></robot>'), Kind.MENDED)
    assert [(repair.rule, *repair.lines) for repair in repairs] == [
        ("robot_without_name", 1),
        ("massless_link", 2),
        ("undefined_material", 2),
    ]


def test_what_is_said_of_a_xacro_file_has_file_and_line_of_macro_include_and_block(load, tmp_path):
    (tmp_path / "part.xacro").write_text(
        """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="part" params="name *extra">
  <link name="${name}">

    <shiny/>
    <xacro:insert_block name="extra"/>
    <xacro:element xacro:name="${'gl' + 'ossy'}"/>
  </link>
</xacro:macro>
</robot>"""
    )
    model = load(
        """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:include filename="part.xacro"/>
<link name="base"/>
<xacro:if value="1"><gazebo reference="base">
  <dampingFactor>1</dampingFactor>
</gazebo></xacro:if>
<xacro:part name="a"><dull x="1"/></xacro:part>
<xacro:part name="b">
  <dull/>
</xacro:part>
<joint name="ja" type="fixed"><parent link="base"/><child link="a"/></joint>
<joint name="jb" type="fixed"><parent link="base"/><child link="b"/></joint>
</robot>"""
    )
    places = {(item.what, Path(item.file).name, item.lines) for item in of(model, Kind.IGNORED)}
    assert places == {
        ("<shiny> in <link>", "part.xacro", (5,)),
        ("<dull> in <link>", "robot.urdf", (7, 9)),
        ("<glossy> in <link>", "part.xacro", (3,)),
        ("<dampingFactor> in <gazebo>", "robot.urdf", (5,)),
    }
    assert [(repair.rule, *repair.lines) for repair in of(model, Kind.MENDED)] == [("massless_link", 3)]
    assert "line" not in model.description.text.partition("<robot")[2]


def test_a_repair_that_is_left_out_is_not_made(load):
    nameless = load(URDF.replace("own", ""), without_repairs=["massless_link"])
    assert of(nameless, Kind.MENDED)[0].rule == "robot_without_name"
    assert of(load(URDF, without_repairs=["massless_link"]), Kind.MENDED) == []


@pytest.mark.parametrize("text", [URDF, XACRO, SDF])
def test_a_repair_that_does_not_exist_is_refused_with_those_there_are(load, text):
    with pytest.raises(InputError, match=r"unknown repair 'mimick'\. Did you mean 'mimic'\? Valid: .*inertia"):
        load(text, without_repairs=["mimick"])


def test_the_published_text_is_the_files_own_not_the_mended_one(load):
    assert load(URDF).description.text == URDF


def test_what_is_made_no_use_of_and_the_meshes_are_listed(load, tmp_path):
    (tmp_path / "part.stl").write_bytes(trimesh.creation.cone(1.0, 1.0).export(file_type="stl"))
    mesh = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'
    model = load(f'<robot name="own"><link name="base">{mesh}</link>\n<transmission name="t"/></robot>')
    assert [str(item) for item in of(model, Kind.IGNORED)] == ["<transmission> (robot.urdf:2)"]
    assert model.meshes == (tmp_path / "part.stl",)


def test_a_file_of_another_kind_is_refused(load):
    with pytest.raises(InputError, match=r"robot\.urdf: this is not a robot file, which is a xacro or URDF"):
        load("<svg/>")


def test_a_file_that_is_no_text_is_refused(load):
    with pytest.raises(InputError, match=r"robot\.urdf: the robot file is not UTF-8 text"):
        load(b"<robot \xff>")


def test_a_folder_is_refused(tmp_path):
    with pytest.raises(InputError, match="this is not a file: a robot file is needed"):
        load_robot_model(str(tmp_path), PackageIndex((), {}))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=rf"{tmp_path}/gone\.urdf: the file does not exist"):
        load_robot_model(f"{tmp_path}/gone.urdf", PackageIndex((), {}))


@pytest.mark.parametrize("robot", ["rover", "arduinobot"])
def test_the_twins_own_robots_load_without_warnings(robot):
    model = load_robot_model(f"package://{robot}_description/urdf/{robot}.urdf.xacro", PackageIndex((), {}))
    assert model.findings == ()
    assert len(instances_in_drake(model)) == 1


@pytest.mark.parametrize(
    ("robot", "actuated", "absent"),
    [
        ("arduinobot", {"joint_1", "joint_2", "joint_3", "joint_4"}, []),
        ("bumperbot", {"wheel_left_joint", "wheel_right_joint"}, ["base_link.STL"] * 2),
    ],
)
def test_robots_that_nobody_here_wrote_load_with_the_meshes_they_have(corpus, robot, actuated, absent):
    (file,) = Path(corpus / robot).rglob(f"{robot}.urdf.xacro")
    model = load_robot_model(str(file), PackageIndex((), {}))
    assert {joint.name for joint in model.description.actuated_joints} == actuated
    missing = [repair.what for repair in of(model, Kind.MENDED) if repair.rule == "missing_mesh"]
    assert len(missing) == len(absent)
    assert all(f"/{name}: the file does not exist" in what for name, what in zip(absent, missing, strict=True))
    assert len(instances_in_drake(model)) == 1


def test_two_copies_of_a_robot_convert_its_meshes_once(tmp_path, monkeypatch):
    from drake_twin import TwinBuilder
    from drake_twin.description import meshes

    read = []
    original = meshes.single_mesh
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(meshes, "single_mesh", lambda scene, file: read.append(file.name) or original(scene, file))
    arm = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
    TwinBuilder().robot("a", arm).robot("b", arm, xyz=(2, 0, 0)).build()
    names = ("claw", "finger", "forearm", "pedestal", "turret", "upper_arm")
    assert sorted(read) == sorted(f"{name}.stl" for name in names for _ in ("picture", "contact"))


PENDULUM = """<sdf version="1.7"><model name="pendulum">
<plugin name="p" filename="f"><robotNamespace>/x</robotNamespace></plugin>
<joint name="to_world" type="fixed"><parent>world</parent><child>base</child></joint><link name="base"/>
<link name="bob"><inertial><pose>0 0 -1 0 0 0</pose><mass>1</mass></inertial></link>
<joint name="j" type="revolute"><parent>base</parent><child>bob</child><axis><xyz>0 1 0</xyz>
<limit><effort>50</effort></limit></axis><physics><ode><cfm>0.1</cfm></ode></physics></joint></model></sdf>"""


def test_an_sdf_robot_without_ros2_control_is_limp_as_in_gazebo(tmp_path):
    from drake_twin import TwinBuilder

    (tmp_path / "p.sdf").write_text(PENDULUM)
    twin = TwinBuilder().robot("p", tmp_path / "p.sdf", initial_positions={"j": 0.5}).build()
    twin.advance_to(1.0)
    assert twin.robot_state("p").positions[0] < 0.2
    assert twin.robot_state("p").efforts == (0.0,)


def test_an_sdf_file_is_told_by_its_outermost_tag_and_says_what_is_ignored(tmp_path):
    (tmp_path / "p.sdf").write_text(PENDULUM)
    model = load_robot_model(str(tmp_path / "p.sdf"), PackageIndex((), {}), without_repairs=["inertia"])
    assert model.drake_format == "sdf"
    assert [str(item) for item in of(model, Kind.IGNORED)] == [
        "Gazebo plugin p (f): the twin has no such plugin (p.sdf:2)",
        "<physics> in <joint> (p.sdf:6)",
    ]
    assert [item.what for item in of(model, Kind.WARNING)] == [
        "without_repairs: inertia has no effect on a file that is not URDF"
    ]


@pytest.mark.parametrize(
    ("text", "suffix"),
    [
        (URDF.replace("<robot", "<robot\n xmlns='http://www.ros.org'"), "urdf"),
        (XACRO.replace("<robot", '<robot xmlns="http://www.ros.org"'), "urdf.xacro"),
        (SDF.replace("<sdf", '<sdf xmlns="http://sdformat.org/schemas/root.xsd"'), "sdf"),
    ],
)
def test_a_namespace_of_all_elements_is_not_looked_at_as_in_gazebo(load, text, suffix):
    assert load(text, suffix=suffix).description.links in (("base",), ("left_base",))


@pytest.mark.parametrize("version", ["abc", "1.x", "", "1,9"])
def test_a_version_of_sdf_that_is_no_number_is_refused_with_its_line(load, version):
    with pytest.raises(InputError, match=rf"robot\.sdf:2: <sdf>: the version is '{version}'"):
        load(f'<?xml version="1.0"?>\n{SDF.replace("1.9", version)}', suffix="sdf")


def test_a_mass_below_zero_is_told_as_such(load):
    text = SDF.replace("<link name=", "<link name='other'/><link name=").replace(
        '"base"/>', '"base"><inertial><mass>-3</mass></inertial></link><joint name="j" type="fixed">'
        "<parent>base</parent><child>other</child></joint>"
    )  # fmt: skip
    whats = [finding.what for finding in of(load(text, suffix="sdf"), Kind.WARNING)]
    assert whats == ["link base moves, but its mass is -3, below zero: it weighs 0.001 kg"]


@pytest.mark.parametrize("pose", ["1 2", "0 0 nan 0 0 0", "0 0 up 0 0 0"])
def test_a_pose_that_is_not_six_numbers_is_told_with_its_value(load, pose):
    text = SDF.replace("/></model>", f">\n<pose>{pose}</pose></link></model>")
    with pytest.raises(InputError, match=rf"robot\.sdf:2: <pose> of <link name=\"base\"> is '{pose}'"):
        load(text, suffix="sdf")
