import os
from math import pi

import pytest
import trimesh
from conftest import CORPUS
from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.world_file import read_world
from drake_twin.errors import InputError

BOX = '<link name="link"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'


def write(folder, name, body, version="1.9"):
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f'<?xml version="1.0"?>\n<sdf version="{version}">\n{body}\n</sdf>\n')
    return file


def world_of(tmp_path, body, *, version="1.9", **environment):
    file = write(tmp_path, "test.world", f'<world name="w">\n{body}\n</world>', version)
    return read_world(str(file), PackageIndex((), {name: str(value) for name, value in environment.items()}))


def model_file(folder, name, body=BOX, version="1.9"):
    write(folder / name, "model.sdf", f'<model name="{name}">{body}</model>', version)
    (folder / name / "model.config").write_text(f'<model><sdf version="{version}">model.sdf</sdf></model>')
    return folder


def refusal(call, *arguments, **named):
    with pytest.raises(InputError) as raised:
        call(*arguments, **named)
    return str(raised.value)


# --- physics


def test_gravity_and_times_are_the_files(tmp_path):
    physics = (
        "<physics type='ode'><max_step_size>0.004</max_step_size><real_time_factor>0.5</real_time_factor></physics>"
    )
    world = world_of(tmp_path, f"<gravity>0 0.1 -1.62</gravity>{physics}")
    assert (world.name, world.gravity) == ("w", (0.0, 0.1, -1.62))
    assert (world.max_step_size, world.real_time_factor) == (0.004, 0.5)


def test_without_gravity_and_physics_sdfs_defaults_hold(tmp_path):
    world = world_of(tmp_path, "")
    assert world.gravity == (0.0, 0.0, -9.8)
    assert (world.max_step_size, world.real_time_factor, world.models, world.warnings) == (None, None, (), ())


def test_gravity_stands_in_physics_before_sdf_1_5(tmp_path):
    assert world_of(tmp_path, "<physics><gravity>0 0 -3</gravity></physics>", version="1.4").gravity == (0, 0, -3)


def test_the_default_one_of_several_physics_counts(tmp_path):
    step = "<physics {}><max_step_size>{}</max_step_size></physics>"
    body = step.format("", 0.1) + step.format("default='1'", 0.002)
    assert world_of(tmp_path, body).max_step_size == 0.002


@pytest.mark.parametrize("name", ["empty.sdf", "worlds/empty.world", "/nowhere/empty.sdf"])
def test_the_empty_world_is_built_in(name):
    world = read_world(name, PackageIndex((), {}))
    assert [(model.name, model.is_static) for model in world.models] == [("ground_plane", True)]
    assert (world.warnings, world.max_step_size) == ((), 0.001)


def test_another_of_gazebos_worlds_says_that_it_is_not_there():
    text = refusal(read_world, "shapes.sdf", PackageIndex((), {}))
    assert text.startswith("there is no world file 'shapes.sdf', and of the worlds that come with Gazebo only some")
    assert text.endswith("Valid: empty.sdf, empty.world, default.sdf.")


def test_a_world_is_found_by_its_name_in_the_resource_path(tmp_path):
    write(tmp_path, "worlds/moon.sdf", '<world name="moon"/>')
    index = PackageIndex((), {"GZ_SIM_RESOURCE_PATH": str(tmp_path / "worlds")})
    assert read_world("moon.sdf", index).name == "moon"


# --- models and their poses


def test_static_and_moving_models_are_told_apart(tmp_path):
    body = f'<model name="a"><static>1</static>{BOX}</model><model name="b">{BOX}</model>'
    assert [(model.name, model.is_static) for model in world_of(tmp_path, body).models] == [("a", True), ("b", False)]


def test_each_text_holds_one_model_at_its_pose(tmp_path):
    world = world_of(tmp_path, f'<model name="a"><pose>1 2 3 0 0 0.5</pose>{BOX}</model><model name="b">{BOX}</model>')
    first = etree.fromstring(world.models[0].text)
    assert [model.get("name") for model in first.iter("model")] == ["a"]
    assert [float(part) for part in first.findtext("model/pose").split()] == pytest.approx([1, 2, 3, 0, 0, 0.5])
    assert world.models[0].pose.xyz == (1.0, 2.0, 3.0)


