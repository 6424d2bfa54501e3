"""Declared parameters: what generate_parameter_library and rclcpp of Jazzy make of the tables of ros2_controllers."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan, nextafter
from typing import ClassVar

import pytest

from drake_twin.controllers.joint_state_broadcaster import JointStateBroadcasterParameters
from drake_twin.controllers.joint_trajectory_parameters import JointTrajectoryGains, JointTrajectoryParameters
from drake_twin.controllers.registry import controller_class, controller_types
from drake_twin.description.declared_parameters import declared_parameters
from drake_twin.description.parameters import parameter_names


@dataclass(frozen=True)
class Gains:
    """Of one joint.

    Attributes:
        p: The ``p`` gain.
    """

    p: float = field(default=0.0, metadata={"lower": -1.0})
    kind: str = "a"


@dataclass(frozen=True)
class Made:
    """Parameters.

    Attributes:
        joints: The joints.
        gains: The gains.
    """

    read_only: ClassVar[tuple[str, ...]] = ("joints", "gains.<joint>.kind")
    live: ClassVar[tuple[str, ...]] = ("gains.*",)

    joints: tuple[str, ...]
    count: int = field(default=3, metadata={"above": 0, "upper": 9})
    width: float = field(default=0.5, metadata={"above": 0.0})
    mode: str = field(default="x", metadata={"choices": ("x", "y")})
    parts: tuple[str, ...] = field(default=(), metadata={"choices": ("x", "y")})
    name: str = field(default="n", metadata={"not_empty": True})
    hidden: float = field(default=0.0, metadata={"not_of_files": "of plugins"})
    gains: Mapping[str, Gains] = field(default_factory=dict, metadata={"keys": "joints"})


@pytest.fixture
def made():
    return {item.name: item for item in declared_parameters(Made(("a", "b"), gains={"a": Gains(p=2.0)}))}


def test_types_values_and_texts(made):
    """The types are those of rcl_interfaces/msg/ParameterType."""
    assert {name: (item.type, item.value) for name, item in made.items()} == {
        "joints": (9, ("a", "b")),
        "count": (2, 3),
        "width": (3, 0.5),
        "mode": (4, "x"),
        "parts": (9, ()),
        "name": (4, "n"),
        "gains.a.p": (3, 2.0),
        "gains.b.p": (3, 0.0),
        "gains.a.kind": (4, "a"),
        "gains.b.kind": (4, "a"),
    }
    assert made["gains.b.p"].description == "The gains; The `p` gain"
    assert made["mode"].constraints == "one of x, y"


def test_ranges_are_closed_as_generate_parameter_library_declares_them(made):
    """gt<> begins at the next number, and what has one bound ends at the largest number of its type."""
    assert made["count"].bounds == (1, 9)
    assert made["width"].bounds == (nextafter(0.0, 1.0), sys.float_info.max)
    assert made["gains.a.p"].bounds == (-1.0, sys.float_info.max)
    assert made["mode"].bounds is None


def test_patterns_say_what_can_be_set_and_when(made):
    assert [name for name, item in made.items() if item.is_read_only] == ["joints", "gains.a.kind", "gains.b.kind"]
    assert [name for name, item in made.items() if item.is_live] == ["gains.a.p", "gains.b.p"]


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("joints", ["c"], "parameter 'joints' cannot be set because it is read-only"),
        ("count", 9, ""),
        ("count", 0, "Parameter {count} doesn't comply with integer range."),
        (
            "count",
            2.0,
            "Wrong parameter type, parameter {count} is of type {integer}, setting it to {double} is not allowed.",
        ),
        ("count", None, "Wrong parameter type, parameter {count} is of type {integer}, setting it to {not set} is not"),
        ("width", 0.0, "Parameter {width} doesn't comply with floating point range."),
        ("width", nan, ""),
        ("mode", "y", ""),
        ("mode", "z", "Parameter 'mode' with the value 'z' is not in the set '{x, y}'"),
        ("parts", ["y", "z"], "Entry 'z' in parameter 'parts' is not in the set '{x, y}'"),
        ("parts", [], ""),
        ("parts", "y", "Wrong parameter type, parameter {parts} is of type {string_array}, setting it to {string} is"),
        ("name", "", "Parameter 'name' cannot be empty"),
    ],
)
def test_a_value_is_refused_in_the_words_of_rclcpp_and_rsl(made, name, value, reason):
    """node_parameters.cpp and parameter_type of rclcpp, and parameter_validators.hpp of RSL."""
    refusal = made[name].refusal(value)
    assert refusal.startswith(reason)
    assert bool(refusal) == bool(reason)


def test_a_trajectory_controller_declares_the_parameters_of_its_table():
    """Names and which are read-only: joint_trajectory_controller_parameters.yaml of Jazzy, with one joint."""
    of_joint = "i d i_clamp i_clamp_max i_clamp_min ff_velocity_scale u_clamp_max u_clamp_min tracking_time_constant"
    settable = {
        *("allow_partial_joints_goal", "allow_integration_in_goal_trajectories", "cmd_timeout"),
        *("set_last_command_interface_value_as_state_on_activation", "allow_nonzero_velocity_at_trajectory_end"),
        *(f"gains.j.{name}" for name in ("p", *of_joint.split(), "error_deadband")),
        *("constraints.stopped_velocity_tolerance", "constraints.goal_time"),
        *("constraints.j.trajectory", "constraints.j.goal"),
    }
    read_only = {
        *("joints", "command_joints", "command_interfaces", "state_interfaces", "open_loop_control"),
        *(f"speed_scaling.{name}" for name in ("initial_scaling_factor", "state_interface", "command_interface")),
        *("interpolate_from_desired_state", "action_monitor_rate", "interpolation_method"),
        *("gains.j.antiwindup_strategy", "constraints.decelerate_on_cancel"),
        "constraints.j.max_deceleration_on_cancel",
    }
    given = JointTrajectoryParameters(("j",), ("position",), ("position",), gains={"j": JointTrajectoryGains(p=1.0)})
    found = {item.name: item.is_read_only for item in declared_parameters(given)}
    assert found == dict.fromkeys(settable, False) | dict.fromkeys(read_only, True)


def test_a_broadcaster_has_only_read_only_ones():
    assert all(item.is_read_only for item in declared_parameters(JointStateBroadcasterParameters()))


@pytest.mark.parametrize("kind", controller_types())
def test_each_pattern_is_that_of_a_parameter(kind):
    from fnmatch import fnmatchcase

    parameters = controller_class(kind).Parameters
    names = [name for name, *_ in parameter_names(parameters)]
    for pattern in (*getattr(parameters, "read_only", ()), *getattr(parameters, "live", ())):
        assert any(fnmatchcase(name, pattern) for name in names), pattern
