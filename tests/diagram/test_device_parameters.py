"""Parameters of grippers, PID loops and sensors as people write them in YAML."""

import pytest

from drake_twin.controllers.pid_controller import PidControllerGains
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters, read_controllers
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError

FILES = {
    "gz_ros2_control/gz_ros2_control_demos/config/cart_controller_velocity.yaml": {
        "imu_sensor_broadcaster": ("cart_imu_sensor", "imu")
    },
    "gz_ros2_control/gz_ros2_control_demos/config/gripper_controller_position.yaml": {},
    "ros2_control_demos/example_4/bringup/config/rrbot_with_sensor_controllers.yaml": {
        "fts_broadcaster": ("tcp_fts_sensor", "force_torque")
    },
    "ros2_control_demos/example_5/bringup/config/rrbot_with_external_sensor_controllers.yaml": {
        "fts_broadcaster": ("tcp_fts_sensor", "force_torque")
    },
    "ros2_control_demos/example_16/bringup/config/diffbot_chained_controllers.yaml": {},
}


def read(kind, **parameters):
    return read_parameters(controller_class(kind).Parameters, ControllerParameters("c", kind, parameters))


@pytest.mark.parametrize("file", FILES)
def test_other_peoples_parameters_are_read_without_a_warning(corpus, file):
    seen = set()
    for entry in read_controllers(corpus / file, "", {}).controllers:
        controller = controller_class(entry.type)
        if controller is None:
            continue
        parameters, warnings = read_parameters(controller.Parameters, entry)
        assert [warning for warning in warnings if "since Jazzy" not in warning.what] == []
        if entry.name in FILES[file]:
            sensor, of_kind = FILES[file][entry.name]
            assert (controller.sensor_name(parameters), controller.kind) == (sensor, of_kind)
            seen.add(entry.name)
    assert seen == set(FILES[file])


def test_gains_of_a_pid_are_read_for_each_joint():
    parameters, warnings = read(
        "pid_controller/PidController",
        dof_names=["a", "b"],
        command_interface="velocity",
        reference_and_state_interfaces=["position"],
        gains={"a": {"p": 1, "u_clamp_max": 2.5}},
        **{"gains.b.d": 0.5},
    )
    assert parameters.gains == {"a": PidControllerGains(p=1.0, u_clamp_max=2.5), "b": PidControllerGains(d=0.5)}
    assert warnings == ()


def test_a_pid_on_an_interface_that_the_twin_does_not_measure_is_refused():
    with pytest.raises(InputError, match="unknown value 'effort'"):
        read(
            "pid_controller/PidController",
            dof_names=["a"],
            command_interface="effort",
            reference_and_state_interfaces=["effort"],
        )


def test_what_a_gripper_ignores_is_said():
    _, warnings = read("position_controllers/GripperActionController", joint="finger", action_monitor_rate=5.0)
    assert tuple(map(str, warnings)) == (
        "controller c: action_monitor_rate is ignored: the end of a goal is reported at once",
    )


def test_a_filter_that_the_twin_lacks_is_refused_with_those_it_has():
    with pytest.raises(InputError, match="Valid: control_filters/LowPassFilterWrench"):
        read(
            "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
            sensor_name="fts",
            frame_id="tool",
            sensor_filter_chain={"filter1": {"type": "control_filters/GravityCompensationWrench", "params": {}}},
        )
