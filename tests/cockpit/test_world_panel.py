"""The world's tree and the details of what is selected, against what the files and the twin say."""

import json

import pytest
from conftest import ARM
from fake_page import FakePage
from world_with_crate import CRATE_AT, rover_and_crate

from drake_twin import TwinBuilder
from drake_twin.cockpit import protocol
from drake_twin.cockpit.world_panel import WorldPanel
from drake_twin.cockpit.world_tree import every_node, world_tree
from drake_twin.scenario import Robot, World


@pytest.fixture
def twin(tmp_path):
    return rover_and_crate(tmp_path).build()


def look(panel, node, version=1):
    panel.ask({"do": "Look", "version": version, "node": node})


def rows(panel, node):
    """Section and label → values and text of a node's details."""
    look(panel, node)
    found = panel.state()["details"][node]
    return {
        (section["title"], row["label"]): (*row["values"], *filter(None, (row["unit"], row["text"])))
        for section in found["sections"]
        for row in section["rows"]
    }


def test_the_tree_has_everything_once_each_below_what_it_belongs_to(twin):
    tree = world_tree(twin)
    assert [node.id for node in tree] == [
        "robot:rover::rover",
        "model:ramp::ramp",
        "model:crate::crate",
        "ground:world::ground",
        "light:world::point 1",
    ]
    (base,) = tree[0].children
    assert base.id == "link:rover::rover_base_link"
    assert [joint.kind for joint in base.children] == ["joint"] * 4
    assert [joint.children[0].name for joint in base.children] == [
        f"rover_{end}_{side}_wheel" for end in ("front", "rear") for side in ("left", "right")
    ]
    ids = [node.id for node in every_node(tree)]
    assert len(set(ids)) == len(ids)
    arm = TwinBuilder().robot("arm", ARM).build()
    description = arm.built.plans[0].description
    names = [node.name for node in every_node(world_tree(arm)) if node.kind in ("link", "joint")]
    assert sorted(names) == sorted([*description.links, *(joint.name for joint in description.joints)])


def test_every_path_is_one_that_the_scene_draws(twin):
    it = FakePage(twin)
    it.cockpit.draw()
    drawn = it.cockpit._scene.everything().paths()
    for node in every_node(world_tree(twin)):
        if node.kind not in ("light", "sensor"):
            assert node.paths, node.id
        for path in node.paths:
            assert any(f"{each}/".startswith(f"/twin/{path}/") for each in drawn), path
    it.cockpit.close()


def test_a_link_shows_its_pose_its_mass_and_its_shapes(twin):
    panel = WorldPanel(twin)
    found = rows(panel, "link:crate::link")
    assert found["Pose and twist in the world", "Position"] == (*CRATE_AT, "m")
    assert found["Mass", "Mass"] == (2.0, "kg")
    assert found["Mass", "Moments of inertia"] == (0.053, 0.053, 0.053, "kg·m²")
    assert found["Collision shapes", "Box 0.4 × 0.4 × 0.4 m"][0].startswith("touches: ")
    twin.entities.set_state("crate", linear=(0.1, 0, 0), angular=(0, 0, 0.2))
    found = rows(panel, "model:crate::crate")
    assert found["Pose and twist in the world", "Velocity"] == (0.1, 0, 0, "m/s")
    assert found["Pose and twist in the world", "Angular velocity"] == (0, 0, 0.2, "rad/s")


def test_a_static_model_and_a_light_show_what_their_file_says(twin):
    panel = WorldPanel(twin)
    found = rows(panel, "model:ramp::ramp")
    assert found["Pose", "Position"] == (1, 2, 0.05, "m")
    assert found["Collision shapes", "Box 1 × 1 × 0.1 m"][0].endswith("friction 0.5")
    assert found["Model", "File"][0].endswith("crates.sdf:3")
    found = rows(panel, "light:world::point 1")
    assert found["Light", "Position"] == (1, 2, 3, "m")
    assert found["Light", "Color"] == (1, 0.5, 0)


