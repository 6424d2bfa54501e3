"""What a frame of the twin's thread does for open pages, counted: readings and wake-ups, and nothing for none."""

import asyncio
import threading
from collections import Counter
from urllib.request import urlopen

import pytest
from aiohttp import ClientSession
from conftest import rovers

from drake_twin.cockpit.served_page import ServedPage
from drake_twin.cockpit.topics_panel import TopicsPanel
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.twin import plant_parameters, touching
from drake_twin.twin.rewind import Rewind

FRAMES = 12


@pytest.fixture
def served():
    page = ServedPage()
    yield page
    page.close()


@pytest.fixture
def counts(monkeypatch):
    """How often some functions are called in this thread."""
    found = Counter()
    here = threading.get_ident()

    def count(owner, name):
        original = getattr(owner, name)

        def counted(*arguments, **named):
            found[name] += threading.get_ident() == here
            return original(*arguments, **named)

        monkeypatch.setattr(owner, name, counted)

    found.count = count
    count(SharedScene, "poses")
    count(TopicsPanel, "_listen")
    return found


def address(served):
    return f"http://127.0.0.1:{served.server.access.port}/{served.server.tokens.new()}/"


def with_a_page(served, cockpit, act):
    """Does something while a page and its scene are connected."""
    url = address(served)

    async def run():
        headers = {"Origin": url.rsplit("/", 2)[0]}
        async with (
            ClientSession() as session,
            session.ws_connect(f"{url}socket", headers=headers),
            session.ws_connect(f"{url}scene/socket", headers=headers) as scene,
        ):
            cockpit.process_requests()
            await scene.receive()
            act()

    asyncio.run(run())


def run_frames(twin, cockpit):
    for _ in range(FRAMES):
        twin.advance_to(twin.time + 1 / 30)
        cockpit.process_requests()


def test_a_frame_reads_the_poses_once_and_wakes_the_server_once(served, counts):
    twin = rovers(2).build()
    cockpit = served.show(twin)
    counts.count(served.server._loop, "call_soon_threadsafe")

    def act():
        counts.clear()
        run_frames(twin, cockpit)

    with_a_page(served, cockpit, act)
    assert counts["poses"] == FRAMES
    assert counts["call_soon_threadsafe"] == FRAMES  # poses and states together
    assert counts["_listen"] == 0  # nobody looks at topics


def test_without_a_page_nothing_is_read_and_nobody_is_woken(served, counts):
    twin = rovers(1).build()
    cockpit = served.show(twin)
    counts.count(served.server._loop, "call_soon_threadsafe")
    run_frames(twin, cockpit)
    assert not counts


def test_the_robots_are_read_while_a_browser_loads_the_page(served, counts):
    twin = rovers(1).build()
    cockpit = served.show(twin)
    with urlopen(address(served)) as answer:
        assert answer.status == 200
    cockpit.process_requests()
    assert counts["poses"] == 1
    assert served.scene.has_path("/twin/robot_1")
    with_a_page(served, cockpit, lambda: None)
    assert not served.server._expected  # it has come


def test_a_moment_that_is_kept_reads_no_friction_and_no_names_where_none_has_changed(counts):
    counts.count(plant_parameters, "_materials")
    counts.count(touching, "is_brake")
    twin = rovers(2).build()
    with Rewind(twin) as kept:
        twin.advance_to(0.6)
        counts.clear()
        twin.advance_to(3.1)
        assert len(kept.times) == 7
    assert not counts
