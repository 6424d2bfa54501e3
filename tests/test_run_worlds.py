"""Worlds of ``drake_twin.run --world``."""

from pathlib import Path

import pytest
from program_runs import ROVER, summary_of

from drake_twin import Twin
from drake_twin.messages.interface_types import make
from drake_twin.run import main
from drake_twin.scenario.scenario_file import ScenarioFile

CRATE_WORLD = """<sdf version="1.9"><world name="w"><gravity>0 0 -3</gravity>
<physics type="ode"><max_step_size>0.002</max_step_size></physics><gui/>
<include><uri>model://ground_plane</uri></include>
<model name="crate"><pose>3 0 1 0 0 0</pose><link name="l"/></model></world></sdf>"""


@pytest.fixture
def crate_world(tmp_path) -> Path:
    (tmp_path / "crate.world").write_text(CRATE_WORLD)
    return tmp_path / "crate.world"


def test_robots_stand_in_the_world_of_a_file_at_its_own_step(tmp_path, crate_world, capsys):
    result = summary_of(tmp_path, "--robots", 2, "--duration", 0.5, "--world", crate_world)
    assert (result["time_step"], result["steps"]) == (0.002, 250)
    assert all(robot["base_pose"][2] == pytest.approx(0.13, abs=0.01) for robot in result["robots"].values())
    assert result["warnings"] == []
    assert [(item["kind"], item["what"]) for item in result["findings"]] == [("window", "<gui> of the world")]
    assert "window: <gui> of the world (crate.world:2)" in capsys.readouterr().err


def test_a_step_that_is_typed_goes_before_the_worlds(tmp_path, crate_world):
    result = summary_of(tmp_path, ROVER, "--duration", 0.1, "--world", crate_world, "--time-step", 0.001)
    assert result["time_step"] == 0.001


def test_a_world_is_part_of_the_printed_scenario(tmp_path, crate_world, capsys):
    assert main(["--robots", "1", "--world", str(crate_world), "--show-scenario"]) == 0
    text = capsys.readouterr().out
    assert f"world:\n  file: {crate_world}\n" in text
    (tmp_path / "twin.yaml").write_text(text.replace(str(crate_world), "crate.world"))
    assert summary_of(tmp_path, tmp_path / "twin.yaml", "--duration", 0.1)["time_step"] == 0.002


@pytest.mark.parametrize(("name", "what"), [("gone.world", "the world file"), ("shapes.sdf", "only some are built in")])
def test_a_world_that_is_not_there_ends_in_a_paragraph(tmp_path, capsys, name, what):
    assert main(["--robots", "1", "--headless", "--duration", "1", "--world", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert what in error
    assert "Traceback" not in error


GANTRY = """<sdf version="1.9"><world name="w"><gravity>0 0 -10</gravity>
<model name="gantry"><static>true</static><pose>0 0 5 0 0 0</pose><link name="hook"/>
<plugin filename="gz-sim-detachable-joint-system" name="gz::sim::systems::DetachableJoint">
<parent_link>hook</parent_link><child_model>load</child_model><child_link>l</child_link>
<topic>/drop</topic></plugin></model>
<model name="load"><pose>0 0 4 0 0 0</pose><link name="l"/></model></world></sdf>"""


def test_a_static_model_holds_another_one_until_a_message_detaches_it(tmp_path, capsys):
    (tmp_path / "gantry.sdf").write_text(GANTRY)
    assert main([str(tmp_path / "gantry.sdf"), "--show-scenario"]) == 0
    (tmp_path / "twin.yaml").write_text(capsys.readouterr().out)
    twin = Twin(ScenarioFile.read(str(tmp_path / "twin.yaml")).scenario)
    twin.advance_to(0.5)
    assert twin.entities.state("load").position == pytest.approx((0, 0, 4), abs=1e-6)
    twin.publish("/gantry/drop", make("std_msgs/msg/Empty", {}))
    twin.advance_to(1.0)
    assert twin.entities.state("load").position == pytest.approx((0, 0, 4 - 10 * 0.5**2 / 2), abs=0.01)
    assert twin.entities.state("gantry").position == (0, 0, 5)


def test_a_model_that_a_plugin_drives_is_a_robot_beside_the_others(tmp_path, crate_world, capsys):
    plugin = '<plugin filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl"/>'
    shape = '<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>'
    rover = f'<model name="mine"><pose>0 5 0.1 0 0 0</pose><link name="l">{shape}</link>{plugin}</model></world>'
    crate_world.write_text(crate_world.read_text().replace("</world>", rover))
    assert main(["--robots", "1", "--world", str(crate_world), "--headless", "--duration", "0.1", "--topics"]) == 0
    assert "/mine/cmd_vel " in capsys.readouterr().out
    assert main(["--robots", "1", "--world", str(crate_world), "--show-scenario"]) == 0
    text = capsys.readouterr().out
    assert "without_models:\n  - mine" in text or "without_models: [mine]" in text


def test_a_world_with_robots_in_it_runs_by_itself(tmp_path, crate_world):
    plugin = '<plugin filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl"/>'
    shape = '<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>'
    rover = f'<model name="mine"><pose>0 5 0.1 0 0 0</pose><link name="l">{shape}</link>{plugin}</model></world>'
    crate_world.write_text(crate_world.read_text().replace("</world>", rover))
    result = summary_of(tmp_path, crate_world, "--pub", "/mine/cmd_vel", "{linear: {x: 1.0}}", "--duration", 1)
    assert (list(result["robots"]), result["time_step"]) == (["mine"], 0.002)
    assert result["robots"]["mine"]["base_pose"][:2] == pytest.approx([1, 5], abs=0.02)


def test_a_world_without_robots_runs_by_itself(tmp_path, crate_world):
    result = summary_of(tmp_path, crate_world, "--duration", 0.1)
    assert result["robots"] == {}


@pytest.mark.parametrize(
    ("more", "what"),
    [
        (["--robots", "2"], "is a world: it cannot be combined with --world, --robots, --robot or name:=value"),
        (["speed:=1"], "is a world: it cannot be combined with"),
    ],
)
def test_a_world_with_other_robots_is_refused_with_the_way_to_use_it(crate_world, capsys, more, what):
    assert main([str(crate_world), *more, "--headless"]) == 2
    error = capsys.readouterr().err
    assert what in error
    assert f"--world {crate_world} puts it around" in error


def test_a_world_whose_robot_is_absent_is_refused_with_the_line_of_its_include(tmp_path, capsys):
    (tmp_path / "w.sdf").write_text(
        '<sdf version="1.9"><world name="w">\n<include><uri>model://gone</uri></include></world></sdf>'
    )
    assert main([str(tmp_path / "w.sdf"), "--headless", "--duration", "0.01"]) == 2
    said = capsys.readouterr().err
    assert "these models and packages were not found: gone" in said
    assert "(w.sdf:2)" in said
