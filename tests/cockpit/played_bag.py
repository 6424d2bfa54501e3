"""A bag on a page, in a real browser."""

from browser import heard, opened

from drake_twin import Twin
from drake_twin.cockpit.served_page import ServedPage
from drake_twin.playback.bag import Bag
from drake_twin.playback.bag_player import BagPlayer
from drake_twin.playback.robots import recorded_scenario


class Played:
    """A bag on a page, and a tab with it."""

    def __init__(self, browser, folder):
        self.bag = Bag(folder)
        scenario, robots = recorded_scenario(self.bag)
        self.player = BagPlayer(self.bag, Twin(scenario), robots)
        self.served = ServedPage()
        self.scene = self.served.scene
        self.cockpit = self.served.show(self.player._twin, player=self.player)
        self.tab = opened(browser)
        self.faults = heard(self.tab)
        self.tab.goto(self.served.url)
        self.frames(lambda: self.tab.locator("body.ready").count() == 1)

    def frames(self, until):
        for _ in range(900):
            self.player.proceed(0.02)
            self.cockpit.process_requests()
            self.tab.title()  # as fast as the browser
            if until():
                return
        raise AssertionError("not within 900 frames")

    def close(self):
        self.tab.close()
        self.served.close()
        self.bag.close()
        assert self.faults == [], self.faults
