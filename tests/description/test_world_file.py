from math import pi

import pytest
from lxml import etree
from sdf_worlds import BOX, findings, refusal, world_of, write

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.surroundings import SUN, Light
from drake_twin.description.world_file import read_world
from drake_twin.scenario import World

# --- physics


def test_gravity_and_times_are_the_files(tmp_path):
    physics = "<physics type='ode'><max_step_size>0.004</max_step_size></physics>"
    world = world_of(tmp_path, f"<gravity>0 0.1 -1.62</gravity>{physics}")
    assert (world.name, world.gravity) == ("w", (0.0, 0.1, -1.62))
    assert world.max_step_size == 0.004


def test_without_gravity_and_physics_sdfs_defaults_hold(tmp_path):
    world = world_of(tmp_path, "")
    assert world.gravity == (0.0, 0.0, -9.8)
    assert (world.max_step_size, world.models, findings(world)) == (None, (), ())


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
    assert (findings(world), world.max_step_size) == ((), 0.001)


def test_another_of_gazebos_worlds_says_that_it_is_not_there():
    text = refusal(read_world, "shapes.sdf", PackageIndex((), {}))
    assert text.startswith("the world file 'shapes.sdf' does not exist, and of Gazebo's own worlds only some")
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


HELD = f"""<model name="a" placement_frame="grip"><pose degrees="true">1 0 0 0 0 90</pose>{BOX}
  <frame name="grip" attached_to="link"><pose>0.5 0 0 0 0 0</pose></frame></model>"""


@pytest.mark.parametrize(
    ("to", "expected"), [("a", (1, -0.5, 0)), ("a::grip", (1, 0, 0)), ("a::link", (1, -0.5, 0)), ("f", (1, 0.5, 0))]
)
def test_a_placement_frame_is_where_the_pose_says_and_the_model_beside_it(tmp_path, to, expected):
    body = f"""{HELD}<frame name="f" attached_to="a::grip"><pose>0.5 0 0 0 0 0</pose></frame>
    <model name="b"><pose relative_to="{to}">0 0 0 0 0 0</pose>{BOX}</model>"""
    a, b = world_of(tmp_path, body).models
    assert a.pose.xyz == pytest.approx((1, -0.5, 0))
    assert b.pose.xyz == pytest.approx(expected)


def test_a_joint_can_be_a_placement_frame(tmp_path):
    joint = """<link name="arm"><pose>0 0 1 0 0 0</pose></link><joint name="j" type="revolute"><parent>link</parent>
    <child>arm</child><pose>0 1 0 0 0 0</pose></joint>"""
    body = f'<model name="a" placement_frame="j"><static>1</static><pose>5 5 5 0 0 0</pose>{BOX}{joint}</model>'
    (model,) = world_of(tmp_path, body).models
    assert model.pose.xyz == pytest.approx((5, 4, 4))


def test_a_model_inside_another_can_be_a_placement_frame(tmp_path):
    inner = f'<model name="i"><pose>0 0 1 0 0 0</pose>{BOX}</model>'
    body = f'<model name="a" placement_frame="i"><pose>5 5 5 0 0 0</pose>{BOX}{inner}</model>'
    (model,) = world_of(tmp_path, body).models
    assert model.pose.xyz == pytest.approx((5, 5, 4))


def test_a_frame_that_a_model_lacks_costs_what_is_relative_to_it(tmp_path):
    world = world_of(tmp_path, f'{HELD}<model name="b"><pose relative_to="a::gone">0 0 0 0 0 0</pose>{BOX}</model>')
    assert [model.name for model in world.models] == ["a"]
    (text,) = findings(world)
    assert "its pose depends on the frame 'gone' of 'a', which does not exist" in text


def test_a_quaternion_is_a_pose_too(tmp_path):
    body = f'<model name="a"><pose rotation_format="quat_xyzw">0 0 1 0 0 1 0</pose>{BOX}</model>'
    assert abs(world_of(tmp_path, body).models[0].pose.rpy[2]) == pytest.approx(pi)


@pytest.mark.parametrize(
    ("pose", "what"),
    [
        (
            '<pose relative_to="gone">0 0 0 0 0 0</pose>',
            "its pose is relative to 'gone', which does not exist",
        ),
        ('<pose relative_to="a">0 0 0 0 0 0</pose>', "its pose is relative to 'a', which is relative to it"),
        ("<pose>1 2 3</pose>", "'1 2 3' is not a pose (six numbers are needed)"),
        ("<pose>1 2 nan 0 0 0</pose>", "'1 2 nan 0 0 0' is not a pose (not finite)"),
    ],
)
def test_a_pose_that_is_none_costs_its_model_and_is_said_with_its_line(tmp_path, pose, what):
    world = world_of(tmp_path, f'<model name="a">\n{pose}{BOX}</model><model name="b">{BOX}</model>')
    assert [model.name for model in world.models] == ["b"]
    (finding,) = world.findings
    assert what in finding.what
    assert (finding.file, finding.lines) == (f"{tmp_path}/test.world", (5 if "is not a pose" in what else 4,))


