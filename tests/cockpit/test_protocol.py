import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drake_twin.cockpit import protocol
from drake_twin.cockpit.protocol import parse


@pytest.mark.parametrize(
    ("message", "request_"),
    [
        ({"do": "Play"}, protocol.Play()),
        ({"do": "Step", "count": 5}, protocol.Step(5)),
        ({"do": "RunTo", "time": 2}, protocol.RunTo(2.0)),
        ({"do": "Look", "time": 1.5}, protocol.Look(1.5)),
        ({"do": "LookAtNow"}, protocol.LookAtNow()),
        ({"do": "LookAtEfforts"}, protocol.LookAtEfforts()),
        ({"do": "GoOnFrom", "time": 1}, protocol.GoOnFrom(1.0)),
        ({"do": "Switch", "robot": "r", "controller": "c", "active": True}, protocol.Switch("r", "c", True)),
        ({"do": "SwitchTo", "robot": "r", "controller": "c"}, protocol.SwitchTo("r", "c")),
        ({"do": "MoveJoint", "topic": "/t", "index": 1, "value": 0.5}, protocol.MoveJoint("/t", 1, 0.5)),
        ({"do": "Follow", "robot": ""}, protocol.Follow("")),
        ({"do": "Follow", "robot": "x" * 1000}, protocol.Follow("x" * 1000)),
        ({"do": "Step", "count": 1}, protocol.Step(1)),
        ({"do": "Step", "count": 10_000}, protocol.Step(10_000)),
        ({"do": "MoveJoint", "topic": "", "index": 2**31 - 1, "value": -1}, protocol.MoveJoint("", 2**31 - 1, -1.0)),
    ],
)
def test_a_request_reads_as_what_it_asks_for(message, request_):
    assert parse(json.dumps(message)) == request_


@pytest.mark.parametrize(
    "text",
    [
        "",
        "null",
        "[]",
        "{}",
        '"Play"',
        "{",
        '{"do": "play"}',
        '{"do": "Gone"}',  # the server's word, not a browser's
        '{"do": "__class__"}',
        '{"do": ["Play"]}',
        '{"do": "Play", "more": 1}',
        '{"do": "Step"}',
        '{"do": "Step", "count": 0}',
        '{"do": "Step", "count": 10001}',
        '{"do": "Step", "count": 1.5}',
        '{"do": "Step", "count": true}',
        '{"do": "Step", "count": "1"}',
        '{"do": "MoveJoint", "topic": "/t", "index": 2147483648, "value": 0}',
        '{"do": "SetRate", "rate": true}',
        '{"do": "SetRate", "rate": NaN}',
        '{"do": "SetRate", "rate": Infinity}',
        '{"do": "SetRate", "rate": null}',
        '{"do": "SetRate", "rate": 1e999}',
        '{"do": "SetRate", "rate": ' + "9" * 400 + "}",
        '{"do": "SetRate", "rate": ' + "9" * 5000 + "}",
        '{"do": "Delete", "robot": 1}',
        '{"do": "SwitchTo", "robot": "r"}',
        '{"do": "SwitchTo", "robot": "r", "controller": "c", "active": true}',
        '{"do": "Delete", "robot": "a\\u0000"}',
        json.dumps({"do": "Delete", "robot": "x" * 1001}),
        "[" * 100_000,
    ],
)
def test_whatever_does_not_read_as_a_request_is_nothing(text):
    assert parse(text) is None


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda below: st.lists(below) | st.dictionaries(st.text(), below),
)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.sampled_from(sorted(protocol._KINDS)), st.dictionaries(st.sampled_from(["robot", "count", "xyz", "on"]), JSON)
)
def test_no_message_raises(kind, fields):
    parse(json.dumps({"do": kind, **fields}))
