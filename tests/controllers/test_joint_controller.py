"""gz-sim's JointController: a velocity from the start, on its own and in a twin."""

import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import TwinBuilder, messages
from drake_twin.controllers.joint_controller import JointController
from drake_twin.description.gazebo_drive import JOINT_CONTROLLER

WHEEL = """<sdf version="1.9"><model name="wheel"><link name="stand"><inertial><mass>1</mass></inertial></link>
<link name="rim"><inertial><mass>1</mass></inertial></link>
<joint name="base" type="fixed"><parent>world</parent><child>stand</child></joint>
<joint name="axle" type="revolute"><parent>stand</parent><child>rim</child><axis><xyz>0 0 1</xyz></axis></joint>
<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">
<joint_name>axle</joint_name><initial_velocity>5</initial_velocity></plugin></model></sdf>"""


def test_its_velocity_holds_until_a_message_replaces_it():
    parameters = parameters_of(JOINT_CONTROLLER, joints=["finger"], initial_velocity=2.5)
    run = Running(JointController(setup_of(JointController, parameters)), commands=None)
    assert run.commands() == [2.5]
    run.send("commands", messages.message("std_msgs/msg/Float64MultiArray", {"data": [-1.0]}))
    assert run.commands() == [-1.0]


@pytest.mark.parametrize("step", [0.001, 0.01])
def test_the_joint_turns_from_the_first_step_and_again_after_a_reset(tmp_path, step):
    (tmp_path / "wheel.sdf").write_text(WHEEL)
    twin = TwinBuilder(time_step=step).robot("wheel", tmp_path / "wheel.sdf").build()
    for _ in range(2):
        twin.advance_to(step)
        assert twin.robot_state("wheel").velocities == pytest.approx((5.0,), rel=0.02)
        twin.advance_to(0.5)
        assert twin.robot_state("wheel").velocities == pytest.approx((5.0,), rel=1e-6)
        assert twin.robot_state("wheel").positions == pytest.approx((2.5,), rel=1e-2)
        twin.publish("/wheel/joint/axle/cmd_vel", messages.message("std_msgs/msg/Float64", {"data": -2.0}))
        twin.advance_to(0.6)
        assert twin.robot_state("wheel").velocities == pytest.approx((-2.0,), rel=1e-6)
        twin.reset()
