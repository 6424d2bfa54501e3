import pytest
from lxml import etree
from sdf_worlds import BOX, findings, model_file, refusal, world_of, write

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.world_file import read_world
from drake_twin.findings import Kind, most_telling


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
    assert ([model.name for model in world.models], findings(world)) == (["crate"], ())


@pytest.mark.parametrize("address", ["crate", "model://crate", "crate/model.sdf"])
@pytest.mark.parametrize("given", ["folder", "environment"])
def test_a_name_alone_is_found_where_models_are_said_to_be(tmp_path, address, given):
    model_file(tmp_path / "mine", "crate")
    include = f"<world name='w'><include><uri>{address}</uri></include></world>"
    file = write(tmp_path / "elsewhere", "w.sdf", include)
    mine = str(tmp_path / "mine")
    index = PackageIndex((mine,), {}) if given == "folder" else PackageIndex((), {"GZ_SIM_RESOURCE_PATH": mine})
    assert [model.name for model in read_world(str(file), index).models] == ["crate"]


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


def test_one_model_included_twice_in_another_gets_two_names(tmp_path):
    model_file(tmp_path, "wheel", BOX)
    body = f'<model name="cart">{BOX}{"<include><uri>model://wheel</uri></include>" * 2}</model>'
    (model,) = world_of(tmp_path, body).models
    assert [item.get("name") for item in etree.fromstring(model.text).iter("model")] == ["cart", "wheel", "wheel_0"]


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
    assert ([model.name for model in world.models], findings(world)) == (["ground_plane"], ())


def test_a_users_own_ground_plane_goes_before_the_built_in_one(tmp_path):
    model_file(tmp_path, "ground_plane", f"<static>true</static><pose>0 0 -5 0 0 0</pose>{BOX}")
    (model,) = world_of(tmp_path, "<include><uri>model://ground_plane</uri></include>").models
    assert model.pose.xyz[2] == -5


FUEL = "https://fuel.gazebosim.org/1.0/OpenRobotics/models"