def test_a_joint_shows_its_state_its_limits_and_who_commands_it():
    twin = TwinBuilder().robot("arm", ARM).build()
    panel = WorldPanel(twin)
    twin.entities.set_joint_positions("arm", {"joint_2": 0.3})
    found = rows(panel, "joint:arm::joint_2")
    joint = twin.built.plans[0].description.joints_by_name["joint_2"]
    assert found["State", "Position"] == (0.3, "rad")
    assert found["Joint", "Highest position"] == (pytest.approx(joint.limits.upper, abs=1e-6), "rad")
    assert found["Joint", "Links"] == (f"{joint.parent} → {joint.child}",)
    assert found["Controllers", "forward_velocity_controller"] == ("active",)
    twin.control.manager("arm").switch_controller(deactivate=["forward_velocity_controller"])
    assert rows(panel, "joint:arm::joint_2")["Controllers", "forward_velocity_controller"] == ("inactive",)


def test_a_robot_shows_its_findings(tmp_path):
    (tmp_path / "odd.urdf").write_text(
        '<robot name="odd"><link name="base"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<gazebo><plugin filename="libunknown.so" name="unknown"/></gazebo></robot>'
    )
    twin = TwinBuilder().robot("odd", tmp_path / "odd.urdf", xyz=(0, 0, 1)).build()
    found = rows(WorldPanel(twin), "robot:odd::odd")
    assert {label for title, label in found if title == "Findings"} == {str(item.kind) for item in twin.findings}
    assert any("unknown" in str(value) for (title, _), value in found.items() if title == "Findings")


def test_a_sensor_stands_below_its_link_and_shows_its_place_and_topic(tmp_path):
    (tmp_path / "seeing.urdf").write_text(
        '<robot name="seeing"><link name="base"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<gazebo reference="base"><sensor name="feel" type="imu"><pose>0.1 0 0.2 0 0 0</pose>'
        "<update_rate>50</update_rate></sensor></gazebo></robot>"
    )
    twin = TwinBuilder().robot("seeing", tmp_path / "seeing.urdf", xyz=(0, 0, 1)).build()
    assert [node.id for node in world_tree(twin)[0].children[0].children] == ["sensor:seeing::base/feel"]
    found = rows(WorldPanel(twin), "sensor:seeing::base/feel")
    assert found["Sensor", "Position"] == (0.1, 0, 0.2, "m")
    assert found["Sensor", "Rate"] == (50, "Hz")
    assert "sensor_msgs/msg/Imu" in {value[0] for (title, _), value in found.items() if title == "Topics"}


def test_a_sensor_of_a_model_of_the_world_stands_below_the_model(tmp_path):
    (tmp_path / "hall.sdf").write_text(
        '<sdf version="1.9"><world name="hall"><model name="post"><static>true</static><pose>3 0 1 0 0 0</pose>'
        '<link name="link"><visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry></visual>'
        '<sensor name="eye" type="camera"><update_rate>5</update_rate><camera><horizontal_fov>1</horizontal_fov>'
        "<image><width>8</width><height>8</height></image><clip><near>0.1</near><far>9</far></clip></camera></sensor>"
        "</link></model></world></sdf>"
    )
    twin = TwinBuilder(world=World(file=str(tmp_path / "hall.sdf"), ground=True)).robot("arm", ARM).build()
    (post,) = [node for node in world_tree(twin) if node.name == "post"]
    assert [node.id for node in post.children] == ["sensor:post::link/eye"]
    found = rows(WorldPanel(twin), "sensor:post::link/eye")
    assert found["Sensor", "Rate"] == (5, "Hz")
    assert found["Sensor", "Simulated"] == ("yes",)
    assert "sensor_msgs/msg/Image" in {value[0] for (title, _), value in found.items() if title == "Topics"}


