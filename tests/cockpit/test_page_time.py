"""The time controls of the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import math

import pytest
from browser import BROWSER_TESTS, browser, open_tab, page, show

pytestmark = BROWSER_TESTS


def test_the_play_button_pauses_and_goes_on(page):
    it, tab = page
    tab.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.clock.paused)
    stopped = it.twin.time
    it.for_frames(5)
    assert it.twin.time == stopped
    it.seen(tab.locator("#time"), f"{stopped:.3f} s")
    it.seen(tab.locator("#factor"), "paused")
    tab.get_by_role("button", name="Play", exact=True).click()
    it.frames(lambda: it.twin.time > stopped + 0.1)


def test_the_space_bar_pauses_also_after_a_click_into_the_scene(page):
    it, tab = page
    tab.locator("#scene").click()
    tab.keyboard.press("Space")
    it.frames(lambda: it.twin.clock.paused)
    it.frames(lambda: tab.get_by_role("button", name="Play", exact=True).count() == 1)
    tab.keyboard.press("Space")
    it.frames(lambda: not it.twin.clock.paused)


def test_step_makes_so_many_steps(page):
    it, tab = page
    it.twin.pause()
    before = it.twin.clock.step_count
    tab.get_by_label("Number of steps").fill("25")
    tab.get_by_role("button", name="Step", exact=True).click()
    it.frames(lambda: it.twin.clock.step_count == before + 25)
    tab.locator("#scene").click()
    tab.keyboard.press("n")
    it.frames(lambda: it.twin.clock.step_count == before + 50)
    assert it.twin.clock.paused


def test_run_to_stops_there(page):
    it, tab = page
    it.twin.pause()
    target = math.ceil(10 * it.twin.time + 1) / 10 + 0.5
    tab.get_by_label("Run to time in seconds").fill(str(target))
    tab.get_by_role("button", name="Go").click()
    it.frames(lambda: not it.twin.clock.paused)
    it.frames(lambda: it.twin.clock.paused)
    assert it.twin.time == pytest.approx(target)


def test_reset_goes_back_to_the_start(page):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.3)
    it.twin.pause()
    tab.get_by_role("button", name="Reset").click()
    it.frames(lambda: it.twin.time == 0)
    it.seen(tab.locator("#time"), "0.000 s")


def test_the_speed_slider_sets_the_real_time_rate(page):
    it, tab = page
    open_tab(tab, "Time")
    number = tab.get_by_label("Real-time rate, number")
    number.fill("0.5")
    number.press("Enter")
    it.frames(lambda: it.twin.clock.real_time_rate == 0.5)
    tab.get_by_label("Real-time rate", exact=True).press("End")
    it.frames(lambda: it.twin.clock.real_time_rate == 10)
    tab.get_by_label("Real-time rate", exact=True).press("Home")
    it.frames(lambda: it.twin.clock.real_time_rate == 0.1)


def test_the_physics_step_is_a_slider_with_the_real_time_factor_beside_it(page):
    it, tab = page
    open_tab(tab, "Time")
    number = tab.get_by_label("Physics step, number")
    number.fill("10")
    number.press("Enter")
    it.frames(lambda: it.twin.scenario.time_step == 0.01)
    it.frames(lambda: tab.locator("#factor-beside").inner_text() not in ("–", "paused"))
    tab.get_by_label("Physics step", exact=True).press("Home")
    it.frames(lambda: it.twin.scenario.time_step == 0.0001)