@pytest.mark.parametrize(
    "pose", ["<pose/>", '<pose rotation_format="quat_xyzw"/>', "<pose frame=''>0 0 0 0 0 0</pose>"]
)
def test_an_empty_pose_is_no_pose(tmp_path, pose):
    assert world_of(tmp_path, f'<model name="a">{pose}{BOX}</model>').models[0].pose.xyz == (0, 0, 0)


def test_a_saved_state_goes_before_the_models_own_pose(tmp_path):
    body = f"""<model name="a"><pose>9 9 9 0 0 0</pose>{BOX}</model>
    <state world_name="w"><model name="a"><pose>1 2 3 0 0 0</pose></model></state>"""
    world = world_of(tmp_path, body)
    assert world.models[0].pose.xyz == (1.0, 2.0, 3.0)
    assert findings(world) == (
        "a: the start pose is that of <state>, as in Gazebo classic; Gazebo Sim does not read it",
    )


@pytest.mark.parametrize(
    "plugin", ['filename="gz-sim-physics-system" name="x"', 'filename="x" name="ignition::gazebo::systems::Physics"']
)
def test_a_world_of_gazebo_sim_has_no_saved_state(tmp_path, plugin):
    body = f"""<plugin {plugin}/><model name="a"><pose>9 9 9 0 0 0</pose>{BOX}</model>
    <state world_name="w"><model name="a"><pose>1 2 3 0 0 0</pose></model></state>"""
    world = world_of(tmp_path, body)
    assert world.models[0].pose.xyz == (9.0, 9.0, 9.0)
    assert "<state> of the world, which Gazebo Sim does not read" in findings(world)


def test_a_second_state_of_a_model_is_a_finding_with_its_line(tmp_path):
    state = '<model name="a"><pose>{} 2 3 0 0 0</pose></model>'
    body = f'<model name="a">{BOX}</model>\n<state world_name="w">{state.format(1)}\n{state.format(4)}</state>'
    world = world_of(tmp_path, body)
    assert world.models[0].pose.xyz == (4.0, 2.0, 3.0)
    (finding,) = (item for item in world.findings if "second" in item.what)
    assert (finding.what, finding.lines) == ("a second state of the model a: it replaces the first", (6,))


def test_two_models_of_one_name_get_two_names(tmp_path):
    world = world_of(tmp_path, f'<model name="a">{BOX}</model><model name="a">{BOX}</model>')
    assert [model.name for model in world.models] == ["a", "a_0"]
    assert findings(world) == ("a: several models have this name; one is called a_0",)


@pytest.mark.parametrize(
    ("flag", "falls"),
    [("<gravity>0</gravity>", False), ("<gravity>1</gravity>", True), ("<gravity/>", True), ("", True)],
)
def test_a_model_without_gravity_does_not_fall(tmp_path, flag, falls):
    world = world_of(tmp_path, f'<model name="a"><link name="l">{flag}</link></model>')
    assert (world.models[0].falls, findings(world)) == (falls, ())


# --- what is not used


def test_each_kind_of_what_is_not_used_is_told_once_with_its_lines(tmp_path):
    body = """<gui/>\n<scene/>\n<actor name="p"/>\n<actor name="q"/>
    <plugin filename="libwind.so" name="wind"/>\n<road name="r"/><light name="l"/>"""
    assert tuple(map(str, world_of(tmp_path, body).findings)) == (
        "<gui> of the world (test.world:4)",
        "<scene> of the world (test.world:5)",
        "<actor> of the world (test.world:6, 7)",
        "the plugin wind of the world (test.world:8)",
        "<road> of the world (test.world:9)",
    )


def test_of_the_scene_background_and_shadows_are_used(tmp_path):
    light = '<light name="l" type="directional"><cast_shadows>1</cast_shadows></light>'
    body = f"<scene><background>0.1 0.2 0.3 1</background><shadows>0</shadows>\n<ambient>1 1 1</ambient></scene>{light}"
    world = world_of(tmp_path, body)
    assert world.surroundings.background == (0.1, 0.2, 0.3)
    assert [item.casts_shadows for item in world.surroundings.lights] == [False]
    assert tuple(map(str, world.findings)) == ("<ambient> in <scene> of the world (test.world:5)",)