def test_poses_relative_to_models_and_frames_are_in_the_world(tmp_path):
    body = f"""<model name="a"><pose degrees="true">1 0 0 0 0 90</pose>{BOX}</model>
    <frame name="f" attached_to="a"><pose>1 0 0 0 0 0</pose></frame>
    <model name="b"><pose relative_to="f">0 2 0 0 0 0</pose>{BOX}</model>"""
    pose = world_of(tmp_path, body).models[1].pose
    assert pose.xyz == pytest.approx((-1, 1, 0))
    assert pose.rpy == pytest.approx((0, 0, pi / 2))


def test_a_quaternion_is_a_pose_too(tmp_path):
    body = f'<model name="a"><pose rotation_format="quat_xyzw">0 0 1 0 0 1 0</pose>{BOX}</model>'
    assert abs(world_of(tmp_path, body).models[0].pose.rpy[2]) == pytest.approx(pi)


@pytest.mark.parametrize(
    ("pose", "what"),
    [
        ('<pose relative_to="gone">0 0 0 0 0 0</pose>', "its pose is relative to 'gone', which is no model or frame"),
        ('<pose relative_to="a">0 0 0 0 0 0</pose>', "its pose is relative to 'a', which is relative to it"),
        ("<pose>1 2 3</pose>", "'1 2 3' is no pose (six numbers are needed)"),
        ("<pose>1 2 nan 0 0 0</pose>", "'1 2 nan 0 0 0' is no pose (not finite)"),
    ],
)
def test_a_pose_that_is_none_is_refused_with_its_line(tmp_path, pose, what):
    text = refusal(world_of, tmp_path, f'<model name="a">\n{pose}{BOX}</model>')
    assert text.startswith(f"{tmp_path}/test.world:")
    assert what in text


def test_a_saved_state_goes_before_the_models_own_pose(tmp_path):
    body = f"""<model name="a"><pose>9 9 9 0 0 0</pose>{BOX}</model>
    <state world_name="w"><model name="a"><pose>1 2 3 0 0 0</pose></model></state>"""
    assert world_of(tmp_path, body).models[0].pose.xyz == (1.0, 2.0, 3.0)


def test_two_models_of_one_name_get_two_names(tmp_path):
    world = world_of(tmp_path, f'<model name="a">{BOX}</model><model name="a">{BOX}</model>')
    assert [model.name for model in world.models] == ["a", "a_0"]
    assert world.warnings == ("a: there are several models of this name; one is called a_0",)


@pytest.mark.parametrize(
    ("flag", "falls"), [("<gravity>0</gravity>", False), ("<gravity>1</gravity>", True), ("", True)]
)
def test_a_model_without_gravity_does_not_fall(tmp_path, flag, falls):
    (model,) = world_of(tmp_path, f'<model name="a"><link name="l">{flag}</link></model>').models
    assert model.falls is falls


# --- includes


def test_an_include_takes_name_pose_and_static_from_where_it_stands(tmp_path):
    model_file(tmp_path / "gz", "crate", f"<pose>7 7 7 0 0 0</pose>{BOX}")
    body = """<include><uri>model://crate</uri><name>c1</name><pose>1 0 0 0 0 0</pose><static>true</static></include>
    <include><uri>model://crate</uri></include>"""
    world = world_of(tmp_path, body, GZ_SIM_RESOURCE_PATH=tmp_path / "gz")
    assert [(model.name, model.pose.xyz, model.is_static) for model in world.models] == [
        ("c1", (1.0, 0.0, 0.0), True),
        ("crate", (7.0, 7.0, 7.0), False),
    ]


@pytest.mark.parametrize(
    "address",
    [
        "model://crate",
        "package://my_world/models/crate",
        "file://models/crate/model.sdf",
        "models/crate",
        "{}/models/crate",
    ],
)
def test_an_include_is_found_by_each_kind_of_address(tmp_path, address):
    (tmp_path / "package.xml").write_text("<package><name>my_world</name></package>")
    model_file(tmp_path / "models", "crate")
    write(tmp_path, "w.sdf", f"<world name='w'><include><uri>{address.format(tmp_path)}</uri></include></world>")
    world = read_world(str(tmp_path / "w.sdf"), PackageIndex((), {}))
    assert ([model.name for model in world.models], world.warnings) == (["crate"], ())


