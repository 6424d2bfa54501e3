"""Nodes, actions, parameters and controllers of a running twin, as ``ros2`` prints them."""

import pytest
import yaml
from tools.two_rovers import MANAGER, STATES, tool_of_two_rovers

from drake_twin.tools import action, control, node, param, service, topic

STEPS, KIND = "/drake_twin/simulate_steps", "simulation_interfaces/action/SimulateSteps"
FORWARD = "forward_velocity_controller"


@pytest.fixture
def tool(capsys, monkeypatch):
    with tool_of_two_rovers(capsys, monkeypatch) as tool:
        yield tool


def test_nodes(tool):
    names = tool(node, "list")[1].split()
    assert names == sorted(names)
    assert {"/drake_twin", "/robot_1/controller_manager", "/robot_2/robot_state_publisher"} <= set(names)
    assert tool(node, "list", "-c")[1] == f"{len(names)}\n"
    _, out, _ = tool(node, "info", "/robot_1/joint_state_broadcaster")
    assert out.splitlines()[:6] == [
        "/robot_1/joint_state_broadcaster",
        "  Subscribers:",
        "",  # where there are none
        "  Publishers:",
        "    /parameter_events: rcl_interfaces/msg/ParameterEvent",
        "    /robot_1/dynamic_joint_states: control_msgs/msg/DynamicJointState",
    ]
    assert [line for line in out.splitlines() if line.startswith("  ") and line[2] != " "] == [
        *("  Subscribers:", "  Publishers:", "  Service Servers:", "  Service Clients:"),
        *("  Action Servers:", "  Action Clients:"),
    ]
    assert f"  Action Servers:\n    {STEPS}: {KIND}\n" in tool(node, "info", "/drake_twin")[1]
    assert "Unable to find node '/nobody'" in tool.refused(node, "info", "/nobody")


def test_types_of_topics_and_services(tool):
    assert tool(topic, "type", STATES) == (0, "sensor_msgs/msg/JointState\n", "")
    assert tool(topic, "type", "/nothing") == (1, "", "")
    assert tool(topic, "find", "sensor_msgs/msg/JointState")[1] == "/robot_1/joint_states\n/robot_2/joint_states\n"
    assert tool(topic, "find", "std_msgs/msg/Byte", "-c")[1] == "0\n"
    spawn = "simulation_interfaces/srv/SpawnEntity"
    assert tool(service, "type", "/drake_twin/spawn_entity") == (0, f"{spawn}\n", "")
    assert tool(service, "type", "/nothing") == (1, "", "")
    assert tool(service, "find", spawn)[1] == "/drake_twin/spawn_entity\n"
    text = f"Type: {spawn}\nClients count: 0\nServices count: 1\n"
    assert tool(service, "info", "/drake_twin/spawn_entity")[1] == text


def test_a_goal_and_its_result(tool):
    assert tool(action, "list", "-t")[1] == f"{STEPS} [{KIND}]\n"
    assert tool(action, "type", STEPS)[1] == f"{KIND}\n"
    assert tool(action, "info", STEPS)[1] == (
        f"Action: {STEPS}\nAction clients: 0\nAction servers: 1\n    /drake_twin\n"
    )
    assert tool(action, "send_goal", STEPS, KIND, "{steps: 5}")[1].endswith("Goal was rejected.\n")  # it runs
    tool.twin.pause()
    before = tool.twin.time
    code, out, _ = tool(action, "send_goal", STEPS, KIND, "{steps: 500}", "--feedback")
    assert code == 0
    assert "Sending goal:\n     steps: 500\n\nGoal accepted with ID: " in out
    assert "Feedback:\n    completed_steps: " in out
    assert out.endswith("Goal finished with status: SUCCEEDED\n")
    assert round((tool.twin.time - before) / tool.twin.clock.time_step) == 500
    assert "unknown action" in tool.refused(action, "send_goal", "/nothing", KIND)
    assert KIND in tool.refused(action, "send_goal", STEPS, "a/action/B")