def test_lights_of_a_world_and_of_what_it_includes(tmp_path):
    spot = """<light name="s" type="spot"><pose>1 2 3 0 0 0</pose><diffuse>0.5 0.6 0.7 1</diffuse>
    <direction>0 1 0</direction><spot><outer_angle>0.8</outer_angle></spot><intensity>2</intensity>
    <attenuation><constant>0.5</constant><linear>0.1</linear><quadratic>0.01</quadratic></attenuation></light>"""
    world = world_of(tmp_path, f"{spot}<include><uri>model://sun</uri></include>")
    first, sun = world.surroundings.lights
    assert first == Light("spot", (1, 2, 3), (0, 1, 0), (0.5, 0.6, 0.7), 2.0, (0.5, 0.1, 0.01), 0.8, False)
    assert sun == SUN


@pytest.mark.parametrize(
    ("body", "wind"),
    [
        ("", (0.0, 0.0, 0.0)),
        ("<wind/>", (0.0, 0.0, 0.0)),
        ("<wind><linear_velocity/></wind>", (0.0, 0.0, 0.0)),
        ("<wind><linear_velocity> 1 -2.5\n0.5 </linear_velocity></wind>", (1.0, -2.5, 0.5)),
    ],
)
def test_the_wind_of_a_world(tmp_path, body, wind):
    world = world_of(tmp_path, body)
    assert (world.surroundings.wind, world.findings) == (wind, ())


LINK = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'


@pytest.mark.parametrize(
    ("body", "models", "said"),
    [
        ('<light name="x" type="laser"/>', ["h"], "unknown light type 'laser'"),
        ('<light name="x"><diffuse>a b c</diffuse></light>', ["h"], "diffuse is 'a', which is not a number"),
        ("<scene><background><color>1 0 0</color></background></scene>", ["h"], "three numbers are needed"),
        ("<magnetic_field>1 2</magnetic_field>", ["h"], "three numbers are needed"),
        ("<wind><linear_velocity>1 2 3 4</linear_velocity></wind>", ["h"], "three numbers are needed"),
        ("<wind><linear_velocity>1 2 nan</linear_velocity></wind>", ["h"], "is 'nan', which is not finite"),
        ("<wind><speed>3</speed></wind>", ["h"], "<speed>"),
        (
            "<spherical_coordinates><latitude_deg>91</latitude_deg></spherical_coordinates>",
            ["h"],
            "latitude_deg is '91', but it must be -90 to 90",
        ),
        (f"<model>{LINK}</model>", ["h"], "the attribute 'name' is missing"),
        (f'<model name="world">{LINK}</model>', ["world_0", "h"], "world: SDF reserves such a name"),
        (f'<model name="a::b">{LINK}</model>', ["a_b", "h"], "a::b: SDF reserves such a name"),
    ],
)
def test_what_is_wrong_with_an_element_of_a_world_costs_that_element(tmp_path, body, models, said):
    world = world_of(tmp_path, f'{body}<model name="h"><static>1</static>{LINK}</model>')
    assert [model.name for model in world.models] == models
    (finding,) = world.findings
    assert said in finding.what
    assert (finding.file, len(finding.lines)) == (str(tmp_path / "test.world"), 1)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (f'{LINK}<frame name="f"/><frame name="f"/>', "a <frame> has the name of another part, f: it is left out"),
        (f'{LINK}<frame name="l"/>', "a <frame> has the name of another part, l: it is left out"),
        (
            f'{LINK}<model name="l">{LINK}</model>',
            "a model inside it has the name of another part, l: it is called l_0",
        ),
    ],
)
def test_a_model_whose_parts_share_a_name_is_there(tmp_path, body, said):
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="l"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    world = world_of(tmp_path, f'<model name="h"><static>1</static>{body}</model>')
    assert [finding.what for finding in world.findings] == [f"h: {said}"]
    twin = TwinBuilder(world=World(file=str(tmp_path / "test.world"))).robot("r", tmp_path / "r.urdf").build()
    assert not [text for text in twin.findings.warnings if "Drake refuses" in text]
    assert [shape for shape in twin.built.shapes if not shape.model]


def test_plugins_whose_work_the_twin_does_are_passed_over(tmp_path):
    names = ("physics", "user-commands", "scene-broadcaster")
    body = "".join(f'<plugin filename="gz-sim-{name}-system" name="x"/>' for name in names)
    body += '<plugin filename="libgazebo_ros_init.so" name="y"/>'
    assert findings(world_of(tmp_path, body)) == ()