def test_a_model_finds_models_in_the_models_folder_of_the_package(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>my_world</name></package>")
    model_file(tmp_path / "models", "crate")
    file = write(tmp_path, "worlds/deep/w.sdf", "<world name='w'><include><uri>model://crate</uri></include></world>")
    assert len(read_world(str(file), PackageIndex((), {})).models) == 1


def test_the_newest_sdf_of_a_model_config_is_taken(tmp_path):
    model_file(tmp_path, "crate", version="1.5")
    write(tmp_path / "crate", "new.sdf", f'<model name="new_crate">{BOX}</model>')
    old_first = '<model><sdf version="1.10">new.sdf</sdf><sdf version="1.5">model.sdf</sdf></model>'
    (tmp_path / "crate" / "model.config").write_text(old_first)
    (model,) = world_of(tmp_path, "<include><uri>model://crate</uri></include>").models
    assert model.name == "new_crate"


def test_nested_includes_end_in_one_text(tmp_path):
    model_file(tmp_path, "wheel", BOX)
    model_file(tmp_path, "cart", f"{BOX}<include><uri>model://wheel</uri><name>left</name></include>")
    (model,) = world_of(tmp_path, "<include><uri>model://cart</uri></include>").models
    assert [item.get("name") for item in etree.fromstring(model.text).iter("model")] == ["cart", "left"]


def test_a_model_that_only_includes_a_static_one_is_static(tmp_path):
    model_file(tmp_path, "floor", f"<static>true</static>{BOX}")
    (model,) = world_of(tmp_path, '<model name="f"><include><uri>model://floor</uri></include></model>').models
    assert model.is_static


def test_a_loop_of_includes_is_refused_with_its_way_round(tmp_path):
    model_file(tmp_path, "a", "<include><uri>model://b</uri></include>")
    model_file(tmp_path, "b", "<include><uri>model://c/other.sdf</uri></include>")
    write(tmp_path / "c", "other.sdf", "<model name='c'><include><uri>model://a</uri></include></model>")
    text = refusal(world_of, tmp_path, "<include><uri>model://a</uri></include>")
    assert "the includes form a loop: model.sdf → model.sdf → other.sdf → model.sdf" in text


def test_a_bomb_of_includes_is_refused(tmp_path):
    for level in range(6):
        below = f"<include><uri>model://m{level + 1}</uri></include>" * 12
        model_file(tmp_path, f"m{level}", below)
    model_file(tmp_path, "m6", BOX)
    assert "includes more than 10000 models" in refusal(world_of, tmp_path, "<include><uri>model://m0</uri></include>")


def test_sun_and_ground_plane_are_built_in_also_from_fuel(tmp_path):
    fuel = "https://fuel.gazebosim.org/1.0/OpenRobotics/models"
    body = "".join(f"<include><uri>{fuel}/{name}</uri></include>" for name in ("Sun", "Ground Plane"))
    body += "<include><uri>model://sun</uri></include>"
    world = world_of(tmp_path, body)
    assert ([model.name for model in world.models], world.warnings) == (["ground_plane"], ())


def test_a_users_own_ground_plane_goes_before_the_built_in_one(tmp_path):
    model_file(tmp_path, "ground_plane", f"<static>true</static><pose>0 0 -5 0 0 0</pose>{BOX}")
    (model,) = world_of(tmp_path, "<include><uri>model://ground_plane</uri></include>").models
    assert model.pose.xyz[2] == -5


def test_nothing_is_downloaded(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("GZ_FUEL_CACHE_PATH", raising=False)
    uri = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Oak tree"
    world = world_of(tmp_path, f"<include><uri>{uri}</uri></include>")
    assert world.models == ()
    (warning,) = world.warnings
    assert f"test.world:4: {uri} is not included: the twin downloads nothing" in warning


def test_what_gazebo_downloaded_before_is_used(tmp_path, monkeypatch):
    monkeypatch.setenv("GZ_FUEL_CACHE_PATH", str(tmp_path / "fuel"))
    for version in ("2", "10"):
        folder = tmp_path / "fuel" / "fuel.gazebosim.org" / "openrobotics" / "models" / "oak tree"
        model_file(folder, version, BOX)
    uri = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Oak tree"
    (model,) = world_of(tmp_path, f"<include><uri>{uri}</uri></include>").models
    assert model.name == "10"


def test_models_that_are_nowhere_are_named_in_one_warning(tmp_path):
    body = "".join(f"<include><uri>model://{name}</uri></include>" for name in ("cafe", "table", "cafe"))
    mesh = "<mesh><uri>model://tree/tree.dae</uri></mesh>"
    body += f'<model name="a">{BOX.replace("<box><size>1 1 1</size></box>", mesh)}</model>'
    (warning,) = world_of(tmp_path, body).warnings
    assert warning.startswith("test.world: what these models and packages hold is left out: cafe, table, tree. ")
    assert str(tmp_path) in warning or "GAZEBO" in warning or "--package-path" in warning


def test_an_included_file_that_is_broken_leaves_the_rest(tmp_path):
    model_file(tmp_path, "crate").joinpath("crate", "model.sdf").write_text("<sdf><model name='crate'></sdf>")
    world = world_of(tmp_path, f'<include><uri>model://crate</uri></include><model name="a">{BOX}</model>')
    assert [model.name for model in world.models] == ["a"]
    assert "model://crate is not included: " in world.warnings[0]
    assert "not well-formed XML" in world.warnings[0]


def test_merged_links_become_the_models_own(tmp_path):
    model_file(tmp_path, "lid", '<link name="lid"/>')
    include = '<include merge="true"><uri>model://lid</uri><pose>0 0 1 0 0 0</pose></include>'
    (model,) = world_of(tmp_path, f'<model name="box">{BOX}{include}</model>').models
    root = etree.fromstring(model.text)
    assert [link.get("name") for link in root.iterfind("model/link")] == ["link", "lid"]
    frame = root.find("model/frame")
    assert frame.findtext("pose") == "0 0 1 0 0 0"
    assert root.findall("model/link")[1].find("pose").get("relative_to") == frame.get("name")


# --- what is not used


def test_each_kind_of_what_is_not_used_is_told_once_with_its_lines(tmp_path):
    body = """<gui/>\n<scene/>\n<actor name="p"/>\n<actor name="q"/>
    <plugin filename="libwind.so" name="wind"/>\n<road name="r"/><light name="l"/>"""
    assert world_of(tmp_path, body).warnings == (
        "test.world: <gui> is not used (line 4)",
        "test.world: <scene> is not used (line 5)",
        "test.world: <actor> is not used (line 6, 7)",
        "test.world: the plugin wind is not used (line 8)",
        "test.world: <road> is not used (line 9)",
    )


def test_plugins_whose_work_the_twin_does_are_passed_over(tmp_path):
    names = ("physics", "user-commands", "scene-broadcaster")
    body = "".join(f'<plugin filename="gz-sim-{name}-system" name="x"/>' for name in names)
    body += '<plugin filename="libgazebo_ros_init.so" name="y"/>'
    assert world_of(tmp_path, body).warnings == ()


def test_one_thing_about_many_models_is_one_warning(tmp_path):
    link = '<link name="l"><sensor name="s" type="camera"/></link>'
    body = "".join(f'<model name="m{index}">{link}</model>' for index in range(6))
    assert world_of(tmp_path, body).warnings == ("m0, m1, m2, m3 and 2 more: <sensor> camera is not used",)


# --- bad input


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (
            "<sdf version='1.9'><model name='a'/></sdf>",
            "a world is an SDF file with a <world>, but this holds no <world>",
        ),
        ("<robot name='a'/>", "a world is an SDF file with a <world>, but this begins with <robot>"),
        ("<sdf><world name='w'>", "this is not well-formed XML"),
        (
            "<sdf><world name='w'><gravity>0 0</gravity></world></sdf>",
            "gravity is '0 0', where three numbers are needed",
        ),
        ("<sdf><world name='w'><gravity>0 0 x</gravity></world></sdf>", "gravity is 'x', which is not a number"),
        ("<sdf><world name='w'><model/></world></sdf>", "the attribute 'name' is missing"),
        ("<sdf><world name='w'><include/></world></sdf>", "<uri> is missing"),
    ],
)
def test_a_file_that_is_no_world_is_refused_in_a_paragraph(tmp_path, text, what):
    file = tmp_path / "bad.sdf"
    file.write_text(text)
    message = refusal(read_world, str(file), PackageIndex((), {}))
    assert message.startswith(str(file))
    assert what in message


