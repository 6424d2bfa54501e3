"""SDF robots that take links from other files by ``<include merge="true">``, as drones' models do."""

import pytest
from sdf_worlds import write

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.errors import InputError
from drake_twin.findings import Weight

BASE = """<model name="frame_of_drone"><pose>0 0 0.5 0 0 0</pose>
<link name="body"><inertial><mass>1</mass></inertial>
  <sensor name="imu" type="imu"><update_rate>50</update_rate></sensor></link>
<link name="rotor"><pose>0.1 0 0 0 0 0</pose><inertial><mass>0.1</mass></inertial></link>
<joint name="spin" type="revolute"><parent>body</parent><child>rotor</child><axis><xyz>0 0 1</xyz></axis></joint>
<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">
  <joint_name>spin</joint_name></plugin>
</model>"""
DRONE = """<model name="drone">
<!-- <include merge="true"><uri>model://nothing</uri></include> -->
<include merge="true">
  <uri>{}</uri>
  <pose>0 0 1 0 0 0</pose>
</include>
<link name="leg"><inertial><mass>0.1</mass></inertial></link>
<joint name="mount" type="fixed"><parent>body</parent><child>leg</child></joint>
<joint name="bad" type="screwed"><parent>leg</parent><child>foot</child></joint>
<link name="foot"><inertial><mass>0.1</mass></inertial></link>
</model>"""


def drone(tmp_path, address="model://base"):
    write(tmp_path / "models" / "base", "model.sdf", BASE)
    file = write(tmp_path / "models" / "drone", "model.sdf", DRONE.format(address))
    return load_robot_model(str(file), PackageIndex((), {"GZ_SIM_RESOURCE_PATH": str(tmp_path / "models")}))


@pytest.mark.parametrize("address", ["model://base", "base"])
def test_what_a_file_includes_by_merging_is_its_own(tmp_path, address):
    model = drone(tmp_path, address)
    described = model.description
    assert set(described.links) == {"body", "rotor", "leg", "foot"}
    assert {joint.name for joint in described.joints} == {"spin", "mount", "bad"}
    assert [sensor.name for sensor in described.sensors] == ["imu"]
    assert [plugin.name for plugin in described.plugins] == ["gz::sim::systems::JointController"]
    assert described.root_pose.xyz == pytest.approx((0, 0, 1))  # the include's pose takes the place of the model's
    spin = described.joints_by_name["spin"]
    assert spin.origin.xyz == pytest.approx((0.1, 0, 0))


def test_its_own_elements_keep_their_lines(tmp_path):
    write(tmp_path / "models" / "base", "model.sdf", BASE)
    text = DRONE.format("model://base").replace("<mass>0.1</mass>", "<mass>heavy</mass>", 1)
    file = write(tmp_path / "models" / "drone", "model.sdf", text)
    model = load_robot_model(str(file), PackageIndex((), {"GZ_SIM_RESOURCE_PATH": str(tmp_path / "models")}))
    assert [finding.lines for finding in model.findings if "heavy" in finding.what] == [(9,)]


def test_a_part_that_is_not_found_is_lost_and_said_with_its_line(tmp_path):
    text = DRONE.format("model://nowhere").replace("body", "foot").replace("bad", "good").replace("screwed", "fixed")
    text = text.replace('<joint name="mount" type="fixed"><parent>foot</parent><child>leg</child></joint>', "")
    file = write(tmp_path, "drone.sdf", text)
    model = load_robot_model(str(file), PackageIndex((), {}))
    (lost,) = (finding for finding in model.findings if finding.weight is Weight.LOST)
    assert "nowhere" in lost.what
    assert (lost.file, lost.lines) == (str(file), (5,))


def test_a_model_that_is_nothing_but_a_missing_one_says_what_is_missing(tmp_path):
    include = "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Bird/4</uri></include>"
    file = write(tmp_path, "bird.sdf", f"<model name='bird'>\n{include}</model>")
    with pytest.raises(
        InputError, match=r"the model is not included: OpenRobotics/Bird: searched .*gz fuel"
    ) as refused:
        load_robot_model(str(file), PackageIndex((), {}))
    assert refused.value.line == 4


def test_joints_in_a_ring_are_refused_in_a_sentence(tmp_path):
    links = "".join(f'<link name="{name}"><pose>{x} 0 0 0 0 0</pose></link>' for x, name in enumerate("abc"))
    ring = "".join(
        f'<joint name="{one}{two}" type="revolute"><parent>{one}</parent><child>{two}</child>'
        "<axis><xyz>0 0 1</xyz></axis></joint>"
        for one, two in ("ab", "bc", "ac")
    )
    file = write(tmp_path, "ring.sdf", f'<model name="ring">{links}{ring}</model>')
    with pytest.raises(InputError, match=r"ring\.sdf:\d+: .*loops"):
        load_robot_model(str(file), PackageIndex((), {}))


@pytest.mark.parametrize("version", ["1.6", "1.7", "1.9"])
def test_a_frame_of_an_axis_that_newer_files_do_not_have_is_ignored_there_as_in_gazebo(tmp_path, version):
    body = """<model name="m"><link name="a"/><link name="b"><pose>0 0 0 1.5707963267948966 0 0</pose></link>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>
<use_parent_model_frame>1</use_parent_model_frame></axis></joint></model>"""
    file = write(tmp_path, "m.sdf", body, version)
    (joint,) = load_robot_model(str(file), PackageIndex((), {})).description.joints
    there = (0, 1, 0) if version == "1.6" else (0, 0, 1)  # in the joint's frame, which is the child's
    assert joint.axis == pytest.approx(there, abs=1e-9)
