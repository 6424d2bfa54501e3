"""The plan of one controller: what it reads and whose references it writes."""

from dataclasses import replace

import pytest
from controller_parameters import parameters_of

from drake_twin.controllers.interface import Interface
from drake_twin.planning.controller_plan import ControllerPlan, chained_to, is_chained

IMU = "imu_sensor_broadcaster/IMUSensorBroadcaster"


@pytest.fixture
def imu():
    return ControllerPlan("i", IMU, parameters_of(IMU, sensor_name="s", frame_id="f"), state="active")


def test_the_sensor_of_a_broadcaster_is_the_one_that_it_is_loaded_for(imu):
    assert [replace(imu, state=state).sensor for state in ("active", "inactive", "unconfigured")] == ["s"] * 3
    assert replace(imu, state="unloaded").sensor is None
    assert replace(imu, parameters=None).sensor is None


def test_other_controllers_and_unknown_ones_read_no_sensor(imu):
    kind = "joint_state_broadcaster/JointStateBroadcaster"
    assert replace(imu, type=kind, parameters=parameters_of(kind)).sensor is None
    assert replace(imu, type="a/B").sensor is None


def test_references_have_the_controllers_name_before_the_joints():
    plan = ControllerPlan("pid", "a/B", references=(Interface("left", "position"),))
    assert [str(item) for item in plan.reference_interfaces] == ["pid/left/position"]


def test_a_chain_is_to_the_controllers_whose_references_are_claimed_once_each():
    claims = [Interface(joint, "position") for joint in ("b/x", "joint", "b/y", "c/x", "arm/left")]
    plan = ControllerPlan("a", "a/B", claims=tuple(claims))
    assert [is_chained(claim, {"b", "c"}) for claim in claims] == [True, False, True, True, False]
    assert chained_to(plan, {"b", "c"}) == ("b", "c")
