"""What is measured of a topic, by hand and beside a running twin."""

from argparse import Namespace

import pytest
from tools.two_rovers import tool_of_two_rovers

from drake_twin import messages
from drake_twin.tools import topic
from drake_twin.tools.topic_meters import bandwidth_text, delay, delay_text


def test_bandwidths_by_hand():
    second = 1_000_000_000
    assert bandwidth_text([(0, 100), (second // 2, 300)], second) == (
        "400 B/s from 2 messages\n\tMessage size mean: 200 B min: 100 B max: 300 B"
    )
    assert bandwidth_text([(0, 1000), (second, 3000)], 2 * second) == (
        "2.00 KB/s from 2 messages\n\tMessage size mean: 2.00 KB min: 1.00 KB max: 3.00 KB"
    )
    assert bandwidth_text([(0, 4_000_000)], 2 * second).startswith("2.00 MB/s from 1 messages\n")


@pytest.mark.parametrize(
    ("size", "text"),
    [
        (999, "999 B/s"),
        (1000, "1.00 KB/s"),
        (999_990, "999.99 KB/s"),
        (1_000_000, "1.00 MB/s"),
        (1_500_000, "1.50 MB/s"),
    ],
)
def test_a_bandwidth_is_in_the_largest_unit_that_is_less(size, text):
    """As ``ros2 topic bw`` has it: of 1000 and of 1000000 bytes a second."""
    assert bandwidth_text([(0, size)], 1_000_000_000).startswith(f"{text} from 1 messages\n")


def test_delays_by_hand():
    assert delay_text([1_000_000, 3_000_000]) == (
        "average delay: 0.002\n\tmin: 0.001s max: 0.003s std dev: 0.00100s window: 2"
    )


class Interrupted:
    """A message that comes as Ctrl-C does."""

    @property
    def header(self):
        raise KeyboardInterrupt


class Client:
    """Hears three messages at 12.5 s of simulation time."""

    def subscribe(self, topic, heard, **_):
        stamped = [messages.JointState(messages.header(time), [], [], [], []) for time in (12.3, 11.9)]
        of_topic = {"/clock": [messages.Clock(messages.time_message(12.5))], "/joint_states": [*stamped, Interrupted()]}
        for message in of_topic[topic]:
            heard(message)


def test_a_delay_is_the_time_since_the_stamp_by_the_twins_clock(capsys):
    assert delay(Client(), Namespace(topic_name="/joint_states", window=10, use_sim_time=True)) == 0
    assert capsys.readouterr().out == ("average delay: 0.400\n\tmin: 0.200s max: 0.600s std dev: 0.20000s window: 2\n")


@pytest.fixture
def tool(capsys, monkeypatch):
    with tool_of_two_rovers(capsys, monkeypatch) as tool:
        yield tool


def test_what_cannot_be_measured(tool):
    assert "no header" in tool.refused(topic, "delay", "/clock")
    assert "at least one message" in tool.refused(topic, "bw", "/clock", "-w", "0")
