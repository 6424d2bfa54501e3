"""What is sent of a draft is, byte for byte, the message on the port: made by Drake's ports and by rosbags."""

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers

from drake_twin import TwinBuilder
from drake_twin.messages.draft import Drafter
from drake_twin.messages.interface_types import serialize


def drafted(twin):
    """The topics that are drafted, with the bytes of the draft and of the port, and the two messages."""
    reading = twin.graph.read()
    for name, item in twin._session.built.published.items():
        if item.drafter is not None and (whole := twin.latest(name)) is not None:
            draft = twin.graph.draft(name, reading)
            yield name, draft.serialized(), serialize(whole), draft.message()


def mixed():
    builder = TwinBuilder()
    builder.robot("robot_1", ROVER, xyz=(0, 0, 0.13))
    builder.robot("robot_2", ROVER, xyz=(0, 2, 0.13))
    builder.robot("arm", ARM, xyz=(3, 0, 0))
    return builder.build()


def test_drafts_have_the_bytes_of_the_messages():
    twin = mixed()
    twin.publish("/robot_2/forward_velocity_controller/commands", [3.0, -2.0, 1.0, 5.0])
    for time in (0.0, 0.013, 0.5):
        twin.advance_to(time)
        found = list(drafted(twin))
        kinds = {name.rpartition("/")[2] for name, *_ in found}
        assert kinds == {"joint_states", "dynamic_joint_states", "tf", "clock", "odom"}
        assert len(found) == 3 * 3 + 2
        for name, data, whole, message in found:
            assert data == whole, name
            assert serialize(message) == whole, name


def test_the_numbers_are_those_of_the_time_of_the_reading():
    twin = rovers(1).build()
    twin.publish("/robot_1/forward_velocity_controller/commands", [3.0] * 4)
    twin.advance_to(0.3)
    reading = twin.graph.read()
    drafts = {
        name: twin.graph.draft(name, reading) for name, item in twin._session.built.published.items() if item.drafter
    }
    whole = {name: serialize(twin.latest(name)) for name in drafts}
    twin.advance_to(0.4)
    assert {name: draft.serialized() for name, draft in drafts.items()} == whole


@pytest.mark.parametrize(
    ("change", "placed"), [(np.flip, True), (np.cbrt, False), (np.abs, False), (lambda data: data[:1], True)]
)
def test_numbers_that_are_not_placed_unchanged_are_written_by_rosbags(change, placed):
    from drake_twin import messages

    def make(time, numbers):
        made.append(time)
        return messages.Float64MultiArray(messages.MultiArrayLayout([], 0), np.array(change(numbers)))

    made = []
    drafter = Drafter(lambda reading: None, lambda values: values, make, 3)
    numbers = np.array([-1.0, 2.0, np.nan])
    assert drafter.serialized(0.1, numbers) == serialize(make(0.1, numbers))
    made.clear()
    for _ in range(5):
        drafter.serialized(0.1, numbers)
    assert len(made) == (0 if placed else 5)


def test_bytes_of_stamps_and_numbers_need_no_messages_once_their_places_are_known():
    from drake_twin import messages

    def make(time, numbers):
        made.append(time)
        return messages.Vector3Stamped(messages.header(time, "world"), messages.Vector3(*numbers.tolist()))

    made = []
    drafter = Drafter(lambda reading: None, lambda values: values, make, 3)
    expected = [serialize(make(0.1 * k, np.array([k, -k, 0.5]))) for k in range(9)]
    drafter.serialized(0.0, np.zeros(3))
    made.clear()
    assert [drafter.serialized(0.1 * k, np.array([k, -k, 0.5])) for k in range(9)] == expected
    assert made == []
