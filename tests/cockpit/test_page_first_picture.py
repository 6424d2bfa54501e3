"""The first picture of the scene: it is not drawn before it has the robots."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import re

from browser import BROWSER_TESTS, browser, opened, page, show

pytestmark = BROWSER_TESTS

# Whether the scene was drawn, two frames of the browser later.
DRAWN = """(frame) => new Promise((done) => {
  const { requestAnimationFrame: next } = frame.contentWindow;
  next(() => next(() => done(frame.contentWindow.shownViewer !== undefined)));
})"""


def test_the_scene_is_first_drawn_when_the_robots_have_come(browser, page):
    it, _ = page
    routes, messages = [], []

    def hold(route):
        routes.append(route)
        route.connect_to_server().on_message(lambda message: messages.append(message))  # Playwright marks functions

    tab = opened(browser)
    tab.route_web_socket(re.compile("/scene/socket$"), hold)
    it.tabs.append(tab)
    tab.goto(it.served.url)
    it.frames(lambda: tab.locator("body.ready").count() == 1 and messages)
    assert tab.locator("#scene").evaluate(DRAWN) is False
    routes[0].send(messages[0])
    it.frames(lambda: tab.locator("#scene").evaluate(DRAWN))


def test_a_scene_that_loses_its_server_is_drawn_without_robots(browser, page):
    it, _ = page
    tab = opened(browser)
    tab.route_web_socket(re.compile("/scene/socket$"), lambda route: route.close())
    it.tabs.append(tab)
    tab.goto(it.served.url)
    it.frames(lambda: tab.locator("body.ready").count() == 1 and tab.locator("#scene").evaluate(DRAWN))
