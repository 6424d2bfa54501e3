"""The panel of parameters, without a browser."""

import pytest
from conftest import rovers

from drake_twin.cockpit.parameters_panel import ParametersPanel
from drake_twin.errors import InputError

CONTROLLER = "/robot_1/forward_velocity_controller"


class Looked:
    """A panel that a tab looks at."""

    def __init__(self, twin):
        self.twin, self.panel, self.rows = twin, ParametersPanel(twin), {}
        self.look()

    def look(self, version=0):
        self.panel.ask({"do": "Look", "version": version})
        state = self.panel.state()
        if state["rows"] is not None:
            self.rows = {(row["node"], row["name"]): row for row in state["rows"]}
        return state

    def put(self, node, name, text):
        self.panel.ask({"do": "SetParameter", "node": node, "name": name, "text": text, "key": text})
        outcome = self.look()["outcome"]
        assert outcome["key"] == text
        return outcome["problem"]


@pytest.fixture
def looked():
    return Looked(rovers(2).build())


def test_the_parameters_are_those_of_the_services(looked):
    nodes = {node for node, _ in looked.rows}
    assert {node.rpartition("/")[2] for node in nodes} == {
        "robot_state_publisher",
        "controller_manager",
        "joint_state_broadcaster",
        "forward_velocity_controller",
    }
    own = {name: row["value"] for (node, name), row in looked.rows.items() if node == CONTROLLER}
    assert own["interface_name"] == "velocity"
    assert own["joints"].startswith("[robot_1_front_left_wheel_joint, robot_1_front_right_wheel_joint")
    assert looked.rows["/robot_1/controller_manager", "update_rate"]["read_only"]
    assert looked.rows["/robot_2/robot_state_publisher", "robot_description"]["read_only"]  # too long for a field


def test_a_value_is_set_and_a_whole_number_may_stand_for_a_double(looked):
    assert looked.put("/robot_1/robot_state_publisher", "publish_frequency", "5") == ""
    assert looked.rows["/robot_1/robot_state_publisher", "publish_frequency"]["value"] == "5.0"
    assert looked.rows["/robot_2/robot_state_publisher", "publish_frequency"]["value"] == "20.0"


@pytest.mark.parametrize(
    ("node", "name", "text", "why"),
    [
        ("/robot_1/controller_manager", "update_rate", "5", "update_rate"),
        ("/robot_1/robot_state_publisher", "publish_frequency", "fast", "publish_frequency"),
        ("/robot_1/robot_state_publisher", "publish_frequency", "[1", "is not a value"),
        ("/robot_1/robot_state_publisher", "nothing", "1", "nothing"),
        ("/robot_9/robot_state_publisher", "publish_frequency", "1", "unknown node /robot_9/robot_state_publisher"),
    ],
)
def test_what_is_refused_is_said_and_changes_nothing(looked, node, name, text, why):
    before = looked.rows
    assert why in looked.put(node, name, text)
    assert looked.rows == before


def test_the_list_is_sent_once_and_again_when_others_have_set_something(looked):
    version = looked.look()["version"]
    assert looked.look(version)["rows"] is None
    looked.twin.control.set_parameters("robot_1", "robot_state_publisher", {"publish_frequency": 7.0})
    looked.twin.advance_to(0.1)
    assert looked.look(version)["version"] == version + 1
    assert looked.rows["/robot_1/robot_state_publisher", "publish_frequency"]["value"] == "7.0"
    looked.twin.entities.delete("robot_2")
    assert looked.look(version)["version"] == version + 2
    assert not any(node.startswith("/robot_2") for node, _ in looked.rows)


def test_a_list_that_nobody_looks_at_is_not_read(looked):
    for _ in range(100):
        state = looked.panel.state()
    assert state is None
    assert looked.panel._end is None


@pytest.mark.parametrize("wrong", [{"do": "Look"}, {"do": "Nothing"}, 3])
def test_other_requests_are_refused(looked, wrong):
    with pytest.raises(InputError):
        looked.panel.ask(wrong)
