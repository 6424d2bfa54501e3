"""Controllers and sensors that are no part of drake_twin: each is one file, imported or named by ``--plugin``."""

import json
import re
import shutil
import subprocess
import sys
from math import cos, pi
from pathlib import Path

import numpy as np
import pytest
from conftest import ROVER

from drake_twin import CommandError, InputError, Robot, Snapshot, TwinBuilder

FOLDER = Path(__file__).parent
ARM = """<robot name="arm"><link name="world"/><link name="a"><inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/>
<limit effort="500" velocity="50"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="j"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>
{more}</robot>"""
YAML = """
controller_manager: {ros__parameters: {wave: {type: others_pkg/Wave}}}
wave: {ros__parameters: {joint: j, amplitude: 2.0}}
"""
DROP = """<robot name="stone"><link name="stone"><inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo reference="stone"><sensor name="height" type="height"><topic>altitude</topic>
<update_rate>100</update_rate><height><vertical_position/></height></sensor></gazebo></robot>"""


@pytest.fixture
def others(monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    import height_sensor  # noqa: F401  # registers itself, as --plugin does
    import wave_controller  # noqa: F401


@pytest.fixture
def files(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM.format(more=""))
    (tmp_path / "controllers.yaml").write_text(YAML)
    return tmp_path


def waving(files):
    return TwinBuilder().robot("arm", files / "arm.urdf").controller("arm", "wave", "others_pkg/Wave", {"joint": "j"})


def swings(position, amplitude=2.0, time=0.5):
    """The integral of the wave, but for the servo's lag and an update's hold of 10 ms."""
    assert position == pytest.approx(amplitude * (1 - cos(2 * pi * time)) / (2 * pi), abs=0.03)


def test_a_parameters_file_names_its_type(others, files):
    twin = TwinBuilder().robot("arm", files / "arm.urdf", controllers=files / "controllers.yaml").build()
    twin.advance_to(0.5)
    swings(twin.robot_state("arm").positions[0])
    assert twin.findings == ()
    assert "others_pkg/Wave" in twin.control.manager("arm").list_controller_types()


def test_the_builder_adds_it_with_parameters_and_its_topic_works(others, files):
    builder = TwinBuilder().robot("arm", files / "arm.urdf")
    twin = builder.controller("arm", "wave", "others_pkg/Wave", {"joint": "j", "amplitude": 0.0}).build()
    assert twin.graph.topics()["/arm/wave/offset"] == "std_msgs/msg/Float64MultiArray"
    twin.publish("/arm/wave/offset", [3.0])
    twin.advance_to(1.0)
    assert twin.robot_state("arm").velocities[0] == pytest.approx(3.0, rel=1e-3)
    with pytest.raises(CommandError, match="the offset is one number"):
        twin.publish("/arm/wave/offset", [3.0, 1.0])


def test_its_parameters_are_checked_with_the_place_where_they_stand(others, files):
    (files / "controllers.yaml").write_text(YAML.replace("2.0", "-2.0"))
    with pytest.raises(InputError, match=r"controllers\.yaml:3: wave\.ros__parameters\.amplitude: -2\.0 is below 0"):
        TwinBuilder().robot("arm", files / "arm.urdf", controllers=files / "controllers.yaml").build()


def test_its_memory_is_saved_under_its_own_name(others, files):
    builder = (
        TwinBuilder().robot("arm", files / "arm.urdf").controller("arm", "wave", "others_pkg/Wave", {"joint": "j"})
    )
    twin = builder.build()
    twin.advance_to(0.3)
    twin.snapshot().save(files / "state.json")
    assert "others_pkg/WaveMemory@1" in (files / "state.json").read_text()
    other = builder.build()
    other.restore(Snapshot.load(files / "state.json"))
    twin.advance_to(0.7)
    other.advance_to(0.7)
    assert twin.state_sha256() == other.state_sha256()


def test_a_scenario_with_an_added_controller_is_written_and_read(others, files):
    from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

    builder = (
        TwinBuilder().robot("arm", files / "arm.urdf").controller("arm", "wave", "others_pkg/Wave", {"joint": "j"})
    )
    scenario = builder.scenario()
    assert ScenarioFile(scenario_to_yaml(scenario), "scenario.yaml").scenario == scenario
    with pytest.raises(InputError, match="unknown robot 'leg'"):
        builder.controller("leg", "wave", "others_pkg/Wave")


def run(*arguments, folder=None, path=(), before=""):
    program = f"import sys; sys.path[:0] = {[str(p) for p in path]!r}; {before}\n"
    program += "from drake_twin.run import main; sys.exit(main())"
    command = [sys.executable, "-c", program, *map(str, arguments), "--headless", "--duration", "0.5"]
    return subprocess.run([*command, "--summary", folder / "out.json"], capture_output=True, text=True, check=False)


def final_position(folder):
    (robot,) = json.loads((folder / "out.json").read_text())["robots"].values()
    return robot["positions"][robot["joints"].index("j")]


@pytest.mark.parametrize("how", ["module", "file"])
def test_the_command_line_finds_it(files, how):
    (files / "scenario.yaml").write_text("robots:\n- {name: arm, model: arm.urdf, controllers: [controllers.yaml]}\n")
    more, path = [], [FOLDER]
    if how == "module":
        more = ["--plugin", "wave_controller"]
    else:
        more, path = ["--plugin", FOLDER / "wave_controller.py"], []
    result = run(files / "scenario.yaml", *more, folder=files, path=path)
    assert result.returncode == 0, result.stderr
    assert "not supported" not in result.stderr
    swings(final_position(files))


def test_in_the_twin_itself_a_new_wire_and_a_new_substitution_are_one_file_each(files):
    """The files are put beside the twin's own, and nothing else names them."""
    for folder in ("wires/kinds", "ros2/launch/substitutions"):
        (files / folder).mkdir(parents=True)
    shutil.copy(FOLDER / "lines_wire.py", files / "wires/kinds")
    shutil.copy(FOLDER / "half_substitution.py", files / "ros2/launch/substitutions")
    create = 'pkg="ros_gz_sim" exec="create" args="-name arm -file $(dirname)/arm.urdf -x $(half 3)"'
    (files / "x.launch.xml").write_text(f"<launch><node {create}/></launch>")
    beside = "import drake_twin.wires.kinds, drake_twin.ros2.launch.substitutions as substitutions;"
    beside += f"drake_twin.wires.kinds.__path__.append({str(files / 'wires/kinds')!r});"
    beside += f"substitutions.__path__.append({str(files / 'ros2/launch/substitutions')!r})"
    result = run(files / "x.launch.xml", "--lines", files / "lines.txt", folder=files, before=beside)
    assert result.returncode == 0, result.stderr
    assert " /clock 12" in (files / "lines.txt").read_text()
    assert "xyz: [1.5, 0.0, 0.0]" in run(files / "x.launch.xml", "--show-scenario", folder=files, before=beside).stdout


def test_without_it_the_type_is_said_to_be_unknown(files):
    (files / "scenario.yaml").write_text("robots:\n- {name: arm, model: arm.urdf, controllers: [controllers.yaml]}\n")
    result = run(files / "scenario.yaml", folder=files)
    assert "type others_pkg/Wave is not supported" in result.stderr


def test_a_sensor_of_others_publishes_what_it_measures(others, files):
    (files / "stone.urdf").write_text(DROP)
    twin = TwinBuilder().robot("stone", files / "stone.urdf", xyz=(0, 0, 50.0)).build()
    assert [finding.what for finding in twin.findings if "height" in finding.what] == []
    assert twin.graph.topics()["/stone/altitude"] == "std_msgs/msg/Float64"
    heights = []
    twin.subscribe("/stone/altitude", lambda message: heights.append(message.data))
    twin.advance_to(1.0)
    assert len(heights) == 100
    assert heights[50] == pytest.approx(-9.81 * 0.5**2 / 2, rel=0.01)  # as a stone falls


def test_a_kind_is_a_finding_where_nobody_has_one(files):
    (files / "stone.urdf").write_text(DROP.replace('type="height"', 'type="barometer"'))
    twin = TwinBuilder().robot("stone", files / "stone.urdf", xyz=(0, 0, 50.0)).build()
    (text,) = [finding.what for finding in twin.findings if "barometer" in finding.what]
    assert text.startswith("sensor 'height' of type barometer on 'stone'")


def test_two_classes_of_one_type_are_refused(others):
    from wave_controller import Wave

    from drake_twin.controllers import controller

    with pytest.raises(InputError, match=r"type 'others_pkg/Wave' is registered by wave_controller and by"):

        @controller("others_pkg/Wave")
        class Other(Wave):
            pass


def test_a_spawned_robot_may_have_it_too(others, files):
    twin = TwinBuilder().robot("rover", ROVER, xyz=(0, 0, 0.13)).build()
    added = {"wave": {"type": "others_pkg/Wave", "joint": "j", "amplitude": 2.0}}
    twin.entities.spawn(Robot("arm", str(files / "arm.urdf"), added_controllers=added))
    twin.advance_to(0.5)
    swings(twin.robot_state("arm").positions[0])
    assert np.isfinite(twin.robot_state("rover").positions).all()


def test_a_class_without_a_dataclass_of_parameters_is_refused(others):
    from drake_twin.controllers import controller
    from drake_twin.controllers.base_controller import Controller

    with pytest.raises(InputError, match=r"type 'others_pkg/Bare': .*Bare needs a dataclass Parameters"):

        @controller("others_pkg/Bare")
        class Bare(Controller):
            pass


FAULTY = """
from dataclasses import dataclass
from drake_twin.controllers import Interface, PeriodicController, Update, controller
@dataclass(frozen=True)
class Parameters:
    joint: str
@controller("others_pkg/Faulty")
class Faulty(PeriodicController):
    Parameters = Parameters
    @classmethod
    def claimed_interfaces(cls, parameters, description):
        return (Interface(parameters.joint, "velocity"),)
    def __init__(self, setup):
        super().__init__(setup)
        {init}
    def start(self, context):
        {start}
    def update(self, context, time, memory):
        return {update}
"""
FAULTS = {
    "init": ("1 / 0", "pass", "Update(None, [0.0])", r"faulty\.py:15"),
    "start": ("pass", "return {}[3]", "Update(None, [0.0])", r"KeyError: 3 \(.*faulty\.py:17\)"),
    "update": ("pass", "return None", "self.gian", r"AttributeError: .*'gian'.* \(.*faulty\.py:19\)"),
    "too many": ("pass", "return None", "Update(None, [0.0, 1.0])", "ValueError: 2 commands for 1 interfaces"),
}


@pytest.mark.parametrize("which", FAULTS)
def test_an_error_in_somebody_elses_controller_is_said_with_its_line_and_counted(files, which):
    init, start, update, expected = FAULTS[which]
    (files / "faulty.py").write_text(FAULTY.format(init=init, start=start, update=update))
    (files / "controllers.yaml").write_text(
        "controller_manager: {ros__parameters: {f: {type: others_pkg/Faulty}}}\nf: {ros__parameters: {joint: j}}\n"
    )
    (files / "scenario.yaml").write_text("robots:\n- {name: arm, model: arm.urdf, controllers: [controllers.yaml]}\n")
    result = run(files / "scenario.yaml", "--plugin", files / "faulty.py", "--strict", folder=files)
    assert re.search(expected, result.stderr), result.stderr
    assert "Traceback" not in result.stderr
    assert result.returncode == (2 if which == "init" else 1)
    if which != "init":
        (finding,) = json.loads((files / "out.json").read_text())["findings"]
        assert finding["kind"] == "failed"


def test_a_module_in_the_present_folder_is_found_by_both_programs(files):
    (files / "scenario.yaml").write_text("robots:\n- {name: arm, model: arm.urdf, controllers: [controllers.yaml]}\n")
    shutil.copy(FOLDER / "wave_controller.py", files)
    for program in ("from drake_twin.run import main", "from drake_twin.__main__ import main"):
        more = [] if "run" in program else ["run"]
        code = f"import sys; sys.path.remove(''); {program}; sys.exit(main())"  # as in an installed script
        command = [sys.executable, "-c", code, *more, "scenario.yaml", "--plugin", "wave_controller", "--headless"]
        result = subprocess.run([*command, "--duration", "0.1"], cwd=files, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr


def test_a_misspelt_type_is_named_with_its_line_and_the_closest_one(files):
    (files / "controllers.yaml").write_text(
        "controller_manager:\n  ros__parameters:\n    v:\n"
        "      type: velocity_controllers/JointGroupVelocityControler\n"
        "v:\n  ros__parameters: {joints: [j]}\n"
    )
    twin = TwinBuilder().robot("arm", files / "arm.urdf", controllers=files / "controllers.yaml").build()
    (finding,) = twin.findings
    assert "did you mean 'velocity_controllers/JointGroupVelocityController'?" in finding.what
    assert finding.lines == (4,)
    with pytest.raises(
        InputError, match=r"nothing listens to '/arm/v/commands' \(arm: controller v: type .*yaml:4\)\)"
    ):
        twin.publish("/arm/v/commands", [1.0])
