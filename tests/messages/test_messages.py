import subprocess
import sys

import pytest
from rosbags.typesys import Stores, get_typestore

from drake_twin import messages
from drake_twin.messages.store import base_types, store_with


def test_times_are_rounded_to_the_nearest_nanosecond():
    stamp = messages.time_message(1.9999999999)
    assert (stamp.sec, stamp.nanosec) == (2, 0)


def test_an_unknown_type_is_named_with_those_that_exist():
    with pytest.raises(AttributeError, match=r"no message type 'Twits'; it has .*Twist"):
        messages.Twits  # noqa: B018


def test_types_that_rosbags_lacks_hash_as_upstream():
    # `ros2 interface` of control_msgs 5 (Jazzy) prints these definitions; their fields are what hashes are made of.
    store = store_with("control_msgs/msg/DynamicJointState")
    definition, _ = store.generate_msgdef("control_msgs/msg/DynamicJointState")
    assert "string[] joint_names" in definition
    assert "control_msgs/InterfaceValue[] interface_values" in definition


def test_the_messages_of_the_joint_trajectory_controller_survive_the_wire():
    store = messages.type_store()
    result = messages.FollowJointTrajectory_Result(error_code=-4, error_string="Aborted")
    assert messages.FollowJointTrajectory_Result.PATH_TOLERANCE_VIOLATED == -4
    name = "control_msgs/action/FollowJointTrajectory_Result"
    assert store.deserialize_cdr(store.serialize_cdr(result, name), name) == result
    definition, _ = store.generate_msgdef("control_msgs/action/FollowJointTrajectory_Goal")
    assert "control_msgs/JointTolerance[] path_tolerance" in definition
    store = store_with("control_msgs/msg/JointTrajectoryControllerState")
    definition, _ = store.generate_msgdef("control_msgs/msg/JointTrajectoryControllerState")
    assert "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_output" in definition


def test_durations_before_zero_have_their_nanoseconds_above_it():
    duration = messages.duration_message(-0.25)
    assert (duration.sec, duration.nanosec) == (-1, 750_000_000)


def test_a_twin_that_nobody_listens_to_does_not_load_the_message_library():
    program = (
        "import sys; from drake_twin.builder.demo import demo_scenario; from drake_twin import Twin;"
        "Twin(demo_scenario('rover', 1, drive=False)).advance_to(0.01); print('rosbags' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "False"


def test_bytes_and_characters_are_numbers():
    """A byte goes as one of rosbags' numbers with a sign: 200 is 200 - 256."""
    status = messages.message("diagnostic_msgs/msg/DiagnosticStatus", {"level": 200})
    assert status.level == 200 - 256
    assert messages.message("std_msgs/msg/Char", {"data": 255}).data == 255
    for kind in ("Byte", "Char"):
        with pytest.raises(ValueError, match=r"data: 256 is not a "):
            messages.message(f"std_msgs/msg/{kind}", {"data": 256})


def test_a_message_of_another_type_is_refused_and_one_of_its_own_is_copied():
    types = messages.type_store().types
    vector = types["geometry_msgs/msg/Vector3"](1.0, 2.0, 3.0)
    twist = messages.message("geometry_msgs/msg/Twist", {"linear": vector})
    assert twist.linear == vector
    assert twist.linear is not vector
    point = types["geometry_msgs/msg/Point"](1.0, 2.0, 3.0)
    wanted = r"linear: this is a geometry_msgs/msg/Point, but a geometry_msgs/msg/Vector3 is needed"
    with pytest.raises(ValueError, match=wanted):
        messages.message("geometry_msgs/msg/Twist", {"linear": point})


def test_fields_that_are_left_out_are_zero_or_empty():
    """As rosidl initializes them."""
    parameter = messages.message("rcl_interfaces/msg/ParameterValue", {})
    assert (parameter.bool_value, parameter.integer_value, parameter.double_value) == (False, 0, 0.0)
    assert (parameter.string_value, list(parameter.string_array_value)) == ("", [])
    assert isinstance(parameter.bool_value, bool)
    assert messages.message("sensor_msgs/msg/Imu", {}).orientation_covariance.tolist() == [0.0] * 9


def test_the_names_of_the_stores_types_are_those_of_the_loaded_store():
    assert base_types() == frozenset(get_typestore(Stores.ROS2_JAZZY).types)


def test_names_that_are_not_found_in_the_text_are_those_of_the_store(monkeypatch):
    monkeypatch.setattr("drake_twin.messages.store._STORE_FILE", ("moved.py",))
    assert base_types.__wrapped__() == base_types()
