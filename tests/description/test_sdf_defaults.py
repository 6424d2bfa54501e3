"""A model as Gazebo saves it, with all its elements: those that hold SDF's defaults are no findings, others are."""

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.world_file import read_world
from drake_twin.findings import most_telling

# Written as Gazebo classic 11 saves a model: the elements of each parent, and all at SDF's defaults.
SAVED = """<sdf version="1.7"><model name="r">
<static>0</static><allow_auto_disable>1</allow_auto_disable><self_collide>false</self_collide><enable_wind>0</enable_wind>
<link name="base"><pose>0 0 1 0 0 0</pose><gravity>1</gravity><self_collide>0</self_collide><kinematic>0</kinematic>
<enable_wind>0</enable_wind><velocity_decay><linear>0</linear><angular>0</angular></velocity_decay>
<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>
<visual name="v"><geometry><box><size>1 1 1</size></box></geometry><material><lighting>1</lighting>
<shader type="pixel"><normal_map>__default__</normal_map></shader><emissive>0 0 0 1</emissive>
<specular>0 0 0 1</specular><diffuse>1 0 0 1</diffuse></material>
<transparency>0</transparency><cast_shadows>true</cast_shadows>
<meta><layer>0</layer></meta></visual>
<collision name="c"><laser_retro>0</laser_retro><max_contacts>10</max_contacts><pose>0 0 0 0 -0 0</pose>
<geometry><box><size>1 1 1</size></box></geometry><surface>
<friction><ode><mu>1</mu><mu2>1</mu2><fdir1>0 0 0</fdir1><slip1>0</slip1><slip2>0</slip2></ode>
<torsional><coefficient>1</coefficient><patch_radius>0</patch_radius><surface_radius>0</surface_radius>
<use_patch_radius>1</use_patch_radius><ode><slip>0</slip></ode></torsional></friction>
<bounce><restitution_coefficient>0</restitution_coefficient><threshold>1e+06</threshold></bounce>
<contact><collide_without_contact>0</collide_without_contact>
<collide_without_contact_bitmask>1</collide_without_contact_bitmask><collide_bitmask>65535</collide_bitmask>
<ode><soft_cfm>0</soft_cfm><soft_erp>0.2</soft_erp><kp>1e+12</kp><kd>1</kd><max_vel>0.01</max_vel><min_depth>0</min_depth></ode>
<bullet><split_impulse>1</split_impulse><split_impulse_penetration_threshold>-0.01</split_impulse_penetration_threshold>
<soft_cfm>0</soft_cfm><soft_erp>0.2</soft_erp><kp>1e+12</kp><kd>1</kd></bullet></contact></surface></collision></link>
<link name="arm"><inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
<joint name="j" type="revolute"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>
<limit><lower>-1</lower><upper>1</upper><stiffness>1e+08</stiffness><dissipation>1</dissipation></limit>
<dynamics><damping>0</damping><friction>0</friction></dynamics></axis>
<physics><ode><limit><cfm>0</cfm><erp>0.2</erp></limit><suspension><cfm>0</cfm><erp>0.2</erp></suspension></ode></physics></joint>
</model></sdf>"""


def findings_of(folder, text):
    file = folder / "r.sdf"
    file.write_text(text)
    return load_robot_model(str(file), PackageIndex()).findings


def test_what_gazebo_saves_unchanged_is_no_finding(tmp_path):
    assert [str(finding) for finding in findings_of(tmp_path, SAVED)] == []


def test_what_gazebo_saves_unchanged_is_no_finding_in_a_world(tmp_path):
    file = tmp_path / "w.sdf"
    world = SAVED.replace("<model", "<world name='w'><model").replace("</model>", "</model></world>")
    file.write_text(world)
    assert [str(finding) for finding in read_world(str(file), PackageIndex()).findings] == []
    file.write_text(world.replace("<self_collide>false", "<self_collide>true"))
    assert [finding.what for finding in read_world(str(file), PackageIndex()).findings] == [
        "r: <self_collide> is not used"
    ]


@pytest.mark.parametrize(
    ("default", "value", "message"),
    [
        ("<allow_auto_disable>1", "<allow_auto_disable>0", "<allow_auto_disable> in <model>"),
        ("<kinematic>0", "<kinematic>true", "<kinematic> in <link>"),
        ("<linear>0", "<linear>0.1", "<velocity_decay> in <link>"),
        ("<transparency>0", "<transparency>0.5", "<transparency> in <visual>"),
        ("<threshold>1e+06", "<threshold>0.1", "<bounce> in <surface>"),
        ("<coefficient>1", "<coefficient>0.3", "<torsional> in <friction>"),
        ("<stiffness>1e+08", "<stiffness>100", "<stiffness> in <limit>"),
        ("<cfm>0", "<cfm>0.001", "<physics> in <joint>"),
        ("<restitution_coefficient>0", "<restitution_coefficient>0.8", "restitution_coefficient of base"),
        ("<kp>1e+12", "<kp>1e+5", "kp of base: without effect"),
        ("<collide_bitmask>65535", "<collide_bitmask>2", "collide_bitmask of base"),
    ],
)
def test_what_differs_is_one_finding(tmp_path, default, value, message):
    (finding,) = findings_of(tmp_path, SAVED.replace(default, value, 1))
    assert finding.what.startswith(message)
    assert finding.lines


def test_elements_that_nothing_reads_are_one_line_of_a_run_and_findings_of_their_own(tmp_path):
    changed = SAVED.replace("<linear>0", "<linear>1").replace("<kinematic>0", "<kinematic>1")
    changed = changed.replace("<allow_auto_disable>1", "<allow_auto_disable>0")
    found = findings_of(tmp_path, changed)
    assert [finding.what for finding in found] == [
        "<allow_auto_disable> in <model>",
        *(f"<{tag}> in <link>" for tag in ("kinematic", "velocity_decay")),
    ]
    assert most_telling(found) == [
        "ignored: <allow_auto_disable> in <model> (r.sdf:2); <kinematic>, <velocity_decay> in <link> (r.sdf:3, 4)",
    ]
