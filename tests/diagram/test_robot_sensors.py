"""The sensors of a robot's sub-diagram: each measures once, for its topic or for the controller that reads it."""

import json

import pytest

from drake_twin import TwinBuilder

BOX = """<robot name="box"><link name="body"><inertial><mass value="1"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <gazebo reference="body"><sensor name="front" type="imu"/><sensor name="rear" type="imu"/></gazebo>
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <sensor name="rear"><state_interface name="orientation.x"/></sensor></ros2_control></robot>"""
FILE = {
    "controller_manager": {"ros__parameters": {"reader": {"type": "imu_sensor_broadcaster/IMUSensorBroadcaster"}}},
    "reader": {"ros__parameters": {"sensor_name": "rear", "frame_id": "body"}},
}


@pytest.fixture
def twin(tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    (tmp_path / "c.yaml").write_text(json.dumps(FILE))
    return TwinBuilder().robot("box", tmp_path / "box.urdf", controllers=tmp_path / "c.yaml", xyz=(0, 0, 1)).build()


def test_sensors_that_a_controller_reads_and_others_have_their_topics(twin):
    topics = twin.graph.topics()
    assert {"/box/front/imu", "/box/rear/imu", "/box/reader/imu"} <= topics.keys()
    twin.advance_to(0.1)  # it falls: an accelerometer shows nothing
    for topic in ("/box/front/imu", "/box/rear/imu", "/box/reader/imu"):
        assert twin.latest(topic).linear_acceleration.z == pytest.approx(0.0, abs=1e-9)
