"""Parameters as a typed class, whose bounds are generate_parameter_library's: gt, gt_eq, lt_eq, one_of, not_empty."""

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from math import isnan, nan

import pytest

from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import ParameterError, parameter_names, read_parameters
from drake_twin.errors import InputError


@dataclass(frozen=True)
class Gains:
    p: float = 0.0
    i: float = field(default=0.0, metadata={"lower": 0.0})


@dataclass(frozen=True)
class Parameters:
    joints: tuple[str, ...]
    wheelbase: float = field(default=1.0, metadata={"above": 0.0})
    limit: float = field(default=nan, metadata={"lower": -1.0, "upper": 2.0})
    mode: str = field(default="fast", metadata={"choices": ("fast", "slow")})
    frame: str = field(default="base", metadata={"not_empty": True})
    window: int = field(default=1, metadata={"unsupported": "nothing is averaged"})
    gains: Mapping[str, Gains] = field(default_factory=dict)

    def __post_init__(self):
        if self.mode == "slow" and self.limit > 1.0:
            raise ParameterError("slow is slower than that", "limit")


def read(**given):
    return read_parameters(Parameters, ControllerParameters("c", "p/Kind", {"joints": ["a"]} | given))


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"wheelbase": 1e-9}, None),
        ({"wheelbase": 0.0}, "0.0 is not above 0"),
        ({"wheelbase": nan}, "nan is not a number"),
        ({"limit": -1.0}, None),
        ({"limit": -1.1}, "-1.1 is below -1"),
        ({"limit": 2}, None),
        ({"limit": 2.1}, "2.1 is above 2"),
        ({"limit": nan}, None),  # its default, for no limit
        ({"mode": "slow"}, None),
        ({"mode": "sow"}, "unknown value 'sow'.*Did you mean 'slow'.*Valid: fast, slow"),
        ({"mode": "slow", "limit": 1.5}, "slow is slower than that"),
        ({"frame": ""}, "frame is empty"),
        ({"joints": []}, "the list is empty"),
        ({"joints": "a"}, "'a' is not a list"),
        ({"gains": {"a": {"i": -1.0}}}, "-1.0 is below 0"),
        ({"gains": 3}, "3 is not a mapping"),
    ],
)
def test_a_value_is_taken_up_to_its_bounds(given, text):
    with nullcontext() if text is None else pytest.raises(InputError, match=f"^controller 'c': .*{text}"):
        found, findings = read(**given)
        assert findings == ()
        assert all(str(getattr(found, name)) == str(value) or value == 2 for name, value in given.items())


def test_what_is_not_given_is_its_default_and_what_is_required_is_missed():
    found, _ = read()
    assert (found.joints, found.wheelbase, found.mode, found.gains) == (("a",), 1.0, "fast", {})
    assert isnan(found.limit)
    with pytest.raises(InputError, match="the parameter 'joints' is missing"):
        read_parameters(Parameters, ControllerParameters("c", "p/Kind", {}))


def test_nested_names_may_be_dotted():
    assert read(**{"gains.a.p": 2.0, "gains": {"b": {"i": 3}}})[0].gains == {"a": Gains(p=2.0), "b": Gains(i=3.0)}


def test_unknown_and_unused_parameters_are_findings_and_those_of_every_node_are_not():
    found, findings = read(use_sim_time=True, update_rate=50, whelbase=2.0, window=3)
    assert found.window == 3
    assert [item.what for item in findings] == [
        "controller c: unknown parameter 'whelbase': it is ignored",
        "controller c: window is ignored: nothing is averaged",
    ]
    assert read(window=1)[1] == ()


def test_the_names_of_parameters_have_dots_and_any_joint():
    names = [name for name, _, _ in parameter_names(Parameters)]
    assert names[0] == "joints"
    assert names[-2:] == ["gains.<joint>.p", "gains.<joint>.i"]