def test_one_thing_about_many_models_is_one_warning(tmp_path):
    link = '<link name="l"><light name="s"/></link>'
    body = "".join(f'<model name="m{index}">{link}</model>' for index in range(6))
    assert findings(world_of(tmp_path, body)) == ("m0, m1, m2, m3 and 2 more: <light> is not used",)


# --- bad input


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (
            "<sdf version='1.9'><model name='a'/></sdf>",
            "a world is an SDF file with a <world>, but this has no <world>",
        ),
        ("<robot name='a'/>", "a world is an SDF file with a <world>, but this begins with <robot>"),
        ("<sdf><world name='w'>", "this is not well-formed XML"),
        (
            "<sdf><world name='w'><gravity>0 0</gravity></world></sdf>",
            "gravity is '0 0', where three numbers are needed",
        ),
        ("<sdf><world name='w'><gravity>0 0 x</gravity></world></sdf>", "gravity is 'x', which is not a number"),
        ("<sdf><world name='w'><include/></world></sdf>", "<uri> is missing"),
    ],
)
def test_a_file_that_is_no_world_is_refused_in_a_paragraph(tmp_path, text, what):
    file = tmp_path / "bad.sdf"
    file.write_text(text)
    message = refusal(read_world, str(file), PackageIndex((), {}))
    assert message.startswith(str(file))
    assert what in message


def test_the_worlds_that_others_wrote_are_read(corpus):
    index = PackageIndex((), {})
    worlds = {file.stem: read_world(str(file), index) for file in corpus.rglob("*.world")}
    assert (worlds["Lunar"].gravity, worlds["Lunar"].max_step_size) == ((0.0, 0.0, -1.62), 0.04)
    assert "these models and packages were not found" in " ".join(findings(worlds["Lunar"]))  # not in the corpus
    models = worlds["playground"].models
    assert (len(models), len({model.name for model in models})) == (21, 21)
    assert models[0].name == "ground_plane"


SHAPE = "<geometry><box><size>1 1 1</size></box></geometry>"


NOT_SDF = {
    "a: <difuse> in <material>": "<model name='a'><static>1</static><link name='l'>"
    "<visual name='v'>{}<material><difuse/>"
    "</material></visual></link></model>",
    "a: the attribute nam of <collision>": "<model name='a'><link name='l'>"
    "<collision nam='c'>{}</collision></link></model>",
    "a: <mas> in <inertial>": "<model name='a'><link name='l'><inertial><mas>1</mas></inertial></link></model>",
    "a: friction of joint j: only those of robots have it": "<model name='a'><link name='l'/><link name='k'/>"
    "<joint name='j' type='revolute'><parent>l</parent><child>k</child><axis><dynamics><friction>1</friction>"
    "</dynamics></axis></joint></model>",
    "<poes> in <light>": "<light name='s' type='point'><poes/></light>",
    "the attribute tpe of <light>": "<light name='s' tpe='point'/>",
    "<cast_shadows> is 'ture', which is neither true nor false: it counts as false": "<light name='s' type='point'>"
    "<cast_shadows>ture</cast_shadows></light>",
    "<max_step_sise> in <physics>": "<physics type='ode'><max_step_sise>0.1</max_step_sise></physics>",
    "<latitude> in <spherical_coordinates>": "<spherical_coordinates><latitude>1</latitude></spherical_coordinates>",
}


@pytest.mark.parametrize("said", NOT_SDF)
def test_what_is_not_sdf_in_a_world_is_a_finding_with_its_line(tmp_path, said):
    found = world_of(tmp_path, "\n\n" + NOT_SDF[said].format(SHAPE)).findings
    assert [(item.what, item.lines) for item in found] == [(said, (6,))]


def test_how_things_of_a_world_look_needs_no_finding(tmp_path):
    material = "<material><ambient>1 0 0 1</ambient><specular>1 1 1 1</specular><pbr><metal/></pbr></material>"
    light = "<light name='s' type='spot'><specular>1 1 1 1</specular><spot><falloff>1</falloff></spot></light>"
    model = (
        f"<model name='a'><static>1</static><link name='l'><visual name='v'>{SHAPE}{material}</visual></link></model>"
    )
    assert world_of(tmp_path, light + model).findings == ()


def test_what_stands_beside_the_world_is_a_finding(tmp_path):
    body = "<gravity>0 0 -1</gravity>\n<gravity>0 0 -2</gravity></world>\n<world name='other'>"
    world = world_of(tmp_path, body)
    assert world.gravity == (0, 0, -1)
    assert sorted(map(str, world.findings)) == [
        "<gravity> beside the first of the world (test.world:5)",
        "<world> beside the first of the world (test.world:6)",
    ]