def test_parameters_are_described_dumped_and_loaded(tool, tmp_path):
    manager = "/robot_1/controller_manager"
    assert "  update_rate (type: integer)\n" in tool(param, "list", manager, "--param-type")[1]
    assert tool(param, "list", manager, "--filter", "use")[1] == "  use_sim_time\n"
    assert tool(param, "describe", manager, "update_rate")[1] == (
        "Parameter name: update_rate\n  Type: integer\n  Description: The rate at which controllers are updated (Hz)\n"
        f"  Constraints:\n    Read only: true\n    Min value: 1\n    Max value: {2**63 - 1}\n"
    )
    code, _, err = tool(param, "delete", manager, "update_rate")
    assert (code, err.split(":")[0]) == (1, "Deleting parameter failed")
    _, out, _ = tool(param, "dump", manager)
    assert yaml.safe_load(out)[manager]["ros__parameters"]["update_rate"] == 100
    assert yaml.safe_load(out)[manager]["ros__parameters"][FORWARD] == {
        "type": "forward_command_controller/ForwardCommandController"
    }
    (tmp_path / "same.yaml").write_text(out)
    code, loaded, err = tool(param, "load", manager, tmp_path / "same.yaml")
    assert "Set parameter defaults.switch_controller.strictness successful\n" in loaded
    assert "Set parameter update_rate failed: " in err
    assert code == 1  # as the manager of ROS does, it refuses what is read-only, also where nothing changes
    (tmp_path / "other.yaml").write_text("/**:\n  ros__parameters:\n    update_rate: 7\n")
    assert tool(param, "load", manager, tmp_path / "other.yaml")[0] == 1
    assert "has no parameters" in tool.refused(param, "load", manager, tmp_path / "other.yaml", "--no-use-wildcard")
    assert "cannot be read" in tool.refused(param, "load", manager, tmp_path / "none.yaml")


def test_controllers_are_unloaded_loaded_and_set(tool):
    def state():
        return tool.twin.control.manager("robot_1").states[FORWARD]

    assert tool(control, "set_controller_state", FORWARD, "inactive", *MANAGER)[1] == (
        f"Successfully deactivated {FORWARD}\n"
    )
    assert state() == "inactive"
    code, _, err = tool(control, "set_controller_state", FORWARD, "inactive", *MANAGER)
    assert (code, err) == (1, f"cannot put {FORWARD} in 'inactive' state from its current state inactive\n")
    assert tool(control, "unload_controller", FORWARD, *MANAGER)[1] == f"Successfully unloaded controller {FORWARD}\n"
    code, _, err = tool(control, "set_controller_state", FORWARD, "active", *MANAGER)
    assert (code, err) == (1, f"controller {FORWARD} does not seem to be loaded\n")
    assert tool(control, "load_controller", FORWARD, *MANAGER, "--set-state", "active")[1] == (
        f"Successfully loaded controller {FORWARD}\nSuccessfully loaded controller {FORWARD} into state active\n"
    )
    assert state() == "active"
    code, out, _ = tool(control, "load_controller", "nobody", *MANAGER)
    assert (code, out) == (1, "Failed loading controller nobody check controller_manager logs\n")
    assert "Give -c" in tool.refused(control, "unload_controller", FORWARD)


def test_hardware_and_types_of_controllers(tool):
    _, out, _ = tool(control, "list_hardware_components", *MANAGER)
    assert out.startswith("Hardware Component 1\n\tname: robot_1_system\n\ttype: system\n\tplugin name: ")
    assert "\tstate: id=3 label=active\n\tread/write rate: 100 Hz\n\tis_async: False\n\tcommand interfaces\n" in out
    assert "\t\trobot_1_front_left_wheel_joint/velocity [available] [claimed]\n" in out
    assert "state interfaces" not in out
    types = tool(control, "list_controller_types", *MANAGER)[1].splitlines()
    base = "controller_interface::ControllerInterface"
    assert f"{'joint_state_broadcaster/JointStateBroadcaster':70s} {base}" in types
