"""A run as one page. What is in it is read back from Meshcat's own commands in the page."""

import base64
import re

import pytest
import umsgpack
from conftest import rovers

from drake_twin import Twin
from drake_twin.cockpit.html_recording import HtmlRecording
from drake_twin.cockpit.scene import Scene


@pytest.fixture
def drawn():
    return Scene(), Twin(rovers(1).scenario())


def key_times(html):
    """The times (in frames) of the recorded key frames."""
    commands = re.search(r'id="commands">([^<]*)<', html)[1].split()
    for text in commands:
        command = umsgpack.unpackb(base64.b64decode(text))
        if command["type"] == "set_animation":
            return [
                key["time"]
                for animation in command["animations"]
                for track in animation["clip"]["tracks"]
                for key in track["keys"]
            ]
    return []


def test_the_run_is_in_the_page_from_begin_to_end_in_simulation_time(drawn):
    scene, twin = drawn
    recording = HtmlRecording(scene, twin)
    twin.advance_to(1.0)  # as fast as it goes: the pictures are a matter of simulation time
    html = recording.finish()
    times = set(key_times(html))
    assert min(times) == 0
    assert max(times) == 64
    assert len(times) == 33
    assert "http://" not in re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL)


def test_a_reset_begins_the_recording_anew(drawn):
    scene, twin = drawn
    recording = HtmlRecording(scene, twin)
    twin.advance_to(1.0)
    twin.reset()
    twin.advance_to(0.25)
    assert max(key_times(recording.finish())) == 16


def test_recording_does_not_change_the_run(drawn):
    scene, twin = drawn
    recording = HtmlRecording(scene, twin)
    twin.advance_to(0.5)
    recording.finish()
    plain = rovers(1).build()
    plain.advance_to(0.5)
    assert twin.state_sha256() == plain.state_sha256()
    twin.advance_to(0.6)  # and nothing is recorded any more
    assert twin._session.subscriptions._items == []
