"""A page that outlives its twin, as with ``--watch``."""

from pathlib import Path
from urllib.request import url2pathname

import pytest
from conftest import rovers

from drake_twin import Twin
from drake_twin.cockpit import protocol, served_page
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.cockpit.served_page import ServedPage


@pytest.fixture
def served():
    page = ServedPage()
    yield page
    page.close()


def test_a_new_twin_takes_the_place_of_the_one_before(served):
    first, second = Twin(rovers(1).scenario()), Twin(rovers(2).scenario())
    before = served.show(first)
    served.server._enqueue(1, protocol.Show("collision", True))
    before.process_requests()
    assert served.scene.has_path(f"{OVERLAYS}/collision")
    after = served.show(second)
    assert not served.scene.has_path(f"{OVERLAYS}/collision")
    served.server._enqueue(1, protocol.Step(3))
    after.process_requests()
    assert (first.clock.step_count, second.clock.step_count) == (0, 3)


def test_a_twin_that_is_only_displayed_stands_still(served):
    twin = Twin(rovers(1).scenario())
    served.show(twin, only_displayed=True)
    assert twin.clock.paused


def test_the_browsers_command_line_has_no_key(served, monkeypatch, tmp_path, capsys):
    opened = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", opened.append)
    served.announce(open_browser=False)
    assert opened == []
    served.announce(open_browser=True)
    (address,) = opened
    file = Path(url2pathname(address.removeprefix("file://")))
    assert served.server.access.key not in address
    assert file.stat().st_mode & 0o777 == 0o600
    assert f"url={served.url}" in file.read_text()
    assert capsys.readouterr().out == 2 * f"page: {served.url}\n"


def test_without_a_private_place_for_its_address_no_browser_is_opened(served, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(served_page, "cache_folder", lambda name: tmp_path / "nowhere")
    monkeypatch.setattr("webbrowser.open", None)
    served.announce(open_browser=True)
    assert "no browser is opened: its address cannot be kept from other users" in capsys.readouterr().err


def test_two_programs_have_pages_of_their_own(served):
    other = ServedPage()
    assert served.server.access.port != other.server.access.port
    other.close()
