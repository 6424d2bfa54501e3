import numpy as np
import pytest
import yaml
from conftest import ARM, rovers

from drake_twin import messages
from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.cli.ros2_text import controllers_text, topics_text
from drake_twin.messages.text import message_text
from drake_twin.twin.event_topics import PARAMETER_EVENTS, ROSOUT


@pytest.fixture(scope="module")
def twin():
    twin = rovers(2).build()
    twin.control.manager("robot_2").switch_controller([], ["forward_velocity_controller"])
    twin.advance_to(0.05)
    return twin


def test_topics_are_listed_as_ros2_topic_list_does(twin):
    lines = topics_text(twin).splitlines()
    assert lines == sorted(lines)
    assert "/clock [rosgraph_msgs/msg/Clock]" in lines
    assert "/robot_1/forward_velocity_controller/commands [std_msgs/msg/Float64MultiArray]" in lines
    assert len(lines) == len(twin.graph.topics())


def test_controllers_are_listed_for_each_manager(twin):
    assert controllers_text(twin).splitlines() == [
        "/robot_1/controller_manager:",
        "  joint_state_broadcaster     joint_state_broadcaster/JointStateBroadcaster       active",
        "  forward_velocity_controller forward_command_controller/ForwardCommandController active",
        "/robot_2/controller_manager:",
        "  joint_state_broadcaster     joint_state_broadcaster/JointStateBroadcaster       active",
        "  forward_velocity_controller forward_command_controller/ForwardCommandController inactive",
    ]


def test_a_robot_without_loaded_controllers_says_so():
    twin = TwinBuilder().robot("arm", ARM, active_controllers=()).build()
    assert controllers_text(twin) == "/arm/controller_manager:\n  No controllers are currently loaded!"


def test_a_message_is_printed_as_ros2_topic_echo_does():
    message = messages.JointState(
        header=messages.Header(stamp=messages.Time(sec=1, nanosec=500), frame_id=""),
        name=["a", "é"],
        position=np.array([0.5, np.nan]),
        velocity=np.array([]),
        effort=np.array([-1.0, 2.0]),
    )
    assert message_text(message) == (
        "header:\n  stamp:\n    sec: 1\n    nanosec: 500\n  frame_id: ''\n"
        "name:\n- a\n- é\nposition:\n- 0.5\n- .nan\nvelocity: []\neffort:\n- -1.0\n- 2.0\n---"
    )


def test_every_topic_of_a_twin_can_be_printed(twin):
    for topic in twin.graph.topics():
        if topic not in (*twin.built.commanded, ROSOUT, PARAMETER_EVENTS):  # nothing has happened yet
            text = message_text(twin.latest(topic))
            assert text.endswith("\n---")
            assert yaml.safe_load(text.removesuffix("---")) is not None


def test_long_texts_and_lists_are_cut():
    text = message_text(messages.String(data="x" * 129))
    assert text == "data: " + "x" * 128 + "...\n---"
    assert message_text(messages.String(data="x" * 128)) == "data: " + "x" * 128 + "\n---"
    numbers = messages.JointState(
        header=messages.Header(stamp=messages.Time(sec=0, nanosec=0), frame_id=""),
        name=[],
        position=np.arange(129.0),
        velocity=np.arange(128.0),
        effort=np.array([]),
    )
    data = yaml.safe_load(message_text(numbers).removesuffix("---"))
    assert data["position"] == [*np.arange(128.0), "..."]
    assert data["velocity"] == [*np.arange(128.0)]
