"""Messages, banners and several tabs of the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from browser import BROWSER_TESTS, browser, page, show
from robots_to_steer import WHEELS_1

pytestmark = BROWSER_TESTS


def test_messages_are_on_a_line_and_all_of_them_in_a_list(page):
    it, tab = page
    it.twin.control.manager("robot_1").switch_controller(deactivate=["forward_velocity_controller"])
    it.twin.publish(WHEELS_1, [1, 1, 1, 1])
    it.frames(lambda: "no controller hears this" in tab.locator("#message-text").inner_text())
    tab.locator("#messages-toggle").click()
    assert "no controller hears this" in tab.locator("#messages li").last.inner_text()


def test_what_is_refused_is_said(page):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.1)
    tab.get_by_label("Run to time in seconds").fill("0.0001")
    tab.get_by_role("button", name="Go").click()
    it.frames(lambda: "lies in the past" in tab.locator("#message-text").inner_text())


def test_two_tabs_steer_one_twin_and_reloading_or_closing_one_changes_nothing(page):
    it, one = page
    other = it.tab()
    one.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.clock.paused)
    it.frames(lambda: other.get_by_role("button", name="Play", exact=True).count() == 1)
    other.get_by_role("button", name="Play", exact=True).click()
    it.frames(lambda: not it.twin.clock.paused)
    start = it.twin.time
    one.reload()
    it.frames(lambda: one.locator("body.ready").count() == 1)
    it.frames(lambda: it.twin.time > start + 0.2)
    other.close()
    it.tabs.remove(other)
    it.frames(lambda: len(it.served.server.clients) == 1)
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 0.2)
    one.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.clock.paused)


def test_a_page_whose_twin_has_ended_says_so(page):
    it, tab = page
    it.is_cut = True
    it.served.server.close()
    tab.locator("#connection").wait_for(state="visible")
    assert "open the address that it printed" in tab.locator("#connection").inner_text()
    assert tab.locator("#stop-all").evaluate("node => node.inert")
    assert tab.locator("#panel").evaluate("node => node.inert")
    tab.keyboard.press("Space")
    assert "did not reach it" in tab.locator("#connection").inner_text()


def test_a_stop_is_red_until_the_twin_has_confirmed_it(page):
    it, tab = page
    tab.get_by_role("button", name="Stop all").click()
    assert "waiting" in tab.locator("#stop-all").get_attribute("class")  # the twin's thread is not at work
    it.frames(lambda: all(it.twin.control.is_stopped(robot) for robot in it.twin.robots))
    it.frames(lambda: "waiting" not in (tab.locator("#stop-all").get_attribute("class") or ""))


def test_requests_that_are_not_processed_are_said_to_be_pending(page):
    it, tab = page
    tab.locator("#connection", has_text="has processed no requests for").wait_for(
        state="visible"
    )  # the test does not call process_requests
    it.frames(lambda: not tab.locator("#connection").is_visible())
