"""Arguments of a launch file as varied values."""

import pytest

from drake_twin import Twin, run, sweep
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.errors import InputError
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.sweeps.launched import LaunchFile
from drake_twin.sweeps.results import read_table

URDF = """<robot name="box"><link name="box"><inertial><mass value="$(arg mass)"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
LAUNCH = """<launch>
<arg name="speed" default="slow"><choice value="slow"/><choice value="fast"/></arg>
<arg name="height" default="1.0"/>
<node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="robot_description" value="$(command 'xacro {file} mass:=2')"/></node>
<node pkg="ros_gz_sim" exec="create" args="-name box -topic robot_description -z $(var height)"/>
{more}</launch>"""


@pytest.fixture
def launch(tmp_path, monkeypatch):
    """A launch file that drops a box from a height."""
    xacro = '<robot name="box" xmlns:xacro="http://ros.org/xacro"><xacro:arg name="mass" default="1"/>'
    (tmp_path / "box.xacro").write_text(URDF.replace('<robot name="box">', xacro))
    file = tmp_path / "box.launch.xml"
    file.write_text(LAUNCH.format(file=tmp_path / "box.xacro", more=""))
    monkeypatch.chdir(tmp_path)
    return file


def test_a_row_is_a_run_of_the_launch_file_with_its_arguments_and_runs_again_to_the_same_bits(launch, capsys):
    arguments = [launch.name, "--vary", "launch.height=0.6,0.7,0.8", "--vary", "box.box.mass=1,2"]
    assert sweep.main([*arguments, "--duration", "0.05", "--out", "t.csv", "--workers", "1"]) == 0
    _, rows = read_table(launch.parent / "t.csv")
    assert [(row["launch.height"], row["box.box.mass"]) for row in rows] == [
        (height, mass) for height in (0.6, 0.7, 0.8) for mass in (1.0, 2.0)
    ]
    for row in rows:
        scenario = launch_file_scenario(launch, {"height": f"{row['launch.height']:g}"}).scenario
        with Twin(scenario) as twin:
            twin.entities.set_values({"box.box.mass": row["box.box.mass"]})
            twin.advance_to(0.05)
            assert twin.state_sha256() == row["state_sha256"]
    assert len({row["id"] for row in rows}) == len({row["state_sha256"] for row in rows}) == 6
    assert run.main(["--headless", "--episode", "t.csv:3"]) == 0
    assert "row 3: the same state as in the table, to the last bit" in capsys.readouterr().err


def test_arguments_of_the_command_line_hold_for_all_episodes_and_text_is_a_value(launch):
    found = LaunchFile(str(launch), (("height", "0.75"),))
    assert found.scenario({"launch.speed": "fast"}).robots[0].xyz == (0.0, 0.0, 0.75)
    assert LaunchFile.from_plain(found.as_plain()) == found
    varied = LaunchFile(str(launch)).scenario({"launch.height": 0.1 + 0.2, "friction": 1.0})
    plain = launch_file_scenario(launch, {"height": "0.3"}).scenario
    assert scenario_to_yaml(varied) == scenario_to_yaml(plain)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("box.launch.xml --vary launch.hight=1,2", "launch.hight: no file declares this argument. Did you mean"),
        ("box.launch.xml --vary launch.speed=slow,fats", "fats"),
        ("box.launch.xml height:=2 --vary launch.height=1,2", "the command line has height:=2 already"),
        ("box.xacro --vary launch.height=1,2", "not a launch file, so that it has no launch arguments"),
        ("box.launch.xml --vary lunch.height=1,2", "nothing of this name to vary"),
    ],
)
def test_an_argument_that_cannot_be_used_is_refused_before_anything_runs(launch, capsys, arguments, message):
    assert sweep.main([*arguments.split(), "--out", "t.csv", "--workers", "1"]) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert not (launch.parent / "t.csv").exists()


def test_a_launch_file_that_starts_nodes_for_a_value_is_refused(launch):
    node = '<arg name="more"/><node pkg="topic_tools" exec="relay" args="/a /b" if="$(var more)"/>'
    launch.write_text(LAUNCH.format(file=launch.parent / "box.xacro", more=node))
    LaunchFile(str(launch)).scenario({"launch.more": "false"})
    with pytest.raises(InputError, match="has node programs"):
        LaunchFile(str(launch)).scenario({"launch.more": "true"})
