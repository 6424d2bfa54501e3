"""Nodes that the twin does not start, and why."""

import pytest

from drake_twin.findings import Place
from drake_twin.from_launch.not_started import is_window, misspelt_package, why_not_started
from drake_twin.ros2.launched import LaunchedProcess


def node(package, executable):
    return LaunchedProcess("node", executable, Place("f"), package)


@pytest.mark.parametrize(
    ("package", "executable", "reason"),
    [
        ("rviz2", "rviz2", "the page shows the robots"),
        ("nav2_controller", "controller_server", "navigation is not a part of the twin"),
        ("joint_state_publisher", "joint_state_publisher", "joint states come from the simulation"),
        ("joint_state_publisher_gui", "joint_state_publisher_gui", "it is a window"),
        ("ros_gz_sim", "set_entity_pose", "it asks Gazebo's services"),
        ("tf2_ros", "static_transform_publsher", "unknown; did you mean 'static_transform_publisher'?"),
        ("tf2_ros", "something_else", "it is not a Python program of the workspace"),
        ("my_robot", "driver", "it is not a Python program of the workspace"),
        ("depthai_ros", "stereo", "processing pictures is not a part of the twin"),
        (None, "./drive", "of programs, the twin starts only Python nodes"),
    ],
)
def test_each_has_the_reason_that_fits_its_name(package, executable, reason):
    text = why_not_started(node(package, executable))
    assert text.startswith(f"{package}/{executable} (" if package else f"{executable} (")
    assert reason in text


def test_windows_are_those_that_only_show_something():
    assert [is_window(node(name, name)) for name in ("rviz2", "rqt_graph", "nav2_amcl")] == [True, True, False]


@pytest.mark.parametrize(
    ("package", "executable", "expected"),
    [
        ("ros_gz_bridg", "parameter_bridge", "ros_gz_bridge"),
        ("ros_gz_bridge", "parameter_bridge", None),
        ("my_bridges", "parameter_bridge", None),
        ("ros_gz_bridg", "my_node", None),
        (None, "parameter_bridge", None),
    ],
)
def test_a_package_that_is_nearly_that_of_its_executable_is_named(package, executable, expected):
    assert misspelt_package(node(package, executable)) == expected