def test_what_gazebos_reader_lets_pass_is_let_pass_and_lines_stay(tmp_path):
    file = tmp_path / "odd.world"
    text = '<sdf version="1.9"><!-- a -- b\n-->\n<world name="w" gz:x="1"><gravity>0 0 u</gravity></world></sdf>'
    file.write_text(f'\n\n<?xml version="1.0"?>\n{text}')
    assert f"{file}:6: <gravity>" in refusal(read_world, str(file), PackageIndex((), {}))


# --- shapes


def geometry(text, tmp_path, *, static=True, kind="collision", more=""):
    link = f'<link name="l"><{kind} name="c">{more}<geometry>{text}</geometry></{kind}></link>'
    world = world_of(tmp_path, f'<model name="a"><static>{str(static).lower()}</static>{link}</model>')
    return etree.fromstring(world.models[0].text).find(f".//{kind}"), world.warnings


def test_friction_is_the_smaller_coefficient_and_at_most_one(tmp_path):
    surface = "<surface><friction><ode><mu>{}</mu><mu2>{}</mu2></ode></friction></surface>"
    for mu, mu2, expected in ((100, 50, 1.0), (0.8, 0.3, 0.3)):
        shape, _ = geometry("<sphere><radius>1</radius></sphere>", tmp_path, more=surface.format(mu, mu2))
        assert [float(item.text) for item in shape.find("{*}proximity_properties")] == [expected, expected]


