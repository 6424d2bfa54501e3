import copy
import pickle

import pytest

from drake_twin.systems.no_message import NO_MESSAGE, empty_value, make_value, or_none, set_value


def test_a_port_without_a_message_is_false_and_none():
    held = empty_value().get_value()
    assert (bool(held), or_none(held)) == (False, None)
    assert make_value(None).get_value() is held is pickle.loads(pickle.dumps(copy.deepcopy(held))) is NO_MESSAGE


def test_a_message_that_is_set_is_held_until_none_is():
    output = empty_value()
    set_value(output, [])
    assert or_none(output.get_value()) == []  # which is false, but a message
    set_value(output, None)
    assert or_none(output.get_value()) is None


def test_a_field_of_no_message_says_why_it_is_not_there():
    with pytest.raises(AttributeError, match="no message has arrived, so it has no field 'twist'"):
        _ = NO_MESSAGE.twist