def test_nothing_is_downloaded_and_what_fuel_has_is_one_finding(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("GZ_FUEL_CACHE_PATH", raising=False)
    body = f"<include><uri>{FUEL}/Oak tree</uri></include>\n<include><uri>model://cafe</uri></include>\n"
    meshes = [f"<mesh><uri>{FUEL}/desk/3/files/meshes/{name}.obj</uri></mesh>" for name in ("Desk", "Desk_Col")]
    body += "".join(
        f'<model name="{index}">{BOX.replace("<box><size>1 1 1</size></box>", mesh)}</model>'
        for index, mesh in enumerate(meshes)
    )
    world = world_of(tmp_path, body)
    assert all("<mesh>" not in model.text for model in world.models)
    near, fuel = sorted(world.findings, key=lambda finding: "downloads nothing" in finding.what)
    assert near.what.startswith("these models and packages were not found: cafe. ")
    assert fuel.what.startswith(
        "these models and packages were not found: OpenRobotics/Oak tree, OpenRobotics/desk. Searched: ~/.gz/fuel"
    )
    assert "The twin downloads nothing" in fuel.what
    assert (fuel.kind, fuel.file, fuel.lines) == (Kind.IGNORED, str(tmp_path / "test.world"), (4,))
    assert near.lines == (5,)


def test_a_mesh_that_gazebo_downloaded_before_is_used(tmp_path, monkeypatch):
    monkeypatch.setenv("GZ_FUEL_CACHE_PATH", str(tmp_path / "fuel"))
    desk = tmp_path / "fuel" / "fuel.gazebosim.org" / "openrobotics" / "models" / "desk" / "3" / "meshes"
    desk.mkdir(parents=True)
    (desk / "desk.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    mesh = f"<mesh><uri>{FUEL}/desk/3/files/meshes/desk.obj</uri></mesh>"
    box = BOX.replace("<box><size>1 1 1</size></box>", mesh)
    world = world_of(tmp_path, f'<model name="desk"><static>true</static>{box}</model>')
    assert findings(world) == ()
    assert str(desk / "desk.obj") in world.models[0].text
    world = world_of(tmp_path, f'<model name="desk">{box.replace("desk.obj", "leg.obj")}</model>')
    assert [f"{desk / 'leg.obj'}: the file does not exist" in warning for warning in findings(world)] == [True]


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
    (warning,) = findings(world_of(tmp_path, body))
    assert warning.startswith("these models and packages were not found: cafe, table, tree. ")
    assert str(tmp_path) in warning or "GAZEBO" in warning or "--package-path" in warning


def test_a_mesh_of_a_model_that_is_nowhere_is_named_without_an_include(tmp_path):
    mesh = "<mesh><uri>model://tree/tree.dae</uri></mesh>"
    body = f'<model name="a">{BOX.replace("<box><size>1 1 1</size></box>", mesh)}</model>'
    (warning,) = findings(world_of(tmp_path, body))
    assert warning.startswith("these models and packages were not found: tree. ")


def test_a_mesh_that_an_included_model_lacks_is_named_with_its_file(tmp_path):
    mesh = "<mesh><uri>model://terrain/meshes/hill.stl</uri></mesh>"
    model_file(tmp_path, "terrain", BOX.replace("<box><size>1 1 1</size></box>", mesh))
    warnings = findings(world_of(tmp_path, "<include><uri>model://terrain</uri></include>"))
    assert warnings
    for warning in warnings:
        assert (
            f"left out with its mesh model://terrain/meshes/hill.stl: {tmp_path}/terrain/meshes/hill.stl: " in warning
        )


def test_an_included_file_that_is_broken_leaves_the_rest(tmp_path):
    model_file(tmp_path, "crate").joinpath("crate", "model.sdf").write_text("<sdf><model name='crate'></sdf>")
    world = world_of(tmp_path, f'<include><uri>model://crate</uri></include><model name="a">{BOX}</model>')
    assert [model.name for model in world.models] == ["a"]
    assert "model://crate is not included: " in findings(world)[0]
    assert "not well-formed XML" in findings(world)[0]


def test_merged_links_become_the_models_own(tmp_path):
    model_file(tmp_path, "lid", '<link name="lid"/>')
    include = '<include merge="true"><uri>model://lid</uri><pose>0 0 1 0 0 0</pose></include>'
    (model,) = world_of(tmp_path, f'<model name="box">{BOX}{include}</model>').models
    root = etree.fromstring(model.text)
    assert [link.get("name") for link in root.iterfind("model/link")] == ["link", "lid"]
    frame = root.find("model/frame")
    assert frame.findtext("pose") == "0 0 1 0 0 0"
    assert root.findall("model/link")[1].find("pose").get("relative_to") == frame.get("name")


def test_what_gazebos_reader_lets_pass_is_let_pass_and_lines_stay(tmp_path):
    file = tmp_path / "odd.world"
    text = (
        '<sdf version="1.9"><!-- a -- b\n-->\n<world name="w" gz:x="1"><ign::y/><gravity>0 0 u</gravity></world></sdf>'
    )
    file.write_text(f'\n\n<?xml version="1.0"?>\n{text}')
    assert f"{file}:6: <gravity>" in refusal(read_world, str(file), PackageIndex((), {}))


def test_an_error_in_an_included_model_names_its_own_file_and_line(tmp_path):
    file = model_file(tmp_path, "bad", "\n\n<pose>a b c</pose>" + BOX) / "bad" / "model.sdf"
    (finding,) = world_of(tmp_path, f"<include><uri>{file}</uri></include>").findings
    line = file.read_text().partition("<pose>")[0].count("\n") + 1
    assert (finding.file, finding.lines, finding.what[:6]) == (str(file), (line,), "<pose>")
    file = model_file(tmp_path, "good", BOX) / "good" / "model.sdf"
    (finding,) = world_of(tmp_path, f"<include><uri>{file}</uri>\n<pose>a b c</pose></include>").findings
    assert (finding.file, finding.lines, finding.what[:6]) == (f"{tmp_path}/test.world", (5,), "<pose>")


def test_what_an_include_says_besides_is_a_finding(tmp_path):
    file = model_file(tmp_path, "crate", BOX) / "crate" / "model.sdf"
    world = world_of(tmp_path, f"<include><uri>{file}</uri>\n<self_collide>true</self_collide></include>")
    (finding,) = world.findings
    assert (str(finding), finding.kind) == ("<self_collide> in <include> (test.world:5)", Kind.IGNORED)


@pytest.mark.parametrize("merge", ["", ' merge="true"'])
def test_a_plugin_of_the_included_model_and_one_in_the_include_are_the_models(tmp_path, merge):
    """As libsdformat's parser does: it copies plugins where it merges, and adds those that an include holds."""
    plugin = '<plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"><topic>{}</topic></plugin>'
    model_file(tmp_path, "rover", BOX + plugin.format("own"))
    include = f"<include{merge}><uri>model://rover</uri>{plugin.format('given')}</include>"
    (model,) = world_of(tmp_path, f'<model name="a">{include}</model>' if merge else include).models
    assert [topic.text for topic in etree.fromstring(model.robot.text).iterfind("model/plugin/topic")] == [
        "own",
        "given",
    ]


def test_models_whose_files_are_missing_are_one_line(tmp_path):
    body = "".join(f"\n<include><uri>file:///home/nobody/{name}</uri></include>" for name in ("wall", "door"))
    (line,) = most_telling(world_of(tmp_path, body).findings)
    assert line == (
        "ignored: file:///home/nobody/wall, file:///home/nobody/door is not included: the file does not exist"
        " (test.world:5, 6)"
    )