def test_a_plane_is_drawn_as_a_thin_box_of_its_size(tmp_path):
    shape, _ = geometry("<plane><normal>0 0 1</normal><size>3 4</size></plane>", tmp_path, kind="visual")
    assert shape.findtext("geometry/box/size") == "3 4 0.001"
    assert float(shape.findtext("pose").split()[2]) == -0.0005


@pytest.mark.parametrize(
    ("material", "transparency", "expected"),
    [
        ("<diffuse>0.1 0.2 0.3 1</diffuse>", "", "0.1 0.2 0.3 1"),
        ("<script><name>Gazebo/Red</name></script>", "", "1 0 0 1"),
        ("<ambient>0 0.5 0 1</ambient>", "", "0 0.5 0 1"),
        ("<diffuse>7 0 0</diffuse>", "<transparency>0.25</transparency>", "1 0 0 0.75"),
    ],
)
def test_a_visual_has_the_colour_that_gazebo_gives_it(tmp_path, material, transparency, expected):
    more = f"<material>{material}</material>{transparency}"
    shape, _ = geometry("<sphere><radius>1</radius></sphere>", tmp_path, kind="visual", more=more)
    assert shape.findtext("material/diffuse") == expected


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("<box><size>1 0 1</size></box>", "a: a collision <box> has no size: it is left out"),
        ("<heightmap><uri>x</uri></heightmap>", "a: a collision of the shape <heightmap> is left out: Drake has none"),
        ("<plane/>", "a: a collision <plane> of a model that moves is left out: Drake has none"),
    ],
)
def test_a_shape_that_drake_has_not_is_left_out_with_a_warning(tmp_path, text, what):
    shape, warnings = geometry(text, tmp_path, static=False)
    assert shape is None
    assert warnings == (what,)


def test_a_moving_models_mesh_collides_as_its_hull_or_the_primitive_that_it_is(tmp_path):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "box.stl")
    trimesh.creation.cone(1.0, 2.0).export(tmp_path / "cone.stl")
    box, _ = geometry("<mesh><uri>box.stl</uri><scale>2 1 1</scale></mesh>", tmp_path, static=False)
    assert [float(side) for side in box.findtext("geometry/box/size").split()] == pytest.approx([2, 2, 3])
    cone, _ = geometry("<mesh><uri>cone.stl</uri></mesh>", tmp_path, static=False)
    assert cone.findtext("geometry/mesh/uri").endswith(".hull.obj")


def test_moments_that_no_body_has_are_mended_as_in_a_robot(tmp_path):
    inertia = "<mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>9</izz></inertia>"
    world = world_of(tmp_path, f'<model name="a"><link name="l"><inertial>{inertia}</inertial></link></model>')
    assert world.warnings == ("a: link l: no body has the principal moments 1, 1, 9: the nearest possible are used",)
    ixx, iyy, izz = (float(etree.fromstring(world.models[0].text).findtext(f".//{n}")) for n in ("ixx", "iyy", "izz"))
    assert ixx + iyy >= izz


def test_the_worlds_that_others_wrote_are_read(corpus):
    for file in (*CORPUS.rglob("*.world"), *CORPUS.rglob("worlds/*.sdf")):
        world = read_world(str(file), PackageIndex((), dict(os.environ)))
        assert world.models, file