def test_the_tree_is_sent_to_who_lacks_it_and_nothing_is_read_for_nobody(twin):
    panel = WorldPanel(twin)
    assert panel.state() is None
    look(panel, "", version=0)
    state = panel.state()
    assert state["version"] == 1
    assert state["tree"]
    assert panel.state()["tree"] is None  # once for each look: it is large
    panel = WorldPanel(twin)
    look(panel, "")
    assert panel.state()["tree"] is None
    twin.entities.spawn(Robot("second", twin.scenario.robots[0].model, xyz=(0, -2, 0.13)))
    assert [node["name"] for node in panel.state()["tree"]][:2] == ["rover", "second"]
    for _ in range(60):
        panel.state()
    assert panel.state() is None  # the tab is gone


def test_a_wrong_request_is_a_message_on_the_page(twin):
    it = FakePage(twin)
    for data in (1, {}, {"do": "Look"}, {"do": "Look", "version": True, "node": ""}, {"do": "Gone"}):
        it.ask(protocol.AskPanel("world", json.dumps(data)))
        assert it.state["panels"]["world"] is None
        assert "of the panel of the world" in it.messages[-1][1]
    it.ask(protocol.AskPanel("world", json.dumps({"do": "Look", "version": 1, "node": "robot:nobody::nobody"})))
    assert it.state["panels"]["world"]["details"] == {}
    it.cockpit.close()


def do(it, what, **fields):
    it.ask(protocol.AskPanel("world", json.dumps({"do": what, **fields})))


def test_edits_are_those_of_the_twin_and_undo_returns_to_the_moment_before_each(twin):
    it = FakePage(twin)
    twin.advance_to(0.5)
    before = twin.state_sha256()
    do(it, "Look", version=0, node="model:ramp::ramp")
    details = it.state["panels"]["world"]["details"]["model:ramp::ramp"]
    assert (details["edits"], details["xyz"], details["rpy"]) == (
        ["Place", "Duplicate", "Remove"],
        [1, 2, 0.05],
        [0, 0, 0],
    )
    do(it, "Place", entity="ramp", xyz=[3, 3, 0.05], rpy=[0, 0, 0.5])
    assert twin.built.world_file.models[0].pose.xyz == (3, 3, 0.05)
    do(it, "Remove", entity="crate")
    assert [model.name for model in twin.built.world_file.models] == ["ramp"]
    do(it, "Duplicate", entity="rover")
    assert twin.robots == ("rover", "rover_2")
    first, second = (twin.entities.state(name).position for name in twin.robots)
    assert second[1] - first[1] > 0.5  # the rover is 0.47 m wide
    assert twin.built.plans[1].robot.topic_namespace == "/rover_2"
    do(it, "Duplicate", entity="ramp")
    assert [(model.name, model.pose.xyz) for model in twin.built.world_file.models] == [
        ("ramp_2", (3, 4, 0.05)),
        ("ramp", (3, 3, 0.05)),
    ]
    twin.advance_to(1.0)
    for what in (
        "duplicate ramp at 0.50 s",
        "duplicate rover at 0.50 s",
        "delete crate at 0.50 s",
        "move ramp at 0.50 s",
    ):
        assert it.state["panels"]["world"]["undo"] == what
        do(it, "Undo")
    assert it.state["panels"]["world"]["undo"] == ""
    assert twin.state_sha256() == before
    assert twin.robots == ("rover",)
    do(it, "Undo")
    assert it.state
    assert it.messages[-1] == ("error", "no edit is left to undo.")
    it.cockpit.close()


def test_an_edit_that_is_refused_is_a_message_and_nothing_to_undo(twin):
    it = FakePage(twin)
    do(it, "Look", version=0, node="")
    for fields, what in (
        ({"do": "Remove", "entity": "sun"}, "Entity [sun] does not exist"),
        ({"do": "Duplicate", "entity": "sun"}, "unknown robot 'sun'. Valid: rover"),
        ({"do": "Place", "entity": "sun", "xyz": [0, 0, 0], "rpy": [0, 0, 0]}, "Entity [sun] does not exist"),
    ):
        do(it, fields.pop("do"), **fields)
        assert it.state["panels"]["world"]["undo"] == ""
        assert what in it.messages[-1][1]
    it.cockpit.close()
