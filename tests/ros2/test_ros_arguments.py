"""Command lines with ``--ros-args``, as ROS's design article on node arguments has them."""

from pathlib import Path

import pytest

from drake_twin.ros2.ros_arguments import (
    RosArguments,
    RosArgumentsError,
    check_ros_arguments,
    ros_arguments,
    split_ros_arguments,
)


def test_a_command_line_is_split():
    line = "-x --ros-args -r __node:=n -r __ns:=/a/b -r old:=new --remap c:=d -p gain:=1.5 -p other:on:=true"
    line += " -p 'text:=a: {' --params-file /p.yaml --log-level debug --log-level rcl:=warn -- own --ros-args -e /e"
    words = line.replace("'text:=a: {'", "text:=a:_{").split()
    found = split_ros_arguments([word.replace("_{", " {") for word in words])
    assert found.arguments == ("-x", "own")
    assert (found.name, found.namespace) == ("n", "/a/b")
    assert found.remappings == (("old", "new"), ("c", "d"))
    assert found.parameters == ({"gain": 1.5}, {"other:on": True}, {"text": "a: {"}, Path("/p.yaml"))
    assert found.log_levels == (("", "debug"), ("rcl", "warn"))


def test_an_option_without_its_value_is_the_last_word():
    assert split_ros_arguments(["--ros-args", "-r"]).remappings == (("", ""),)
    assert split_ros_arguments([]) == RosArguments(())


def test_a_nodes_own_arguments_come_before_those_for_all_nodes():
    """The first remapping rule that matches wins, and the last value of a parameter."""
    own = RosArguments(("-x",), "n", None, (("a", "b"),), ({"p": 1},), (("", "info"),))
    others = RosArguments(("-y",), "m", "/s", (("a", "c"),), ({"p": 2},), (("rcl", "warn"),))
    found = own.before(others)
    assert (found.arguments, found.name, found.namespace) == (("-x",), "n", "/s")
    assert found.remappings == (("a", "b"), ("a", "c"))
    assert found.parameters == ({"p": 2}, {"p": 1})
    assert found.log_levels == (("", "info"), ("rcl", "warn"))


@pytest.mark.parametrize(
    "value", [True, 3, 0.25, -1e-7, "plain", "1.0", "true", "a: b", "ä # ö", (1, 2), ("x", "y"), ""]
)
def test_values_are_read_as_they_were_written(value):
    written = ros_arguments("n", "/s", [("a", "b")], [Path("/p.yaml"), {"p": value}])
    found = split_ros_arguments(written)
    assert found.parameters == (Path("/p.yaml"), {"p": value})
    assert type(found.parameters[1]["p"]) is type(value)
    assert (found.arguments, found.name, found.namespace, found.remappings) == ((), "n", "/s", (("a", "b"),))


def test_nothing_to_say_needs_no_arguments():
    assert ros_arguments("", "", [], []) == ()
    assert ros_arguments("n", "", [], []) == ("--ros-args", "-r", "__node:=n")


def test_names_of_parameters_in_rules_are_those_that_rcl_accepts():
    """What rcl 9.2 answers to each; `qos_overrides` have a topic's name between dots."""
    fine = [
        "a/b",
        "a./b/c",
        "a.b",
        "/a",
        "a//b",
        "n:a./b",
        "a/",
        "a.b/",
        "a._b",
        "a__b",
        "a./",
        "qos_overrides./t.publisher.depth",
    ]
    bad = [
        "~a",
        "~/a",
        "a..b",
        "a-b",
        "a.-b",
        "a.*",
        "**",
        "a.**.b",
        "a.1",
        "1a",
        "a.",
        "a~b",
        "{a}",
        "a./b-c",
        "a.__b",
        "__ns",
        "./a",
        "a/1",
        "a/b-c.d",
    ]
    found = []
    for name in (*fine, *bad):
        try:
            check_ros_arguments(["--ros-args", "-p", f"{name}:=1"])
        except RosArgumentsError:
            continue
        found.append(name)
    assert found == fine
