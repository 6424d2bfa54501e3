"""Types as ``ros2 interface`` of Jazzy shows them, but without comments; no twin is needed."""

import pytest

from drake_twin.tools import interface

JOINT_STATE = """std_msgs/Header header
\tbuiltin_interfaces/Time stamp
\t\tint32 sec
\t\tuint32 nanosec
\tstring frame_id
string[] name
float64[] position
float64[] velocity
float64[] effort
"""


@pytest.fixture
def printed(capsys):
    def run(*words):
        code = interface.main(words)
        captured = capsys.readouterr()
        return captured.out if code == 0 else (code, captured.err)

    return run


def test_a_message_with_those_in_it(printed):
    assert printed("show", "sensor_msgs/msg/JointState") == JOINT_STATE


def test_the_parts_of_services_and_actions(printed):
    assert printed("show", "std_srvs/srv/Trigger") == "---\nbool success\nstring message\n"
    fibonacci = "int32 order\n---\nint32[] sequence\n---\nint32[] sequence\n"
    assert printed("show", "example_interfaces/action/Fibonacci") == fibonacci


def test_packages_and_their_types(printed):
    assert printed("package", "std_srvs") == "std_srvs/srv/Empty\nstd_srvs/srv/SetBool\nstd_srvs/srv/Trigger\n"
    assert printed("package", "std_srvs", "-m") == ""
    assert "std_srvs" not in printed("packages", "-m").split()
    assert {"std_srvs", "sensor_msgs"} <= set(printed("packages").split())
    assert printed("show", "std_srvs/srv/Trigger", "--no-comments") == printed("show", "std_srvs/srv/Trigger")
    assert printed("list", "-s").startswith("Services:\n    ")
    assert "    std_srvs/srv/Trigger\n" in printed("list")


def test_a_prototype(printed):
    assert printed("proto", "geometry_msgs/msg/Point") == '"x: 0.0\ny: 0.0\nz: 0.0\n"\n'
    assert printed("proto", "std_srvs/srv/SetBool", "--no-quotes") == "data: false\n\n"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("show", "std_srvs/srv/Triger"), "std_srvs/srv/Trigger"),
        (("show", "none/msg/X"), "std_msgs"),
        (("show", "String"), "Unknown interface 'String'"),
        (("show", "std_msgs/messages/String"), "std_msgs/msg/String"),
        (("show", "std_msgs/msg/String/data"), "std_msgs/msg/String"),
        (("package", "std_srv"), "std_srvs"),
    ],
)
def test_what_is_unknown(printed, words, text):
    code, said = printed(*words)
    assert code == 2
    assert text in said
    assert said.count("\n") == 1
