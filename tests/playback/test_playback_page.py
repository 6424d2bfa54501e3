"""A bag on the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "cockpit"))

from browser import BROWSER_TESTS, browser, open_tab, opened
from playback.recorded_bags import cart_messages, write

from drake_twin import Twin
from drake_twin.cockpit.served_page import ServedPage
from drake_twin.playback.bag import Bag
from drake_twin.playback.bag_player import BagPlayer
from drake_twin.playback.robots import recorded_scenario

pytestmark = BROWSER_TESTS


def test_the_page_plays_a_bag(browser, tmp_path):
    with Bag(write(tmp_path / "bag", cart_messages())) as bag:
        scenario, robots = recorded_scenario(bag)
        player = BagPlayer(bag, Twin(scenario), robots)
        served = ServedPage()
        cockpit = served.show(player._twin, player=player)
        tab = opened(browser)
        faults = []
        tab.on("pageerror", lambda error: faults.append(str(error)))

        def frames(until, wall_time=0.02):
            for _ in range(900):
                player.proceed(wall_time)
                cockpit.process_requests()
                tab.title()  # as fast as the browser
                if until():
                    return
            raise AssertionError("not within 900 frames")

        try:
            tab.goto(served.url)
            frames(lambda: tab.locator("body.ready").count() == 1)
            tab.get_by_role("button", name="Play", exact=True).click()
            frames(lambda: player.time > 0.5)
            tab.get_by_role("button", name="Pause").click()
            frames(lambda: player.paused)
            frames(lambda: tab.locator("#time").inner_text() == f"{player.time:.3f} s")
            for name in ("#stop-all", "#spawn", "#record", "#time-step-row"):
                assert not tab.locator(name).is_visible()
            open_tab(tab, "Time")
            assert tab.locator("#rate-row").is_visible()
            tab.get_by_label("Run to time in seconds").fill("1.5")
            tab.get_by_role("button", name="Go").click()
            frames(lambda: (player.time, player.paused) == (1.5, True))
            tab.get_by_role("button", name="Reset").click()
            frames(lambda: player.time == 0.0)
            slider = tab.get_by_label("Time to look at")
            for key, time in (("End", bag.duration), ("Home", 0.0)):
                slider.press(key)
                frames(lambda time=time: player.time == time)
                frames(lambda time=time: tab.locator("#time").inner_text() == f"{time:.3f} s")
            assert faults == []
        finally:
            tab.close()
            served.close()
