"""Messages of nodes and the twin's own messages are made of each other without a bit of difference on the wire."""

import copy

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.interfaces import Nodetype

from drake_twin.messages.interface_types import class_of, deserialize, fields_of, known_names, known_packages, serialize
from drake_twin.messages.store import EMPTY, is_of_the_twin
from drake_twin.nodes.message_classes import from_wire, message_class, to_wire, type_name

FLOAT32_MAX = float(np.finfo("float32").max)
PARTS = {
    "msg": [""],
    "srv": ["_Request", "_Response"],
    "action": ["_Goal", "_Result", "_Feedback", "_FeedbackMessage", "_SendGoal_Request", "_GetResult_Response"],
}
TYPES = sorted(
    f"{package}/{kind}/{own}{part}"
    for package in known_packages()
    for kind, parts in PARTS.items()
    for own in known_names(package, kind)
    for part in parts
)
OTHERS = [name for name in TYPES if not is_of_the_twin(name.partition("/")[0])]
SLOW = {*OTHERS} - {*OTHERS[::20]}


def numbers(kind):
    if kind == "bool":
        return st.booleans()
    if kind.startswith("float"):
        # rosidl_generator_py refuses the greatest number of 32 bits: its limit is 3.402823466e38.
        return st.floats(width=int(kind[5:])).filter(lambda value: kind == "float64" or abs(value) != FLOAT32_MAX)
    limits = np.iinfo({"byte": "int8", "char": "uint8"}.get(kind, kind))
    return st.integers(int(limits.min), int(limits.max))


def texts(limit):
    return st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=limit or 8)


def values(description):
    """A strategy for a field, from rosbags' description of it."""
    node, details = description
    if node == Nodetype.NAME:
        return st.deferred(lambda: data(details))
    if node == Nodetype.BASE:
        kind, limit = details
        return texts(limit) if kind == "string" else numbers(kind)
    element, size = details
    least, most = (size, size) if node == Nodetype.ARRAY else (0, min(size or 3, 3))
    items = st.lists(values(element), min_size=least, max_size=most)
    if element[0] == Nodetype.NAME or element[1][0] == "string":
        return items
    kind = {"byte": "int8", "char": "uint8"}.get(element[1][0], element[1][0])
    return items.map(lambda found: np.array(found, dtype=kind))


def data(name):
    fields = {own: st.just(0) if own == EMPTY else values(description) for own, description in fields_of(name)[1]}
    return st.builds(class_of(name), **fields)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in TYPES]
)
def test_nothing_changes_on_the_way(name):
    @settings(max_examples=4, derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(data(name))
    def check(sent):
        sent_bytes = serialize(sent)
        for heard in (sent, deserialize(name, sent_bytes)):
            message = from_wire(name, heard)
            assert type(message) is message_class(name)
            assert type_name(type(message)) == name
            assert serialize(to_wire(message)) == sent_bytes
            assert serialize(to_wire(copy.deepcopy(message))) == sent_bytes
            # Each field can be assigned again, and be passed to the constructor.
            fields = {own: getattr(message, own) for own in message.get_fields_and_field_types()}
            assert serialize(to_wire(message_class(name)(check_fields=True, **fields))) == sent_bytes
            for own, value in fields.items():
                setattr(message, own, value)

    if fields_of(name)[1][0][0] == EMPTY:
        assert serialize(to_wire(message_class(name)())) == b"\0\1\0\0\0"
    else:
        check()


def test_a_message_shares_nothing_with_the_twins():
    made = message_class("sensor_msgs/msg/LaserScan")(ranges=[1.0, 2.0])
    sent = to_wire(made)
    made.ranges[0] = 9.0
    made.header.frame_id = "late"
    assert sent.ranges.tolist() == [1.0, 2.0]
    assert sent.header.frame_id == ""
    heard = from_wire("sensor_msgs/msg/LaserScan", sent)
    sent.ranges[1] = 9.0
    assert heard.ranges.tolist() == [1.0, 2.0]


def test_a_receiver_reads_a_number_of_32_bits_as_such():
    sent = to_wire(message_class("sensor_msgs/msg/LaserScan")(angle_min=0.1))
    heard = from_wire("sensor_msgs/msg/LaserScan", sent)
    assert heard.angle_min == float(np.float32(0.1)) != 0.1


def test_what_was_put_into_a_list_is_checked_before_it_is_sent():
    made = message_class("sensor_msgs/msg/JointState")(name=["a"])
    made.name.append(3)
    with pytest.raises(AssertionError, match=r"The 'name' field must be a set or sequence"):
        to_wire(made)
    unchecked = message_class("geometry_msgs/msg/Vector3")(check_fields=False, x=1)
    unchecked.y = 2
    with pytest.raises(AssertionError, match=r"The 'x' field must be of type 'float'"):
        to_wire(unchecked)
