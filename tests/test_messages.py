import subprocess
import sys

import pytest

from drake_twin import messages


def test_times_are_rounded_to_the_nearest_nanosecond():
    stamp = messages.time_message(1.9999999999)
    assert (stamp.sec, stamp.nanosec) == (2, 0)


def test_an_unknown_type_is_named_with_those_that_exist():
    with pytest.raises(AttributeError, match=r"no message type 'Twits'; it has .*Twist"):
        messages.Twits  # noqa: B018


def test_types_that_rosbags_lacks_hash_as_upstream():
    # `ros2 interface` of control_msgs 5 (Jazzy) prints these definitions; their fields are what hashes are made of.
    store = messages.type_store()
    definition, _ = store.generate_msgdef("control_msgs/msg/DynamicJointState")
    assert "string[] joint_names" in definition
    assert "control_msgs/InterfaceValue[] interface_values" in definition


def test_a_twin_that_nobody_listens_to_does_not_load_the_message_library():
    program = (
        "import sys; from drake_twin.launch.demo import demo_scenario; from drake_twin import Twin;"
        "Twin(demo_scenario('rover', 1, drive=False)).advance_to(0.01); print('rosbags' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "False"
