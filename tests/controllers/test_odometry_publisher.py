"""gz-sim's OdometryPublisher: what its source computes of a pose and a velocity that are known."""

from math import cos, pi, sin

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import TwinBuilder
from drake_twin.controllers.odometry_publisher import OdometryPublisher
from drake_twin.description.gazebo_drive import ODOMETRY_PUBLISHER
from drake_twin.errors import InputError

YAW = 0.7
# At (1, 2, 3) with a heading of 0.7; it turns at 0.5 about z and moves at (0.3, -0.1, 0.2) in its own axes.
MOTION = [1, 2, 3, 0, 0, sin(YAW / 2), cos(YAW / 2), 0.1, 0.2, 0.5, 0.3, -0.1, 0.2]


def publisher(motion=MOTION, frame_prefix="", **given):
    parameters = parameters_of(ODOMETRY_PUBLISHER, **given)
    setup = setup_of(OdometryPublisher, parameters, frame_prefix=frame_prefix)
    return Running(OdometryPublisher(setup), motion=list(motion))


def xyz(vector):
    return [vector.x, vector.y, vector.z]


def test_in_three_dimensions_all_of_the_motion_is_published():
    run = publisher(dimensions=3)
    run.advance(0.25)
    message = run.output("odom")
    assert xyz(message.pose.pose.position) == [1, 2, 3]
    assert xyz(message.twist.twist.linear) == pytest.approx([0.3, -0.1, 0.2])
    assert xyz(message.twist.twist.angular) == pytest.approx([0.1, 0.2, 0.5])
    assert message.header.stamp.nanosec == 250_000_000
    (transform,) = run.output("tf_odometry").transforms
    assert xyz(transform.transform.translation) == [1, 2, 3]
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")


def test_in_two_dimensions_there_is_no_height_and_the_twist_is_planar():
    message = publisher().output("odom")
    assert xyz(message.pose.pose.position) == [1, 2, 0]
    assert xyz(message.twist.twist.linear) == pytest.approx([0.3, -0.1, 0])
    assert xyz(message.twist.twist.angular) == pytest.approx([0, 0, 0.5])
    assert message.pose.pose.orientation.z == pytest.approx(sin(YAW / 2))


def test_on_its_side_the_planar_velocity_is_along_the_heading():
    # Rolled by a quarter turn, its own z is the world's -y: what moves along it moves to the right.
    message = publisher([0, 0, 0, sin(pi / 4), 0, 0, cos(pi / 4), 0, 0, 0, 0.4, 0, 0.2]).output("odom")
    assert xyz(message.twist.twist.linear) == pytest.approx([0.4, -0.2, 0])


def test_the_noise_is_in_the_covariances():
    run = publisher(gaussian_noise=0.1)
    assert not np.any(run.output("odom").pose.covariance)
    message = run.output("odom_with_covariance")
    assert np.diag(np.reshape(message.twist.covariance, (6, 6))) == pytest.approx([0.01] * 6)
    assert np.sum(message.pose.covariance) == pytest.approx(0.06)


def test_without_a_transform_and_when_inactive():
    run = publisher(enable_odom_tf=False)
    assert run.controller.odometry_frames is None
    run.controller.deactivate(run.context)
    assert run.output("odom") is None


def test_an_offset_has_three_numbers():
    with pytest.raises(InputError, match="xyz_offset has 2 numbers, where three are needed"):
        parameters_of(ODOMETRY_PUBLISHER, xyz_offset=[1.0, 2.0])


BOX = """<robot name="box"><link name="base_link"><inertial><mass value="2"/>
    <inertia ixx="0.05" iyy="0.08" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <gazebo><plugin filename="gz-sim-odometry-publisher-system" name="gz::sim::systems::OdometryPublisher">
    {inside}</plugin></gazebo>{more}</robot>"""


def twin_of(tmp_path, inside="", more=""):
    (tmp_path / "box.urdf").write_text(BOX.format(inside=inside, more=more))
    return TwinBuilder().robot("box", tmp_path / "box.urdf", xyz=(0, 0, 5)).build()


def test_in_the_twin_it_publishes_what_was_set(tmp_path):
    twin = twin_of(tmp_path, "<dimensions>3</dimensions><xyz_offset>0.5 0 0</xyz_offset>")
    assert [str(finding) for finding in twin.findings if "plugin" in str(finding)] == []
    assert twin.graph.topics()["/box/odometry"] == "nav_msgs/msg/Odometry"
    turned = (cos(pi / 4), 0, 0, sin(pi / 4))
    twin.entities.set_state("box", (1, 2, 5), turned, linear=(0.1, 0, 0), angular=(0, 0, 2.0))
    message = twin.latest("/box/odometry")
    assert xyz(message.pose.pose.position) == pytest.approx([1, 2.5, 5])
    # 0.5 m ahead of an origin that moves along the world's x, it is carried along the world's -x by the turning.
    assert xyz(message.twist.twist.linear) == pytest.approx([0, 0.9, 0], abs=1e-9)
    assert xyz(message.twist.twist.angular) == pytest.approx([0, 0, 2.0])
    assert message.header.frame_id == "box/odom"
    assert {(t.header.frame_id, t.child_frame_id) for t in twin.latest("/tf").transforms} == {
        ("box/odom", "box/base_link")
    }


def test_it_publishes_at_its_frequency(tmp_path):
    twin = twin_of(tmp_path, "<odom_publish_frequency>20</odom_publish_frequency><odom_topic>o</odom_topic>")
    stamps = []
    twin.subscribe("/box/o", lambda message: stamps.append(message.header.stamp.nanosec))
    twin.advance_to(0.2)
    assert np.diff(stamps) == pytest.approx(50_000_000)
    assert len(stamps) in (4, 5)


def test_of_two_the_first_publishes_the_transform(tmp_path):
    again = '<gazebo><plugin filename="gz-sim-odometry-publisher-system" name="o"><odom_frame>x</odom_frame></plugin>'
    twin = twin_of(tmp_path, "<odom_frame>a</odom_frame>", again + "</gazebo>")
    assert {item.header.frame_id for item in twin.latest("/tf").transforms} == {"box/a"}


def test_a_drives_transform_comes_before_it(tmp_path):
    drive = '<gazebo><plugin filename="libgazebo_ros_planar_move.so" name="move"/></gazebo>'
    twin = twin_of(tmp_path, "", drive)
    assert [str(finding) for finding in twin.findings if "/tf" in str(finding)] == []
    assert twin.graph.topics()["/box/odometry"] == "nav_msgs/msg/Odometry"


def test_wrong_values_are_refused_with_their_line(tmp_path):
    with pytest.raises(InputError, match=r"box\.urdf:3: .*<xyz_offset> is '1 2', which is not three finite numbers"):
        twin_of(tmp_path, "<xyz_offset>1 2</xyz_offset>")


def test_other_dimensions_do_not_start_it(tmp_path):  # as in gz-sim
    (why,) = twin_of(tmp_path, "<dimensions>4</dimensions>").findings.not_started
    assert "<dimensions> is 4, which is neither 2 nor 3" in str(why)
