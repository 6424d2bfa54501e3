"""Lines of a bridge whose topics nothing has in Gazebo."""

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.from_launch.bridges import BridgeLine
from drake_twin.planning.bridged_sensors import misspelt, unpublished
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot

CART = """<robot name="cart"><link name="base"/><link name="wheel"/>
  <joint name="left" type="continuous"><parent link="base"/><child link="wheel"/></joint>
  <gazebo reference="base"><sensor name="s" type="imu"><topic>/imu/data</topic></sensor>
    <sensor name="eye" type="thermal"/></gazebo>
  <gazebo><plugin filename="gz-sim-joint-position-controller-system" name="p"><joint_name>left</joint_name>
    <topic>/left/position</topic></plugin></gazebo>
  <ros2_control name="s" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
    <joint name="left"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>
</robot>"""
IMU, IMAGE = "sensor_msgs/msg/Imu", "sensor_msgs/msg/Image"


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "cart.urdf").write_text(CART)
    found = plan_robot(Robot("cart", str(tmp_path / "cart.urdf"), xyz=(0, 0, 1)), PackageIndex())
    assert {item.wiring is None for item in found.controllers} == {True, False}  # of ros2_control and of a plugin
    return found


@pytest.mark.parametrize(
    ("gz", "hint"),
    [
        ("/left/position", None),
        ("/left/positon", "/left/position"),
        ("/right/other", None),
    ],
)
def test_a_topic_that_is_nearly_a_drives_names_it(plan, gz, hint):
    found = [item.what for item in misspelt([BridgeLine(gz, "/p")], [plan])]
    assert [hint in what for what in found] == ([] if hint is None else [True])


def test_a_drive_whose_topic_another_line_carries_is_no_hint(plan):
    lines = [BridgeLine("/left/positon", "/p"), BridgeLine("/left/position", "/q")]
    assert list(misspelt(lines, [plan])) == []


@pytest.mark.parametrize(
    ("line", "count"),
    [
        (BridgeLine("/imu/data", "/imu", IMU, "GZ_TO_ROS"), 0),
        (BridgeLine("/imu/dta", "/imu", IMU, "GZ_TO_ROS"), 1),
        (BridgeLine("/imu/dta", "/imu", IMU, "ROS_TO_GZ"), 0),  # nothing of Gazebo's is to be heard
        (BridgeLine("/imu/dta", "/imu", "std_msgs/msg/Float64", "GZ_TO_ROS"), 0),  # anything may publish it
        (BridgeLine("/world/w/model/cart/link/base/sensor/eye/image", "/eye", IMAGE), 0),  # Gazebo simulates it
        (BridgeLine("/world/w/model/cart/link/base/sensor/ear/image", "/eye", IMAGE), 1),
    ],
)
def test_a_sensors_message_that_no_sensor_publishes_is_a_warning(plan, line, count):
    found = [item.what for item in unpublished([line], [plan])]
    assert ["no sensor publishes it in Gazebo" in what for what in found] == [True] * count
