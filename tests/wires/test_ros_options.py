"""The options of ``--ros``: which go together, and what the first wire says of itself."""

import argparse
from contextlib import nullcontext
from types import SimpleNamespace

import pytest

from drake_twin.errors import InputError
from drake_twin.wires.kinds.ros import RosKind
from drake_twin.wires.namespaced_wire import NamespacedWire


def options(*words):
    parser = argparse.ArgumentParser()
    RosKind().add_options(parser.add_argument_group("ros"))
    return parser.parse_args(words)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ((), None),
        (("--ros", "zenoh"), None),
        (("--ros", "zenoh", "--ros-router", "x"), None),
        (("--ros", "zenoh", "--ros-host", "0.0.0.0"), None),
        (("--ros", "dds", "--ros-host", "0.0.0.0"), None),
        (("--ros", "zenoh", "--ros-host", "0.0.0.0", "--ros-router", "x"), "give one of them"),
        (("--ros", "zenoh", "--ros-port", "1024", "--ros-domain", "232", "--ros-namespace", "a/b"), None),
        (("--ros", "zenoh", "--ros-port", "65535", "--ros-domain", "0"), None),
        (("--ros", "zenoh", "--ros-port", "1023"), "--ros-port 1023: the router's port must be from 1024 to 65535"),
        (("--ros", "zenoh", "--ros-port", "65536"), "--ros-port 65536"),
        (("--ros", "dds", "--ros-port", "7447"), "--ros-port is not for --ros dds: it needs --ros zenoh"),
        (("--ros", "rclpy", "--lockstep"), None),
        (("--ros", "--ros-port", "7447"), None),
        (("--ros-port", "7447"), "--ros-port is about the ROS 2 graph: it needs --ros zenoh"),
        (("--ros", "zenoh", "--ros-args", "a:=b"), "--ros-args is not for --ros zenoh: it needs --ros rclpy"),
        (("--ros", "dds", "--lockstep"), "--lockstep is not for --ros dds: it needs --ros zenoh or rclpy"),
    ],
)
def test_options_that_go_together(words, problem):
    with nullcontext() if problem is None else pytest.raises(InputError, match=problem):
        RosKind().check(options(*words))


@pytest.mark.parametrize(
    ("transport", "module"),
    [("zenoh", "drake_twin.wires.zenoh_wire.ZenohWire"), ("dds", "drake_twin.wires.dds_wire.DdsWire")],
)
def test_only_the_first_of_several_wires_says_where_it_is_and_that_it_is_open(transport, module, monkeypatch, capsys):
    wire = SimpleNamespace(domain=7, place="open on 127.0.0.1")
    monkeypatch.setattr(module, lambda *where: wire)
    assert RosKind().open(options("--ros", transport), lambda name: None, is_first=True) is wire
    captured = capsys.readouterr()
    assert captured.out.startswith("ros: domain 7 over ")
    assert "this protocol has no token" in captured.err
    named = options("--ros", transport, "--ros-namespace", "left")
    assert isinstance(RosKind().open(named, lambda name: None, is_first=False), NamespacedWire)
    assert capsys.readouterr() == ("", "")
