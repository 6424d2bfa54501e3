"""Ten thousand topics, a connection that is lost amid something, two pages, and a slow one, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from dataclasses import replace

import pytest
from browser import BROWSER_TESTS, browser, draw, folder, open_tab, page, show
from conftest import rovers
from in_scene import item, look_at, place_of, tools
from page_states import PLOT
from robots_to_steer import WHEELS_1
from show_menu import press, switch
from test_page_capture import KEEP, saved

from drake_twin.cockpit import topics_panel

pytestmark = BROWSER_TESTS

NODES = "document.querySelectorAll('*').length"
BUSY = """() => {
  const work = () => {
    const end = performance.now() + 400;
    while (performance.now() < end);
    window.busy = setTimeout(work, 10);
  };
  work();
}"""


def test_ten_thousand_topics_are_filtered_and_found(page, monkeypatch):
    it, tab = page
    before = tab.evaluate(NODES)
    own = it.twin.graph.endpoints
    like = next(each for each in own if each.name == "/robot_1/joint_states")
    many = (*own, *(replace(like, name=f"/fleet/robot_{index}/battery") for index in range(10_000)))
    monkeypatch.setattr(topics_panel, "all_endpoints", lambda twin, known: many)
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Topics").press("Enter")
    names = tab.locator(".topics button")
    it.frames(lambda: names.count() > 30)
    assert tab.evaluate(NODES) < before + 400
    tab.get_by_label("Filter topics").press_sequentially("robot_9876")
    assert [text.splitlines()[0] for text in names.all_inner_texts()] == ["/fleet/robot_9876/battery"]
    tab.keyboard.press("Control+k")
    tab.keyboard.type("9876 battery")
    it.frames(lambda: tab.locator("#palette li span").all_inner_texts() == ["/fleet/robot_9876/battery"])
    assert tab.evaluate(NODES) < before + 400


def test_a_video_is_saved_though_the_connection_is_lost(page):
    it, tab = page
    open_tab(tab, "View")
    draw(tab)
    tab.evaluate(KEEP)
    tab.get_by_role("button", name="Video").press("Enter")
    it.frames(lambda: tab.evaluate("window.recorded") > 1000)
    it.is_cut = True
    it.served.server.close()
    tab.locator("#connection").wait_for(state="visible")
    head, film = saved(it, tab)
    assert head.startswith("data:video/")
    assert len(film) > 1000


def test_what_is_dragged_while_the_connection_is_lost_is_let_go(page):
    it, tab = page
    it.frames(lambda: tools(tab, "entityAt !== null"))
    look_at(tab, "robot_1")
    it.for_frames(3)
    across, up = place_of(tab, it.twin.entities.state("robot_1").position)
    tab.keyboard.down("Control")
    tab.mouse.move(across, up)
    tab.mouse.down()
    tab.mouse.move(across, up - 60, steps=4)
    it.frames(lambda: len(it.twin.snapshot().wrenches["items"]) == 1)
    it.is_cut = True
    (client,) = it.served.server._clients.values()
    it.served.server._loop.call_soon_threadsafe(client.socket._req.transport.abort)
    tab.mouse.up()  # of which the twin does not hear
    tab.keyboard.up("Control")
    it.frames(lambda: it.twin.snapshot().wrenches["items"] == [])
    it.frames(lambda: tab.locator("#connection").is_hidden())


def test_two_pages_show_what_each_has_chosen(page):
    it, one = page
    press(one, "Names")
    press(one, "Contact forces")
    open_tab(one, "World")
    other = it.tab()  # of another browser
    it.frames(lambda: switch(other, "Contact forces").is_checked())  # the twin draws them
    assert not switch(other, "Names").is_checked()
    press(other, "Collision shapes")
    it.frames(lambda: switch(one, "Collision shapes").is_checked())
    open_tab(other, "ROS")
    other.evaluate(PLOT, f"{WHEELS_1[: WHEELS_1.index('/', 1)]}/joint_states.velocity[robot_1_front_left_wheel_joint]")
    it.frames(lambda: other.locator("#plots .legend .unit").all_inner_texts() == ["rad/s"])
    other.reload()
    it.frames(lambda: other.locator("body.ready").count() == 1)
    it.for_frames(10)
    names = [tab.frame_locator("#scene").locator(".name") for tab in (one, other)]
    assert [each.count() for each in names] == [2, 0]
    assert sorted(it.cockpit._overlays) == ["collision", "contacts"]
    assert one.locator("#plots").is_hidden()
    assert one.locator("[role=tab][aria-selected=true]").inner_text() == "World"


def test_a_page_that_hardly_runs_holds_neither_the_twin_nor_another_page(show):
    alone = rovers(2).command(WHEELS_1, [2.0, 2.0, 2.0, 2.0]).build()
    alone.advance_to(3.0)
    it, slow = show(rovers(2).command(WHEELS_1, [2.0, 2.0, 2.0, 2.0]).scenario())
    quick = it.tab()
    it.twin.reset()
    slow.evaluate(BUSY)
    told = set()

    def each_frame():
        it.cockpit.process_requests()
        told.add(quick.locator("#time").inner_text())

    it.twin.run(until=3.0, each_frame=each_frame)
    assert it.twin.state_sha256() == alone.state_sha256()
    assert len(told) > 5
    for client in it.served.server._clients.values():
        assert client.socket._req.transport.get_write_buffer_size() < 5_000_000
    slow.evaluate("clearTimeout(window.busy)")
    text = f"{it.twin.time:.3f} s"
    it.twin.pause()
    it.frames(lambda: slow.locator("#time").inner_text() == text)
