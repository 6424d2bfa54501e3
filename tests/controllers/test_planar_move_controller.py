from math import cos, sin

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.planar_move_controller import PlanarMoveController, PlanarMoveParameters
from drake_twin.description.robot_description import Pose, RobotDescription
from drake_twin.errors import CommandError
from drake_twin.kinematics.planar_base import PlanarBase
from drake_twin.kinematics.state_layout import StateLayout

# Slides along x, y, z and a turn, their positions and then their velocities; the base starts at the world's origin.
PLANAR = PlanarBase(Pose(), (0, 1, 2, 3), (4, 5, 6, 7))
LAYOUT = StateLayout(8, {"base.angular.z": 3}, {"base.angular.z": 7}, {}, planar_base=PLANAR)
ROBOT = RobotDescription("robot", ("base_footprint",), ())


def twist(x=0.0, y=0.0, z=0.0):
    return messages.Twist(linear=messages.Vector3(x=x, y=y, z=0.0), angular=messages.Vector3(x=0.0, y=0.0, z=z))


@pytest.fixture
def dut():
    claims = PlanarMoveController.claimed_interfaces(None, ROBOT)
    return PlanarMoveController(ControllerSetup("move", PlanarMoveParameters(), claims, ROBOT, LAYOUT))


def advanced(dut, message, state=(0.0,) * 8, time=0.005):
    builder = DiagramBuilder()
    builder.AddSystem(dut)
    simulator = Simulator(builder.Build())
    context = dut.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    port = dut.get_command_input_port()
    dut.get_state_input_port().FixValue(context, state)
    dut.activate(context)
    if message is not None:
        port.FixValue(context, AbstractValue.Make(dut.read(port.get_name(), message, context)))
    simulator.AdvanceTo(time)
    assert dut.fault(context) is None
    return context


def test_before_the_first_message_nothing_is_written(dut):
    assert np.isnan(dut.get_command_interfaces_output_port().Eval(advanced(dut, None))).all()


def test_a_command_is_passed_on_and_holds(dut):
    context = advanced(dut, twist(0.1, 0.2), time=10.0)
    assert dut.get_command_interfaces_output_port().Eval(context).tolist() == [0.1, 0.2, 0.0]
    assert list(map(str, dut.claims)) == ["base.linear.x/velocity", "base.linear.y/velocity", "base.angular.z/velocity"]


def test_a_command_goes_where_the_base_faces_half_an_update_later(dut):
    context = advanced(dut, twist(0.1, 0.2, 2.0), (1, 2, 3, 0.7, 0, 0, 0, 0))
    heading = 0.7 + 0.5 * dut.setup.update_period * 2.0
    expected = [0.1 * cos(heading) - 0.2 * sin(heading), 0.1 * sin(heading) + 0.2 * cos(heading), 2.0]
    assert dut.get_command_interfaces_output_port().Eval(context).tolist() == pytest.approx(expected, abs=1e-15)


def test_a_command_that_is_not_finite_is_refused(dut):
    with pytest.raises(CommandError, match=r"the command's linear.y is nan"):
        advanced(dut, twist(y=np.nan))


def test_the_odometry_is_the_true_pose_and_the_velocity_in_the_bases_frame(dut):
    yaw = 0.7
    state = np.array([1.0, 2.0, 0.1, yaw, -sin(yaw), cos(yaw), 0.0, 0.5])
    context = advanced(dut, None, state)
    odom = dut.GetOutputPort("odom").Eval(context)
    assert (odom.pose.pose.position.x, odom.pose.pose.position.y) == (1.0, 2.0)
    assert odom.pose.pose.orientation.z == pytest.approx(sin(yaw / 2))
    assert (odom.twist.twist.linear.x, odom.twist.twist.linear.y) == pytest.approx((0.0, 1.0))
    assert odom.twist.twist.angular.z == 0.5
    (transform,) = dut.GetOutputPort("tf_odometry").Eval(context).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")
