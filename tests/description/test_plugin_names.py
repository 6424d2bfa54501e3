import pytest
from sdf_worlds import world_of

from drake_twin.description.plugin_names import misspelt_plugin
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.unread import unread_in_urdf
from drake_twin.description.xml_reader import XmlReader

PHYSICS, DRIVE = "gz-sim-physics-system", "gz-sim-diff-drive-system"


@pytest.mark.parametrize(
    ("library", "name"),
    [
        (PHYSICS, "gz::sim::systems::Physics"),
        ("libignition-gazebo6-physics-system.so", "ignition::gazebo::v6::systems::Physics"),
        ("gz-sim-forcetorque-system", "gz::sim::systems::ForceTorque"),
        ("gz-sim-navsat-system", "gz::sim::systems::NavSat"),
        ("gz-sim-multicopter-control-system", "gz::sim::systems::MulticopterVelocityControl"),
        ("gz-sim-buoyancy-engine-system", "gz::sim::systems::BuoyancyEnginePlugin"),
        (DRIVE, "drive"),
        ("", "gz::sim::systems::Physics"),
        ("libmine.so", "gz::sim::systems::Physics"),
        ("libgazebo_ros_diff_drive.so", "drive"),
        ("gz_ros2_control-system", "gz_ros2_control::GazeboSimROS2ControlPlugin"),
        ("libgazebo_ros2_control.so", "gazebo_ros2_control"),
    ],
)
def test_a_plugin_whose_names_fit_or_that_is_another_one_is_no_finding(library, name):
    assert misspelt_plugin(GazeboPlugin(library, name)) is None


@pytest.mark.parametrize(
    ("library", "name", "close"),
    [
        ("gz-siim-physics-system", "gz::sim::systems::Physics", PHYSICS),
        (PHYSICS, "gz::sm::systems::Physics", "gz::sim::systems::Physics"),
        ("gz_ros2_control-system", "gz_ros2_control::GazeboSimROS2ControlPlgin",
         "gz_ros2_control::GazeboSimROS2ControlPlugin"),
    ],
)  # fmt: skip
def test_a_misspelt_name_of_a_plugin_names_the_close_one(library, name, close):
    assert misspelt_plugin(GazeboPlugin(library, name)).endswith(f"of a Gazebo plugin. Did you mean {close!r}?")


@pytest.mark.parametrize(
    ("library", "name"),
    [
        ("gz-sim-physics-systm", "gz::sim::systems::Physics"),
        (PHYSICS, "gz::sim::systems::Phsics"),
        (DRIVE, "gz::sim::systems::DifDrive"),
    ],
)
def test_two_names_that_nearly_fit_are_both_told(library, name):
    what = f"Gazebo plugin {name} ({library}): one of the two names is misspelt"
    assert misspelt_plugin(GazeboPlugin(library, name)) == what


def test_it_is_a_finding_of_robots_and_of_worlds_with_its_line(tmp_path):
    plugin = '<plugin filename="gz-siim-physics-system" name="gz::sim::systems::Physics"/>'
    robot = unread_in_urdf(XmlReader(f'<robot name="r">\n<link name="l"/><gazebo>{plugin}</gazebo></robot>'))
    world = world_of(tmp_path, plugin).findings
    what = f"unknown library 'gz-siim-physics-system' of a Gazebo plugin. Did you mean {PHYSICS!r}?"
    assert [(item.what, item.lines) for item in robot] == [(what, (2,))]
    assert what in [item.what for item in world]
