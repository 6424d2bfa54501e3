"""What is measured of a topic, by hand and beside a running twin."""

import pytest
from tools.two_rovers import tool_of_two_rovers

from drake_twin.tools import topic
from drake_twin.tools.topic_meters import bandwidth_text, delay_text


def test_bandwidths_by_hand():
    second = 1_000_000_000
    assert bandwidth_text([(0, 100), (second // 2, 300)], second) == (
        "400 B/s from 2 messages\n\tMessage size mean: 200 B min: 100 B max: 300 B"
    )
    assert bandwidth_text([(0, 1000), (second, 3000)], 2 * second) == (
        "2.00 KB/s from 2 messages\n\tMessage size mean: 2.00 KB min: 1.00 KB max: 3.00 KB"
    )
    assert bandwidth_text([(0, 4_000_000)], 2 * second).startswith("2.00 MB/s from 1 messages\n")


def test_delays_by_hand():
    assert delay_text([1_000_000, 3_000_000]) == (
        "average delay: 0.002\n\tmin: 0.001s max: 0.003s std dev: 0.00100s window: 2"
    )


@pytest.fixture
def tool(capsys, monkeypatch):
    with tool_of_two_rovers(capsys, monkeypatch) as tool:
        yield tool


def test_what_cannot_be_measured(tool):
    assert "no header" in tool.refused(topic, "delay", "/clock")
    assert "at least one message" in tool.refused(topic, "bw", "/clock", "-w", "0")
