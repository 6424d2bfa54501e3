"""What arduinobot_moveit_config says of the arm is so in the arm's own files."""

import itertools

import pytest
import yaml
from conftest import ARM
from lxml import etree
from program_runs import MODELS

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model

CONFIG = MODELS / "arduinobot_moveit_config" / "config"


@pytest.fixture(scope="module")
def urdf():
    return etree.fromstring(load_robot_model(ARM, PackageIndex()).description.text.encode())


@pytest.fixture(scope="module")
def srdf():
    return etree.parse(CONFIG / "arduinobot.srdf").getroot()


def joints_of(urdf):
    return {joint.get("name"): joint for joint in urdf.iter("joint") if joint.find("limit") is not None}


def test_the_groups_poses_are_within_the_joints_limits(urdf, srdf):
    joints = joints_of(urdf)
    poses = srdf.findall("group_state")
    assert len(poses) == 4
    for joint in itertools.chain.from_iterable(poses):
        limit = joints[joint.get("name")].find("limit")
        assert float(limit.get("lower")) <= float(joint.get("value")) <= float(limit.get("upper"))


def test_links_that_touch_at_a_joint_are_not_checked_for_collisions(urdf, srdf):
    links = {link.get("name") for link in urdf.iter("link")}
    pairs = {frozenset((pair.get("link1"), pair.get("link2"))) for pair in srdf.iter("disable_collisions")}
    assert set().union(*pairs) <= links
    ends = {frozenset(joint.xpath("parent/@link | child/@link")) for joint in urdf.findall("joint")}
    assert {pair for pair in ends if "world" not in pair} <= pairs  # the world has no shape


def test_limits_and_controllers_are_of_the_joints_that_are_commanded(urdf):
    commanded = {name for name, joint in joints_of(urdf).items() if joint.find("mimic") is None}
    limits = yaml.safe_load((CONFIG / "joint_limits.yaml").read_text("utf-8"))["joint_limits"]
    assert set(limits) == commanded
    for name, limit in limits.items():
        assert limit["max_velocity"] <= float(joints_of(urdf)[name].find("limit").get("velocity"))
    manager = yaml.safe_load((CONFIG / "moveit_controllers.yaml").read_text("utf-8"))[
        "moveit_simple_controller_manager"
    ]
    names = manager["controller_names"]
    assert sorted(joint for name in names for joint in manager[name]["joints"]) == sorted(commanded)
